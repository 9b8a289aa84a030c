//! Names of parameters for notes and messages, made from their kind.

use crumple_lumped::{Model, ParameterKind, parameter_kind};

/// The name of a parameter in a sentence: `stiffness k2 at 0.31 m`, `damping c1 at rest`, `unloading stiffness`,
/// `mass m1`.
///
/// A value at a knot of a nonlinear model is named with the place of its knot, m or m/s: the first spring knot is at
/// contact, the first damper knot at rest. A name that the model does not have is given without its unit.
pub fn in_words(model: &Model, name: &str) -> String {
    let parameter = model.kind().parameter(name);
    let kind = parameter.map(|parameter| parameter.kind).or_else(|| parameter_kind("", name));
    let Some(kind) = kind else { return name.replace('_', " ") };
    let stem = kind.symbol_of(name).replace('_', " ");
    let length = |m: f64| format!("at {m:.3} m");
    let speed = |v: f64| format!("at {v:.2} m/s");
    let at_contact = || "at contact".to_owned();
    let at_rest = || "at rest".to_owned();
    if let Model::LoadPaths(_) = model
        && let Some((path, rest)) = stem.split_once(' ')
    {
        return match (kind, rest.strip_prefix("knot")) {
            (ParameterKind::Force, Some(number)) => format!("force at knot {number} of the {path} load path"),
            (ParameterKind::Length, Some(number)) => format!("deflection of knot {number} of the {path} load path"),
            (ParameterKind::RateFactor, _) => format!("rate factor of the {path} load path"),
            _ => format!("unloading stiffness of the {path} load path"),
        };
    }
    match (kind, stem.strip_prefix("knot")) {
        (ParameterKind::Force, Some(number)) => return format!("force at knot {number}"),
        (ParameterKind::Length, Some(number)) => return format!("deflection of knot {number}"),
        (ParameterKind::RateFactor, _) => return "rate factor".to_owned(),
        _ => {}
    }
    let place = match (model, stem.as_str()) {
        (Model::Nonlinear1(_) | Model::Nonlinear2(_), "k1") => Some(at_contact()),
        (Model::Nonlinear1(_) | Model::Nonlinear2(_), "c1") => Some(at_rest()),
        (Model::Nonlinear1(m), "k2") => Some(length(m.crush_m)),
        (Model::Nonlinear1(m), "c2") => Some(speed(m.v_thresh_m_per_s)),
        (Model::Nonlinear1(m), "c3") => Some(speed(m.v0_m_per_s)),
        (Model::Nonlinear2(m), "k2") => Some(length(m.x1_m)),
        (Model::Nonlinear2(m), "k3") => Some(length(m.crush_m)),
        (Model::Nonlinear2(m), "c2") => Some(speed(m.v1_m_per_s)),
        (Model::Nonlinear2(m), "c3") => Some(speed(m.v2_m_per_s)),
        (Model::Nonlinear2(m), "c4") => Some(speed(m.v0_m_per_s)),
        _ => None,
    };
    let is_numbered = matches!(stem.as_bytes(), [_, digit] if digit.is_ascii_digit());
    let kind = match kind {
        ParameterKind::Rate if !is_numbered => return "speed of the damper's knot".to_owned(),
        ParameterKind::Stiffness if is_numbered => "stiffness ",
        ParameterKind::Damping if is_numbered => "damping ",
        ParameterKind::Mass if is_numbered => "mass ",
        ParameterKind::Length if is_numbered => "displacement of the spring's knot ",
        ParameterKind::Rate if parameter.is_some_and(|parameter| !parameter.of_the_test) => {
            "speed of the damper's knot "
        }
        _ => "",
    };
    let place = place.map(|place| format!(" {place}")).unwrap_or_default();
    format!("{kind}{stem}{place}")
}

/// Several of these names, separated by commas.
pub fn all_in_words<'a>(model: &Model, names: impl IntoIterator<Item = &'a str>) -> String {
    names.into_iter().map(|name| in_words(model, name)).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use crumple_lumped::ModelKind;

    use super::*;

    #[test]
    fn no_parameter_of_any_model_is_named_by_its_field() {
        for kind in ModelKind::ALL {
            let names = kind.parameter_names();
            let values = names.iter().enumerate().map(|(k, name)| ((*name).to_owned(), 1.0 + k as f64)).collect();
            let model = Model::from_parameters(kind, &values).unwrap();
            for name in names {
                let words = in_words(&model, name);
                assert!(!words.contains('_') && !words.is_empty(), "{kind} {name}: {words}");
            }
        }
    }

    #[test]
    fn a_knot_is_named_with_its_place() {
        let names = ModelKind::Nonlinear2.parameter_names();
        let values = names.iter().enumerate().map(|(k, name)| ((*name).to_owned(), 0.25 + k as f64)).collect();
        let model = Model::from_parameters(ModelKind::Nonlinear2, &values).unwrap();
        assert_eq!(in_words(&model, "k2_n_per_m"), "stiffness k2 at 4.250 m");
        assert_eq!(
            all_in_words(&model, ["c1_n_s_per_m", "v1_m_per_s"]),
            "damping c1 at rest, speed of the damper's knot v1"
        );
    }
}
