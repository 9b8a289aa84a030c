//! A law of one's own as it stands in its file, and what is wrong with one.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use serde::Deserialize;
use toml::Spanned;

use crate::ParameterKind;
use crate::families::own_law::{FreeNumber, LawElement, LawMass, LawNumber, LawParameter, OwnLaw};
use crate::structure::connected_masses::Node;
use crate::structure::expression::{Expression, TAKEN};
use crate::structure::own_force::{ForceLaw, Unloading};

/// Bytes of a file at most: some thousand lines.
const MOST_BYTES: usize = 65_536;
/// Masses, elements and parameters of a law at most: a motion costs in proportion to each, and a fit to the square of
/// the parameters.
const MOST_PARTS: usize = 30;

/// What is wrong with the text of a law, and where.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {problem}")]
pub struct LawMistake {
    /// Line, from 1.
    pub line: usize,
    /// Character of the line, from 1.
    pub column: usize,
    /// What was found, what was expected, what to do.
    pub problem: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileOfLaw {
    name: Option<Spanned<String>>,
    measured: Option<Spanned<String>>,
    #[serde(default)]
    mass: Vec<Spanned<MassOfLaw>>,
    #[serde(default)]
    element: Vec<Spanned<ElementOfLaw>>,
    #[serde(default)]
    parameters: BTreeMap<String, Spanned<NumberOfLaw>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MassOfLaw {
    name: String,
    mass: Option<Spanned<String>>,
    lower: Option<f64>,
    upper: Option<f64>,
    start: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ElementOfLaw {
    between: Option<Spanned<[String; 2]>>,
    force: Spanned<String>,
    unloading: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NumberOfLaw {
    unit: String,
    value: Option<f64>,
    lower: Option<f64>,
    upper: Option<f64>,
    start: Option<f64>,
}

/// A text with its places.
struct Text<'a>(&'a str);

impl Text<'_> {
    fn mistake(&self, at: usize, problem: impl Into<String>) -> LawMistake {
        let before = self.0.get(..at.min(self.0.len())).unwrap_or(self.0);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        LawMistake { line, column, problem: problem.into() }
    }

    /// The byte at which a character of a quoted text stands.
    fn inside(&self, quoted: &Spanned<String>, characters: usize) -> usize {
        let raw = self.0.get(quoted.span()).unwrap_or_default();
        let quotes = if raw.starts_with("\"\"\"") || raw.starts_with("'''") { 3 } else { 1 };
        let before: usize = raw.chars().skip(quotes).take(characters).map(char::len_utf8).sum();
        quoted.span().start + quotes + before
    }

    fn expression(&self, text: &Spanned<String>, names: &[String], has_strain: bool) -> Result<Expression, LawMistake> {
        Expression::parse(text.get_ref(), names, has_strain)
            .map_err(|mistake| self.mistake(self.inside(text, mistake.at), mistake.problem))
    }
}

/// Reads the text of a law.
pub(super) fn read(text: &str) -> Result<OwnLaw, LawMistake> {
    let source = Text(text);
    if text.len() > MOST_BYTES {
        let problem =
            format!("found {} bytes, expected {MOST_BYTES} at most: is this the file of a model?", text.len());
        return Err(source.mistake(0, problem));
    }
    let file: FileOfLaw = toml::from_str(text).map_err(|error| {
        let at = error.span().map_or(0, |span: Range<usize>| span.start);
        source.mistake(at, format!("{}; see docs/how-to/own-model.md for a file to start from", error.message().trim()))
    })?;
    for (what, count) in
        [("mass", file.mass.len()), ("element", file.element.len()), ("parameters", file.parameters.len())]
    {
        if count > MOST_PARTS {
            let problem = format!("found {count} entries of {what}, expected {MOST_PARTS} at most: use fewer");
            return Err(source.mistake(0, problem));
        }
    }
    if file.element.is_empty() {
        let problem = "found no element, expected one at least: add [[element]] with force = \"k*x\"";
        return Err(source.mistake(text.len(), problem));
    }
    let masses = masses(&source, &file)?;
    let parameters = parameters(&source, &file.parameters)?;
    let symbols: Vec<String> = parameters.iter().map(|parameter| parameter.symbol.clone()).collect();
    let elements: Vec<LawElement> = file
        .element
        .iter()
        .map(|element| read_element(&source, element, &masses, &symbols))
        .collect::<Result<_, _>>()?;
    for (place, parameter) in parameters.iter().enumerate() {
        let is_used = |element: &LawElement| {
            let in_line = matches!(&element.law.unloading, Unloading::Stiffness(line) if line.has_parameter(place));
            in_line || element.law.force.has_parameter(place)
        };
        if !elements.iter().any(is_used) {
            let at = file.parameters[&parameter.symbol].span().start;
            let problem =
                format!("found the parameter {:?} in no force, expected it in one: remove it", parameter.symbol);
            return Err(source.mistake(at, problem));
        }
    }
    let held = |mass: usize| elements.iter().any(|one| one.rear == Node::Mass(mass) || one.front == Node::Mass(mass));
    if let Some(free) = (0..masses.len()).find(|mass| !held(*mass)) {
        let at = file.mass.get(free).map_or(0, |mass| mass.span().start);
        let problem =
            format!("found no element at the mass {:?}, expected one: add it or remove the mass", masses[free].0);
        return Err(source.mistake(at, problem));
    }
    let name = file.name.map(Spanned::into_inner).filter(|name| !name.trim().is_empty());
    Ok(OwnLaw { name, text: text.to_owned(), masses, elements, parameters })
}

/// Masses in the order of the file, the measured one last.
fn masses(source: &Text<'_>, file: &FileOfLaw) -> Result<Vec<(String, LawMass)>, LawMistake> {
    if file.mass.is_empty() {
        return Ok(vec![("car".to_owned(), LawMass::Rest)]);
    }
    let mut masses: Vec<(String, LawMass)> = Vec::new();
    for spanned in &file.mass {
        let (at, mass) = (spanned.span().start, spanned.get_ref());
        if mass.name.trim().is_empty() || mass.name == "wall" || masses.iter().any(|(name, _)| *name == mass.name) {
            let problem =
                format!("found the mass name {:?}, expected one that no other mass or the wall has", mass.name);
            return Err(source.mistake(at, problem));
        }
        let is_free = mass.lower.is_some() || mass.upper.is_some() || mass.start.is_some();
        let of_text = |text: &Spanned<String>| {
            let number = |end: &str| text.get_ref().trim().strip_suffix(end)?.trim().parse::<f64>().ok();
            let found = match text.get_ref().trim() {
                "rest" => Some(LawMass::Rest),
                _ => number("%").map(|share| LawMass::Share(0.01 * share)).or_else(|| number("kg").map(LawMass::Given)),
            };
            let is_one = |mass: &LawMass| match mass {
                LawMass::Share(share) => *share > 0.0 && *share < 1.0,
                LawMass::Given(kg) => kg.is_finite() && *kg > 0.0,
                _ => true,
            };
            found.filter(is_one).ok_or_else(|| {
                let problem = format!("found the mass {:?}, expected \"rest\", \"25%\" or \"200 kg\"", text.get_ref());
                source.mistake(text.span().start, problem)
            })
        };
        let read = match (&mass.mass, is_free) {
            (Some(text), true) => {
                let problem = "found mass beside lower, upper or start, expected one of both: remove mass to fit it";
                return Err(source.mistake(text.span().start, problem));
            }
            (Some(text), false) => of_text(text)?,
            (None, true) => LawMass::Free(free(source, at, (mass.lower, mass.upper, mass.start))?),
            (None, false) => LawMass::Rest,
        };
        masses.push((mass.name.clone(), read));
    }
    let rests = masses.iter().filter(|(_, mass)| *mass == LawMass::Rest).count();
    if rests > 1 {
        let at = file.mass[0].span().start;
        return Err(
            source.mistake(at, format!("found {rests} masses that are the rest, expected one: state the others"))
        );
    }
    let shares: f64 =
        masses.iter().filter_map(|(_, mass)| if let LawMass::Share(s) = mass { Some(s) } else { None }).sum();
    if shares >= 1.0 {
        let at = file.mass[0].span().start;
        let problem = format!("found shares of {:.0} % together, expected less than 100 %: lower one", 100.0 * shares);
        return Err(source.mistake(at, problem));
    }
    if let Some(measured) = &file.measured {
        let Some(place) = masses.iter().position(|(name, _)| name == measured.get_ref()) else {
            let names: Vec<&str> = masses.iter().map(|(name, _)| name.as_str()).collect();
            let problem = format!("found measured = {:?}, expected one of {}", measured.get_ref(), names.join(", "));
            return Err(source.mistake(measured.span().start, problem));
        };
        let last = masses.remove(place);
        masses.push(last);
    }
    Ok(masses)
}

/// Bounds that rise above zero: a fit moves the logarithm.
fn free(
    source: &Text<'_>,
    at: usize,
    (lower, upper, start): (Option<f64>, Option<f64>, Option<f64>),
) -> Result<FreeNumber, LawMistake> {
    let (Some(lower), Some(upper)) = (lower, upper) else {
        let problem = "found no lower or no upper bound, expected both: a fit searches between them";
        return Err(source.mistake(at, problem));
    };
    let rises = lower > 0.0 && lower < upper && upper.is_finite();
    if !rises || start.is_some_and(|start| !(start >= lower && start <= upper)) {
        let start = start.map_or("none".to_owned(), |start| start.to_string());
        let problem = format!(
            "found lower {lower}, start {start}, upper {upper}, expected 0 < lower <= start <= upper: write a minus \
             sign into the force"
        );
        return Err(source.mistake(at, problem));
    }
    Ok(FreeNumber { lower, upper, start })
}

fn parameters(
    source: &Text<'_>,
    table: &BTreeMap<String, Spanned<NumberOfLaw>>,
) -> Result<Vec<LawParameter>, LawMistake> {
    let read = |(symbol, spanned): (&String, &Spanned<NumberOfLaw>)| {
        let (at, number) = (spanned.span().start, spanned.get_ref());
        let is_word = symbol.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if !is_word || !symbol.starts_with(|c: char| c.is_ascii_alphabetic()) || TAKEN.contains(&symbol.as_str()) {
            let problem =
                format!("found the name {symbol:?}, expected letters, digits and _, and none of {}", TAKEN.join(", "));
            return Err(source.mistake(at, problem));
        }
        let unit = unit_in_name(&number.unit).ok_or_else(|| {
            let problem =
                format!("found the unit {:?}, expected one such as \"N/m\", \"N*s/m^3\" or \"1\"", number.unit);
            source.mistake(at, problem)
        })?;
        let stated = match number.value {
            Some(value) if number.lower.is_none() && number.upper.is_none() && number.start.is_none() => {
                if !value.is_finite() {
                    return Err(source.mistake(at, format!("found the value {value}, expected a finite number")));
                }
                LawNumber::Given(value)
            }
            Some(_) => {
                let problem = "found value beside lower, upper or start, expected one of both: remove value to fit it";
                return Err(source.mistake(at, problem));
            }
            None => LawNumber::Free(free(source, at, (number.lower, number.upper, number.start))?),
        };
        let kind = ParameterKind::ALL.into_iter().find(|kind| kind.unit_in_name() == unit);
        let kind = kind.filter(|kind| *kind != ParameterKind::Mass).unwrap_or(ParameterKind::Other);
        let name = if unit.is_empty() { symbol.clone() } else { format!("{symbol}_{unit}") };
        Ok(LawParameter { symbol: symbol.clone(), name, kind, number: stated })
    };
    table.iter().map(read).collect()
}

/// `N*s/m^3` as it stands in a name: `n_s_per_m3`. `None` for what is no unit.
fn unit_in_name(unit: &str) -> Option<String> {
    let unit = unit.trim().to_lowercase();
    let is_unit = |c: char| c.is_ascii_alphanumeric() || matches!(c, '/' | '*' | '·' | '^' | ' ' | '-');
    if unit.is_empty() || unit.len() > 20 || !unit.chars().all(is_unit) || unit.matches('/').count() > 1 {
        return None;
    }
    let words = |part: &str| -> String {
        let parts =
            part.split(['*', '·', ' ']).map(|word| word.replace(['^', '-'], "")).filter(|word| !word.is_empty());
        parts.collect::<Vec<_>>().join("_")
    };
    let (top, bottom) = unit.split_once('/').unwrap_or((&unit, ""));
    let (top, bottom) = (if top.trim() == "1" { String::new() } else { words(top) }, words(bottom));
    Some(match (top.is_empty(), bottom.is_empty()) {
        (_, true) => top,
        (true, false) => format!("per_{bottom}"),
        (false, false) => format!("{top}_per_{bottom}"),
    })
}

fn read_element(
    source: &Text<'_>,
    spanned: &Spanned<ElementOfLaw>,
    masses: &[(String, LawMass)],
    symbols: &[String],
) -> Result<LawElement, LawMistake> {
    let element = spanned.get_ref();
    let node = |name: &str, at: usize| match masses.iter().position(|(mass, _)| mass == name) {
        Some(mass) => Ok(Node::Mass(mass)),
        None if name == "wall" => Ok(Node::Wall),
        None => {
            let names: Vec<&str> = masses.iter().map(|(name, _)| name.as_str()).collect();
            Err(source.mistake(at, format!("found {name:?}, expected wall or one of {}", names.join(", "))))
        }
    };
    let (front, rear) = match &element.between {
        Some(between) => {
            let at = between.span().start;
            let [front, rear] = between.get_ref();
            (node(front, at)?, node(rear, at)?)
        }
        None if masses.len() == 1 => (Node::Wall, Node::Mass(0)),
        None => {
            let problem = "found no between, expected the two ends: between = [\"wall\", \"engine\"]";
            return Err(source.mistake(spanned.span().start, problem));
        }
    };
    if front == rear {
        return Err(source.mistake(spanned.span().start, "found the same end twice, expected two different ones"));
    }
    let force = source.expression(&element.force, symbols, true)?;
    let unloading = match &element.unloading {
        None => Unloading::Elastic,
        Some(text) if text.get_ref().trim() == "rigid" => Unloading::Rigid,
        Some(text) => Unloading::Stiffness(source.expression(text, symbols, false)?),
    };
    Ok(LawElement { front, rear, law: Arc::new(ForceLaw { force, unloading }) })
}
