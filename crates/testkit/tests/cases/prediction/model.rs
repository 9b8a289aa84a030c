//! Masses and elements of a case as a structure.

use crumple_lumped::{
    Damper, Element, Extrapolation, ForceDeflection, Node, PiecewiseLinear, SeriesSpringDamper, Spring, Start,
    Structure,
};

use crate::prediction::fields::Fields;

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
