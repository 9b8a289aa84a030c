//! Parameters as a person calls them.

use crumple_lumped::Model;

/// A parameter of a model in words: `stiffness k2 at 0.31 m`, `damping c1 at rest`, `unloading stiffness`, `mass m1`.
///
/// A knot of a nonlinear model is named with its place. What the model does not have stays as it is, without its unit.
pub fn in_words(model: &Model, name: &str) -> String {
    let stem = short(name);
    let length = |m: f64| format!("at {m:.3} m");
    let speed = |v: f64| format!("at {v:.2} m/s");
    let at_contact = || "at contact".to_owned();
    let at_rest = || "at rest".to_owned();
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
    let kind = match stem.as_bytes() {
        [b'k', digit] if digit.is_ascii_digit() => "stiffness ",
        [b'c', digit] if digit.is_ascii_digit() => "damping ",
        [b'm', digit] if digit.is_ascii_digit() => "mass ",
        [b'x', digit] if digit.is_ascii_digit() => "displacement of the spring's knot ",
        [b'v', digit] if *digit == b'1' || *digit == b'2' => "speed of the damper's knot ",
        _ if stem == "v thresh" => return "speed of the damper's knot".to_owned(),
        _ => "",
    };
    let place = place.map(|place| format!(" {place}")).unwrap_or_default();
    format!("{kind}{stem}{place}")
}

/// Several of them, in a row.
pub fn all_in_words<'a>(model: &Model, names: impl IntoIterator<Item = &'a str>) -> String {
    names.into_iter().map(|name| in_words(model, name)).collect::<Vec<_>>().join(", ")
}

/// A parameter without its unit: `k1_n_per_m` is `k1`.
pub(crate) fn short(name: &str) -> String {
    ["_n_s_per_m", "_n_per_m", "_m_per_s", "_kg", "_m"]
        .iter()
        .find_map(|unit| name.strip_suffix(unit))
        .unwrap_or(name)
        .replace('_', " ")
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
