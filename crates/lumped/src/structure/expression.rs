//! A force as a text: numbers, names, `+ - * / ^`, and a few functions of the deflection `x` and its rate `v`.
//!
//! The text becomes a list of operations, each of which uses results that stand before it. Powers, roots and `tanh`
//! are made of products, quotients, `exp` and `ln`; `abs`, `min` and `max` choose by the sign of a test. A test is at
//! most of degree two in `x` and `v`, so that the instant at which it turns is found exactly.

use crate::structure::connected_masses::Form;

/// Operations of one expression at most: a motion takes some ten thousand evaluations, and a fit some thousand motions.
const MOST_OPERATIONS: usize = 400;
/// Brackets within brackets at most: each level is a call of the parser.
const MOST_DEPTH: usize = 40;
/// Characters at most.
const MOST_CHARACTERS: usize = 2_000;
/// Places where `abs`, `min` or `max` choose: a branch has a bit for each.
const MOST_CHOICES: usize = 16;
/// Characters of a written expression at most: what is used twice is written twice.
const MOST_WRITTEN: usize = 20_000;
/// Whole powers up to this one are products, which are right at zero and for negative numbers.
const MOST_WHOLE_POWER: f64 = 16.0;
/// Degree of what is no polynomial of the strain.
const NO_POLYNOMIAL: usize = 99;
/// Names with a meaning of their own.
pub(crate) const TAKEN: [&str; 9] = ["x", "v", "abs", "min", "max", "sqrt", "exp", "ln", "tanh"];

/// One step of the computation; numbers are places of results before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Operation {
    Number(f64),
    Deflection,
    Rate,
    Parameter(usize),
    Add(usize, usize),
    Subtract(usize, usize),
    Multiply(usize, usize),
    Divide(usize, usize),
    Exponential(usize),
    Logarithm(usize),
    /// `above` where `test` is zero or more, else `below`; choice of this number.
    Choose {
        test: usize,
        above: usize,
        below: usize,
        choice: usize,
    },
}

/// A force law, as operations of which the last one is the force.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Expression {
    pub operations: Vec<Operation>,
    /// Places of the tests, by the number of the choice.
    pub tests: Vec<usize>,
    /// Degree of the force in deflection and rate, whatever is chosen.
    degree: usize,
}

/// What is wrong with a text, and where.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mistake {
    /// Characters before it.
    pub at: usize,
    /// What was found, what was expected, what to do.
    pub problem: String,
}

/// Value and derivatives at a point.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Gradient {
    pub value: f64,
    pub by_deflection: f64,
    pub by_rate: f64,
    pub by_parameter: Vec<f64>,
}

/// A parser at work.
struct Parser<'a> {
    text: &'a [char],
    at: usize,
    depth: usize,
    names: &'a [String],
    operations: Vec<Operation>,
    tests: Vec<(usize, usize)>,
}

impl Expression {
    /// Reads a text whose parameters have these names. `has_strain`: whether `x` and `v` may stand in it.
    pub fn parse(text: &str, names: &[String], has_strain: bool) -> Result<Self, Mistake> {
        let characters: Vec<char> = text.chars().collect();
        if characters.len() > MOST_CHARACTERS {
            let found = characters.len();
            let problem = format!("found {found} characters, expected {MOST_CHARACTERS} at most: use more elements");
            return Err(Mistake { at: MOST_CHARACTERS, problem });
        }
        let mut parser =
            Parser { text: &characters, at: 0, depth: 0, names, operations: Vec::new(), tests: Vec::new() };
        let last = parser.sum()?;
        parser.blanks();
        if parser.at < characters.len() {
            return Err(parser.mistake("an operator + - * / ^ or the end", "write a product with *"));
        }
        let Parser { mut operations, tests, .. } = parser;
        if last + 1 != operations.len() {
            operations.truncate(last + 1);
        }
        let degrees = degrees(&operations);
        let is_strain = |one: &Operation| matches!(one, Operation::Deflection | Operation::Rate);
        if !has_strain && operations.iter().any(is_strain) {
            let problem = "found x or v, expected parameters and numbers: an unloading stiffness is constant";
            return Err(Mistake { at: 0, problem: problem.to_owned() });
        }
        if let Some((_, at)) = tests.iter().find(|(test, _)| degrees[*test] > 2) {
            let problem = "found a choice by abs, min or max between expressions beyond the second power of x and v, \
                           expected the second at most: choose first and take the power of the result";
            return Err(Mistake { at: *at, problem: problem.to_owned() });
        }
        let degree = degrees[last];
        Ok(Self { operations, tests: tests.into_iter().map(|(test, _)| test).collect(), degree })
    }

    /// Whether it is a polynomial of degree two at most on each branch: a [`Form`].
    pub fn is_form(&self) -> bool {
        self.degree <= 2
    }

    /// Whether it is a polynomial of degree one, for good.
    pub fn is_straight(&self) -> bool {
        self.degree <= 1 && self.tests.is_empty()
    }

    /// Whether it depends on the rate.
    pub fn has_rate(&self) -> bool {
        self.operations.contains(&Operation::Rate)
    }

    /// Whether this parameter stands in it.
    pub fn has_parameter(&self, parameter: usize) -> bool {
        self.operations.contains(&Operation::Parameter(parameter))
    }

    /// The expression with other words for deflection, rate and parameters; `if` chooses. `None` where the text would
    /// have more than twenty thousand characters.
    pub fn written(&self, x: &str, v: &str, parameter: &dyn Fn(usize) -> String) -> Option<String> {
        let mut texts: Vec<String> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let of = |place: &usize| texts[*place].as_str();
            let text = match operation {
                Operation::Number(number) if *number < 0.0 => format!("({number:?})"),
                Operation::Number(number) => format!("{number:?}"),
                Operation::Deflection => x.to_owned(),
                Operation::Rate => v.to_owned(),
                Operation::Parameter(p) => parameter(*p),
                Operation::Add(a, b) => format!("({} + {})", of(a), of(b)),
                Operation::Subtract(a, b) => format!("({} - {})", of(a), of(b)),
                Operation::Multiply(a, b) => format!("{} * {}", of(a), of(b)),
                Operation::Divide(a, b) => format!("({} / ({}))", of(a), of(b)),
                Operation::Exponential(a) => format!("exp({})", of(a)),
                Operation::Logarithm(a) => format!("log({})", of(a)),
                Operation::Choose { test, above, below, .. } => {
                    format!("(if {} >= 0 then {} else {})", of(test), of(above), of(below))
                }
            };
            if text.len() > MOST_WRITTEN {
                return None;
            }
            texts.push(text);
        }
        texts.pop()
    }

    /// Every result at a point, chosen by the tests there.
    fn values(&self, parameters: &[f64], x: f64, v: f64) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let value = match *operation {
                Operation::Number(number) => number,
                Operation::Deflection => x,
                Operation::Rate => v,
                Operation::Parameter(p) => parameters[p],
                Operation::Add(a, b) => values[a] + values[b],
                Operation::Subtract(a, b) => values[a] - values[b],
                Operation::Multiply(a, b) => values[a] * values[b],
                Operation::Divide(a, b) => values[a] / values[b],
                Operation::Exponential(a) => values[a].exp(),
                Operation::Logarithm(a) => values[a].ln(),
                Operation::Choose { test, above, below, .. } => values[if values[test] >= 0.0 { above } else { below }],
            };
            values.push(value);
        }
        values
    }

    /// The value at a point.
    pub fn at(&self, parameters: &[f64], x: f64, v: f64) -> f64 {
        self.values(parameters, x, v).last().copied().unwrap_or_default()
    }

    /// Which side each choice takes at a point, a bit each.
    pub fn choices(&self, parameters: &[f64], x: f64, v: f64) -> usize {
        let values = self.values(parameters, x, v);
        let sides = self.tests.iter().enumerate().map(|(choice, test)| usize::from(values[*test] >= 0.0) << choice);
        sides.sum()
    }

    /// Value and derivatives at a point: one sweep back over the operations.
    pub fn gradient(&self, parameters: &[f64], x: f64, v: f64) -> Gradient {
        let values = self.values(parameters, x, v);
        let mut weight = vec![0.0; values.len()];
        let last = values.len() - 1;
        weight[last] = 1.0;
        let mut gradient = Gradient {
            value: values[last],
            by_deflection: 0.0,
            by_rate: 0.0,
            by_parameter: vec![0.0; parameters.len()],
        };
        for (place, operation) in self.operations.iter().enumerate().rev() {
            let w = weight[place];
            match *operation {
                Operation::Number(_) => {}
                Operation::Deflection => gradient.by_deflection += w,
                Operation::Rate => gradient.by_rate += w,
                Operation::Parameter(p) => gradient.by_parameter[p] += w,
                Operation::Add(a, b) => {
                    weight[a] += w;
                    weight[b] += w;
                }
                Operation::Subtract(a, b) => {
                    weight[a] += w;
                    weight[b] -= w;
                }
                Operation::Multiply(a, b) => {
                    weight[a] += w * values[b];
                    weight[b] += w * values[a];
                }
                Operation::Divide(a, b) => {
                    weight[a] += w / values[b];
                    weight[b] -= w * values[place] / values[b];
                }
                Operation::Exponential(a) => weight[a] += w * values[place],
                Operation::Logarithm(a) => weight[a] += w / values[a],
                Operation::Choose { test, above, below, .. } => {
                    weight[if values[test] >= 0.0 { above } else { below }] += w;
                }
            }
        }
        gradient
    }

    /// Every result as a form of the strain on the branch with these choices, and its derivative by a parameter. What
    /// is beyond the second degree has no meaning here.
    pub fn forms(&self, parameters: &[f64], choices: usize, by: Option<usize>) -> Vec<[Form; 2]> {
        let constant = |constant: f64| Form { constant, ..Form::ZERO };
        let mut forms: Vec<[Form; 2]> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let of = |place: usize| forms[place];
            let linear = |factor: f64, a: usize, b: usize| [0, 1].map(|k| of(a)[k].plus(factor, &of(b)[k]));
            let form = match *operation {
                Operation::Number(number) => [constant(number), Form::ZERO],
                Operation::Deflection => [Form { u: 1.0, ..Form::ZERO }, Form::ZERO],
                Operation::Rate => [Form { w: 1.0, ..Form::ZERO }, Form::ZERO],
                Operation::Parameter(p) => [constant(parameters[p]), constant(if by == Some(p) { 1.0 } else { 0.0 })],
                Operation::Add(a, b) => linear(1.0, a, b),
                Operation::Subtract(a, b) => linear(-1.0, a, b),
                Operation::Multiply(a, b) => {
                    let ([a, of_a], [b, of_b]) = (of(a), of(b));
                    [times(&a, &b), times(&of_a, &b).plus(1.0, &times(&a, &of_b))]
                }
                Operation::Divide(a, b) => {
                    let ([a, of_a], [b, of_b]) = (of(a), of(b));
                    let quotient = Form::ZERO.plus(b.constant.recip(), &a);
                    let change = of_a.plus(-of_b.constant, &quotient);
                    [quotient, Form::ZERO.plus(b.constant.recip(), &change)]
                }
                Operation::Exponential(a) => {
                    let [a, of_a] = of(a).map(|form| form.constant);
                    [constant(a.exp()), constant(a.exp() * of_a)]
                }
                Operation::Logarithm(a) => {
                    let [a, of_a] = of(a).map(|form| form.constant);
                    [constant(a.ln()), constant(of_a / a)]
                }
                Operation::Choose { above, below, choice, .. } => {
                    of(if choices >> choice & 1 == 1 { above } else { below })
                }
            };
            forms.push(form);
        }
        forms
    }
}

/// The product of two forms whose degrees are two at most together.
fn times(a: &Form, b: &Form) -> Form {
    Form {
        constant: a.constant * b.constant,
        u: a.constant * b.u + a.u * b.constant,
        w: a.constant * b.w + a.w * b.constant,
        z: 0.0,
        uu: a.constant * b.uu + a.uu * b.constant + a.u * b.u,
        ww: a.constant * b.ww + a.ww * b.constant + a.w * b.w,
        uw: a.constant * b.uw + a.uw * b.constant + a.u * b.w + a.w * b.u,
    }
}

/// Degree of every result in deflection and rate, at most.
fn degrees(operations: &[Operation]) -> Vec<usize> {
    let mut degrees: Vec<usize> = Vec::with_capacity(operations.len());
    for operation in operations {
        let degree = match *operation {
            Operation::Number(_) | Operation::Parameter(_) => 0,
            Operation::Deflection | Operation::Rate => 1,
            Operation::Add(a, b) | Operation::Subtract(a, b) => degrees[a].max(degrees[b]),
            Operation::Multiply(a, b) => (degrees[a] + degrees[b]).min(NO_POLYNOMIAL),
            Operation::Divide(a, b) if degrees[b] == 0 => degrees[a],
            Operation::Exponential(a) | Operation::Logarithm(a) if degrees[a] == 0 => 0,
            Operation::Divide(..) | Operation::Exponential(_) | Operation::Logarithm(_) => NO_POLYNOMIAL,
            Operation::Choose { above, below, .. } => degrees[above].max(degrees[below]),
        };
        degrees.push(degree);
    }
    degrees
}

impl Parser<'_> {
    fn blanks(&mut self) {
        while self.text.get(self.at).is_some_and(|c| c.is_whitespace()) {
            self.at += 1;
        }
    }

    /// The next character that is no blank.
    fn peek(&mut self) -> Option<char> {
        self.blanks();
        self.text.get(self.at).copied()
    }

    fn takes(&mut self, wanted: char) -> bool {
        let is_next = self.peek() == Some(wanted);
        self.at += usize::from(is_next);
        is_next
    }

    /// Something else stands here than was expected.
    fn mistake(&mut self, expected: &str, todo: &str) -> Mistake {
        let found = match self.peek() {
            None => "the end of the expression".to_owned(),
            Some(c) if c.is_alphanumeric() || c == '_' => format!("{:?}", self.word_at(self.at)),
            Some(c) => format!("{c:?}"),
        };
        Mistake { at: self.at, problem: format!("found {found}, expected {expected}: {todo}") }
    }

    fn word_at(&self, at: usize) -> String {
        self.text[at..].iter().take_while(|c| c.is_alphanumeric() || **c == '_').collect()
    }

    fn push(&mut self, operation: Operation) -> Result<usize, Mistake> {
        if self.operations.len() >= MOST_OPERATIONS {
            let problem = format!("found more than {MOST_OPERATIONS} operations: use several elements");
            return Err(Mistake { at: self.at, problem });
        }
        self.operations.push(operation);
        Ok(self.operations.len() - 1)
    }

    fn number(&mut self, number: f64) -> Result<usize, Mistake> {
        self.push(Operation::Number(number))
    }

    fn sum(&mut self) -> Result<usize, Mistake> {
        self.depth += 1;
        if self.depth > MOST_DEPTH {
            let problem = format!("found more than {MOST_DEPTH} brackets within brackets: use several elements");
            return Err(Mistake { at: self.at, problem });
        }
        let mut left = self.product()?;
        loop {
            left = if self.takes('+') {
                let right = self.product()?;
                self.push(Operation::Add(left, right))?
            } else if self.takes('-') {
                let right = self.product()?;
                self.push(Operation::Subtract(left, right))?
            } else {
                self.depth -= 1;
                return Ok(left);
            };
        }
    }

    fn product(&mut self) -> Result<usize, Mistake> {
        let mut left = self.signed()?;
        loop {
            left = if self.takes('*') {
                let right = self.signed()?;
                self.push(Operation::Multiply(left, right))?
            } else if self.takes('/') {
                let right = self.signed()?;
                self.push(Operation::Divide(left, right))?
            } else {
                return Ok(left);
            };
        }
    }

    fn signed(&mut self) -> Result<usize, Mistake> {
        if !self.takes('-') {
            return self.power();
        }
        self.depth += 1;
        if self.depth > MOST_DEPTH {
            let problem = format!("found more than {MOST_DEPTH} signs and brackets within each other");
            return Err(Mistake { at: self.at, problem });
        }
        let of = self.signed()?;
        self.depth -= 1;
        if let Some(Operation::Number(number)) =
            self.operations.last().copied().filter(|_| of + 1 == self.operations.len())
        {
            self.operations[of] = Operation::Number(-number);
            return Ok(of);
        }
        let zero = self.number(0.0)?;
        self.push(Operation::Subtract(zero, of))
    }

    fn power(&mut self) -> Result<usize, Mistake> {
        let base = self.atom()?;
        if !self.takes('^') {
            return Ok(base);
        }
        let exponent = self.signed()?;
        match self.operations[exponent] {
            Operation::Number(number) if number.fract() == 0.0 && number.abs() <= MOST_WHOLE_POWER => {
                self.whole_power(base, number as i32)
            }
            _ => {
                let logarithm = self.push(Operation::Logarithm(base))?;
                let product = self.push(Operation::Multiply(exponent, logarithm))?;
                self.push(Operation::Exponential(product))
            }
        }
    }

    fn whole_power(&mut self, base: usize, exponent: i32) -> Result<usize, Mistake> {
        let mut power = None;
        for _ in 0..exponent.abs() {
            power = Some(match power {
                None => base,
                Some(power) => self.push(Operation::Multiply(power, base))?,
            });
        }
        let one = self.number(1.0)?;
        match power {
            None => Ok(one),
            Some(power) if exponent < 0 => self.push(Operation::Divide(one, power)),
            // The result of an expression is its last operation.
            Some(power) => self.push(Operation::Multiply(power, one)),
        }
    }

    fn atom(&mut self) -> Result<usize, Mistake> {
        let what = "a number, x, v, a parameter, a function or a bracket";
        let Some(first) = self.peek() else { return Err(self.mistake(what, "complete the expression")) };
        if first.is_ascii_digit() || first == '.' {
            return self.literal();
        }
        if first.is_alphabetic() || first == '_' {
            return self.named();
        }
        if self.takes('(') {
            let inner = self.sum()?;
            return if self.takes(')') { Ok(inner) } else { Err(self.mistake("\")\"", "close the bracket")) };
        }
        Err(self.mistake(what, "remove it or complete the expression"))
    }

    fn literal(&mut self) -> Result<usize, Mistake> {
        let start = self.at;
        let digits = |at: &mut usize, text: &[char]| {
            while text.get(*at).is_some_and(|c| c.is_ascii_digit() || *c == '.') {
                *at += 1;
            }
        };
        digits(&mut self.at, self.text);
        if self.text.get(self.at).is_some_and(|c| matches!(c, 'e' | 'E')) {
            let sign = usize::from(self.text.get(self.at + 1).is_some_and(|c| matches!(c, '+' | '-')));
            if self.text.get(self.at + 1 + sign).is_some_and(char::is_ascii_digit) {
                self.at += 1 + sign;
                digits(&mut self.at, self.text);
            }
        }
        let text: String = self.text[start..self.at].iter().collect();
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => self.number(number),
            _ => {
                let problem = format!("found {text:?}, expected a number such as 0.35 or 2e5: correct it");
                Err(Mistake { at: start, problem })
            }
        }
    }

    fn named(&mut self) -> Result<usize, Mistake> {
        let start = self.at;
        let word = self.word_at(start);
        self.at += word.chars().count();
        if self.peek() == Some('(') {
            return self.function(start, &word);
        }
        match word.as_str() {
            "x" => self.push(Operation::Deflection),
            "v" => self.push(Operation::Rate),
            _ => match self.names.iter().position(|name| *name == word) {
                Some(parameter) => self.push(Operation::Parameter(parameter)),
                None => {
                    let names: Vec<&str> =
                        ["x", "v"].into_iter().chain(self.names.iter().map(String::as_str)).collect();
                    let names = names.join(", ");
                    let problem = format!("found {word:?}, expected one of {names}: state it under [parameters]");
                    Err(Mistake { at: start, problem })
                }
            },
        }
    }

    fn function(&mut self, start: usize, name: &str) -> Result<usize, Mistake> {
        if !TAKEN[2..].contains(&name) {
            let problem = format!("found the function {name:?}, expected one of {}: use these", TAKEN[2..].join(", "));
            return Err(Mistake { at: start, problem });
        }
        self.takes('(');
        let mut arguments = vec![self.sum()?];
        while self.takes(',') {
            arguments.push(self.sum()?);
        }
        if !self.takes(')') {
            return Err(self.mistake("\")\" or \",\"", "close the bracket"));
        }
        match (name, &arguments[..]) {
            ("abs", &[a]) => {
                let zero = self.number(0.0)?;
                let negative = self.push(Operation::Subtract(zero, a))?;
                self.choose(start, a, a, negative)
            }
            ("max", &[a, b]) => {
                let test = self.push(Operation::Subtract(a, b))?;
                self.choose(start, test, a, b)
            }
            ("min", &[a, b]) => {
                let test = self.push(Operation::Subtract(a, b))?;
                self.choose(start, test, b, a)
            }
            ("exp", &[a]) => self.push(Operation::Exponential(a)),
            ("ln", &[a]) => self.push(Operation::Logarithm(a)),
            ("sqrt", &[a]) => {
                let half = self.number(0.5)?;
                let logarithm = self.push(Operation::Logarithm(a))?;
                let product = self.push(Operation::Multiply(half, logarithm))?;
                self.push(Operation::Exponential(product))
            }
            // 1 - 2/(exp(2 a) + 1).
            ("tanh", &[a]) => {
                let double = self.push(Operation::Add(a, a))?;
                let power = self.push(Operation::Exponential(double))?;
                let one = self.number(1.0)?;
                let sum = self.push(Operation::Add(power, one))?;
                let two = self.number(2.0)?;
                let part = self.push(Operation::Divide(two, sum))?;
                self.push(Operation::Subtract(one, part))
            }
            _ => {
                let wanted = if matches!(name, "min" | "max") { "two arguments" } else { "one argument" };
                let problem = format!("found {} for {name}, expected {wanted}: correct them", arguments.len());
                Err(Mistake { at: start, problem })
            }
        }
    }

    fn choose(&mut self, start: usize, test: usize, above: usize, below: usize) -> Result<usize, Mistake> {
        let choice = self.tests.len();
        if choice == MOST_CHOICES {
            let problem = format!("found more than {MOST_CHOICES} of abs, min and max: use several elements");
            return Err(Mistake { at: start, problem });
        }
        self.tests.push((test, start));
        self.push(Operation::Choose { test, above, below, choice })
    }
}
