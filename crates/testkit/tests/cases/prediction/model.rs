//! Models of cases of prediction, from their fields.

use std::cell::RefCell;
use std::collections::BTreeSet;

use crumple_lumped::{
    Damper, Element, Extrapolation, ForceDeflection, Node, PiecewiseLinear, SeriesSpringDamper, Spring, Start,
    Structure,
};
use serde_json::{Map, Value};

/// An object of a case file.
pub struct Fields<'a> {
    fields: &'a Map<String, Value>,
    path: String,
    read: RefCell<BTreeSet<String>>,
}

impl<'a> Fields<'a> {
    pub fn of(value: &'a Value, path: &str) -> Result<Self, String> {
        let fields = value.as_object().ok_or_else(|| format!("{path} is no object"))?;
        Ok(Self { fields, path: path.to_owned(), read: RefCell::default() })
    }

    /// A field, if it is there and not null.
    pub fn get(&self, name: &str) -> Option<&'a Value> {
        self.read.borrow_mut().insert(name.to_owned());
        self.fields.get(name).filter(|value| !value.is_null())
    }

    fn wanted<T>(&self, name: &str, as_type: impl Fn(&'a Value) -> Option<T>) -> Result<T, String> {
        self.get(name).and_then(as_type).ok_or_else(|| format!("{}.{name} is missing or of another type", self.path))
    }

    pub fn number(&self, name: &str) -> Result<f64, String> {
        self.wanted(name, Value::as_f64)
    }

    pub fn text(&self, name: &str) -> Result<&'a str, String> {
        self.wanted(name, Value::as_str)
    }

    pub fn list(&self, name: &str) -> Result<&'a [Value], String> {
        self.wanted(name, |value| value.as_array().map(Vec::as_slice))
    }

    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, String> {
        self.wanted(name, |value| value.as_array()?.iter().map(Value::as_f64).collect())
    }

    pub fn object(&self, name: &str) -> Result<Fields<'a>, String> {
        Fields::of(self.wanted(name, Some)?, &format!("{}.{name}", self.path))
    }

    /// The objects of a list.
    pub fn objects(&self, name: &str) -> Result<Vec<Fields<'a>>, String> {
        let of = |(i, value)| Fields::of(value, &format!("{}.{name}[{i}]", self.path));
        self.list(name)?.iter().enumerate().map(of).collect()
    }

    /// Names of its fields.
    pub fn names(&self) -> impl Iterator<Item = &'a str> {
        self.fields.keys().map(String::as_str)
    }

    /// A number, or what holds without it.
    pub fn number_or(&self, name: &str, default: f64) -> Result<f64, String> {
        if self.get(name).is_some() { self.number(name) } else { Ok(default) }
    }

    /// Refuses fields that were not asked for.
    pub fn all_read(&self) -> Result<(), String> {
        let read = self.read.borrow();
        match self.fields.keys().find(|name| !read.contains(*name)) {
            Some(name) => Err(format!("the input {}.{name} is not known", self.path)),
            None => Ok(()),
        }
    }
}

/// A structure with the names of the case.
pub struct Case {
    /// Name of each element, and the connections it is made of.
    pub elements: Vec<(String, Vec<usize>)>,
    pub structure: Structure,
    pub start: Start,
    /// The body from which the last mass is seen.
    pub seen_from: Node,
}

/// An error of the product in words.
pub fn say(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// The element of section 1.
pub fn force_deflection(fields: &Fields) -> Result<ForceDeflection, String> {
    let (deflections, forces) = (fields.numbers("deflection_m")?, fields.numbers("force_n")?);
    if deflections.len() != forces.len() {
        return Err("deflections and forces differ in number".to_owned());
    }
    let knots: Vec<(f64, f64)> = deflections.into_iter().zip(forces).collect();
    let mut element = ForceDeflection::new(&knots, fields.number("unloading_n_per_m")?).map_err(say)?;
    let beyond = match fields.get("extrapolation").map(|rule| rule.as_str()) {
        None | Some(Some("slope")) => Extrapolation::Slope,
        Some(Some("constant")) => Extrapolation::Constant,
        Some(rule) => return Err(format!("extrapolation {rule:?} is not known")),
    };
    element = element.with_extrapolation(beyond).map_err(say)?;
    element = element.with_rate(fields.number_or("rate_s_per_m", 0.0)?).map_err(say)?;
    element = element.with_gap(fields.number_or("gap_m", 0.0)?).map_err(say)?;
    if fields.get("force_limit_n").is_some() {
        element = element.with_limit(fields.number("force_limit_n")?).map_err(say)?;
    }
    Ok(element)
}

/// What joins two nodes: one element, or a spring and a damper beside each other.
fn elements(fields: &Fields) -> Result<Vec<Element>, String> {
    let constant = |name: &str| Ok::<_, String>(PiecewiseLinear::constant(fields.number_or(name, 0.0)?));
    Ok(match fields.text("kind")? {
        "force-deflection" => vec![force_deflection(fields)?.into()],
        "linear" => {
            vec![Spring(constant("stiffness_n_per_m")?).into(), Damper(constant("damping_n_s_per_m")?).into()]
        }
        "maxwell" => vec![
            SeriesSpringDamper {
                stiffness_n_per_m: fields.number("stiffness_n_per_m")?,
                damping_n_s_per_m: fields.number("damping_n_s_per_m")?,
            }
            .into(),
        ],
        other => return Err(format!("element kind {other} is not known")),
    })
}

impl Case {
    /// From the fields `masses`, `elements` and `relative_to`.
    pub fn of(inputs: &Fields) -> Result<Self, String> {
        let (mut masses, mut positions_m, mut velocities_m_per_s) = (Vec::new(), Vec::new(), Vec::new());
        for mass in inputs.objects("masses")? {
            masses.push((mass.text("name")?.to_owned(), mass.number("mass_kg")?));
            velocities_m_per_s.push(mass.number_or("initial_velocity_m_per_s", 0.0)?);
            positions_m.push(mass.number_or("initial_position_m", 0.0)?);
            mass.all_read()?;
        }
        let (mut names, mut joined, mut connections) = (Vec::new(), Vec::new(), 0);
        for element in inputs.objects("elements")? {
            let parts = elements(&element)?;
            names.push((element.text("name")?.to_owned(), (connections..connections + parts.len()).collect()));
            connections += parts.len();
            let (front, rear) = (element.text("front")?, element.text("rear")?);
            joined.extend(parts.into_iter().map(|part| (front, rear, part)));
            element.all_read()?;
        }
        let by_name: Vec<(&str, f64)> = masses.iter().map(|(name, kg)| (name.as_str(), *kg)).collect();
        let structure = Structure::named(&by_name, joined).map_err(say)?;
        let seen_from = match inputs.get("relative_to") {
            None => Node::Wall,
            Some(name) => {
                let mass = masses.iter().position(|(mass, _)| Some(mass.as_str()) == name.as_str());
                mass.map(Node::Mass).ok_or_else(|| format!("no body {name}"))?
            }
        };
        Ok(Self { elements: names, structure, start: Start::Each { positions_m, velocities_m_per_s }, seen_from })
    }
}

#[derive(Debug, Clone, Copy)]
pub struct Tolerance {
    pub relative: f64,
    pub absolute: f64,
}

impl Tolerance {
    fn holds(self, expected: f64, found: f64) -> bool {
        (found - expected).abs() <= self.relative * expected.abs() + self.absolute
    }
}

/// Every value that is expected; what is found beside is not asked for.
pub fn values(expected: &Value, found: &Value, path: &str, tolerance: Tolerance) -> Result<(), String> {
    match (expected, found) {
        (Value::Object(wanted), Value::Object(found)) => wanted.iter().try_for_each(|(name, value)| {
            let path = format!("{path}.{name}");
            let found = found.get(name).ok_or_else(|| format!("{path} is not known"))?;
            values(value, found, &path, tolerance)
        }),
        (Value::Array(wanted), Value::Array(found)) => {
            if wanted.len() != found.len() {
                return Err(format!("{path} has {} entries, expected {}", found.len(), wanted.len()));
            }
            let mut pairs = wanted.iter().zip(found).enumerate();
            pairs.try_for_each(|(i, (wanted, found))| values(wanted, found, &format!("{path}[{i}]"), tolerance))
        }
        (Value::Number(wanted), Value::Number(got)) => {
            let (wanted, got) = (wanted.as_f64().unwrap(), got.as_f64().unwrap());
            let apart = || format!("{path} is {got:e}, expected {wanted:e}, apart by {:e}", got - wanted);
            tolerance.holds(wanted, got).then_some(()).ok_or_else(apart)
        }
        _ if expected == found => Ok(()),
        _ => Err(format!("{path} is {found}, expected {expected}")),
    }
}

/// The same events at the same times; those of one instant in any order.
pub fn events(expected: &Value, found: &Value, tolerance: Tolerance) -> Result<(), String> {
    let (wanted, found) = (expected.as_array().unwrap(), found.as_array().unwrap());
    let mut left: Vec<&Value> = found.iter().collect();
    for event in wanted {
        let time = event["time_s"].as_f64().ok_or("event without a time")?;
        let is_it = |other: &&Value| {
            tolerance.holds(time, other["time_s"].as_f64().unwrap())
                && other["element"] == event["element"]
                && other["what"] == event["what"]
        };
        match left.iter().position(is_it) {
            Some(place) => drop(left.remove(place)),
            None => return Err(format!("event {event} does not happen; left: {left:?}")),
        }
    }
    match left.first() {
        Some(event) => Err(format!("event {event} is not expected")),
        None => Ok(()),
    }
}
