//! Models by what they are: `Kelvin model (fitted)`, `force-deflection curve with 5 knots (fitted)`.
//!
//! A name tells a candidate from all others of its run. Its id stands in tables, for scripts and commands.

use std::collections::BTreeMap;

use crumple_lumped::ModelKind;

use crate::findings::text::listed;

/// Parameters of a candidate, SI, by name.
type Parameters = BTreeMap<String, f64>;

/// What a candidate is, in words that no other of all candidates has: its number is said where it does not go without.
/// Within a sentence; at the start of one or of a cell see [`capitalised`](crate::findings::capitalised).
pub(crate) fn name_among<'a>(id: &str, all: impl Iterator<Item = (&'a str, &'a Parameters)> + Clone) -> String {
    let parameters = all.clone().find(|(other, _)| *other == id).map(|(_, parameters)| parameters);
    let is_its_own = |form: &Form| {
        let name = form(id, parameters);
        all.clone().all(|(other, parameters)| other == id || form(other, Some(parameters)) != name)
    };
    let form = FORMS.iter().find(|form| is_its_own(form)).unwrap_or(&FORMS[FORMS.len() - 1]);
    form(id, parameters)
}

/// A name by the id and the parameters, where they are known.
type Form = fn(&str, Option<&Parameters>) -> String;

/// The forms of a name, the shortest first.
const FORMS: [Form; 3] = [short, numbered, with_id];

/// `Kelvin model (fitted, solution 2)`; the knots of curves tell them apart without the number.
fn short(id: &str, parameters: Option<&Parameters>) -> String {
    let is_told_apart = parameters.is_some_and(|parameters| !knots(parameters).is_empty());
    name(id, parameters, !is_told_apart)
}

/// `force-deflection curve with 5 knots (fitted, solution 2)`.
fn numbered(id: &str, parameters: Option<&Parameters>) -> String {
    name(id, parameters, true)
}

/// `Kelvin model (fitted), kelvin/fitted/1`: of a program that calls its method by the words of another.
fn with_id(id: &str, parameters: Option<&Parameters>) -> String {
    format!("{}, {id}", numbered(id, parameters))
}

/// Of an id that is not `<model>/<method>/<number>` the id.
fn name(id: &str, parameters: Option<&Parameters>, has_number: bool) -> String {
    let mut parts = id.splitn(3, '/');
    let (Some(model), Some(method), Some(number)) = (parts.next(), parts.next(), parts.next()) else {
        return id.to_owned();
    };
    let solution = match number.parse::<u64>() {
        Ok(0 | 1) => String::new(),
        Ok(number) if has_number => format!(", solution {number}"),
        Ok(_) => String::new(),
        Err(_) => format!(", {number}"),
    };
    let model = match parameters {
        Some(parameters) => model_with_knots(model, parameters),
        None => model_name(model, &Parameters::new()),
    };
    format!("{model} ({}{solution})", method_name(method))
}

/// A model by what it is, without its knots: `double-spring-mass-damper` is "double spring-mass-damper". The words of
/// another program stay as they are.
pub fn model_name(model: &str, parameters: &Parameters) -> String {
    kind_of(model, parameters).map_or_else(|| model.replace('-', " "), |kind| words_of_kind(kind).to_owned())
}

fn words_of_kind(kind: ModelKind) -> &'static str {
    match kind {
        ModelKind::Kelvin => "Kelvin model",
        ModelKind::Elastoplastic => "elastoplastic spring",
        ModelKind::Maxwell => "Maxwell model",
        ModelKind::Nonlinear1 => "nonlinear model I",
        ModelKind::Nonlinear2 => "nonlinear model II",
        ModelKind::DoubleSpringMassDamper => "double spring-mass-damper",
        ModelKind::TripleSpringMassDamper => "triple spring-mass-damper",
        ModelKind::ForceDeflection => "force-deflection curve",
        ModelKind::LoadPaths => "two-mass model with load paths",
        ModelKind::Chain => "stated chain",
        ModelKind::Own => "own model",
    }
}

/// A candidate's model within a sentence, without knots and method: `the elastoplastic spring`, `nonlinear model I`.
pub(crate) fn the_model(model: &str, parameters: &Parameters) -> String {
    match kind_of(model, parameters) {
        Some(kind @ (ModelKind::Nonlinear1 | ModelKind::Nonlinear2)) => words_of_kind(kind).to_owned(),
        Some(kind) => format!("the {}", words_of_kind(kind)),
        None => format!("the {} model", model_name(model, parameters)),
    }
}

/// `force-deflection curve with 5 knots`, `two-mass model with load paths of 4 and 3 knots`; of a model without curves
/// its name.
fn model_with_knots(model: &str, parameters: &Parameters) -> String {
    let Some(kind) = kind_of(model, parameters) else { return model_name(model, parameters) };
    let (name, knots) = (words_of_kind(kind), knots(parameters));
    let knot = |count: &usize| if *count == 1 { "knot" } else { "knots" };
    let counts: Vec<String> = knots.iter().map(usize::to_string).collect();
    match (kind, &knots[..]) {
        (ModelKind::ForceDeflection, [count]) => format!("{name} with {count} {}", knot(count)),
        (ModelKind::LoadPaths, [.., last]) => format!("{name} of {} {}", listed(&counts), knot(last)),
        _ => name.to_owned(),
    }
}

/// The kind of a model; of crushed structures the parameters tell whether it has two masses.
fn kind_of(model: &str, parameters: &Parameters) -> Option<ModelKind> {
    match model.parse().ok()? {
        ModelKind::ForceDeflection if parameters.contains_key("m1_kg") => Some(ModelKind::LoadPaths),
        kind => Some(kind),
    }
}

/// How many knots each curve of a crushed structure has, from the barrier on; empty of other models.
fn knots(parameters: &Parameters) -> Vec<usize> {
    const CURVES: [&str; 4] = ["", "front_", "rear_", "parallel_"];
    let count = |curve: &&str| {
        let forces = (1..).take_while(|number| parameters.contains_key(&format!("{curve}knot{number}_n")));
        forces.count()
    };
    CURVES.iter().map(count).filter(|count| *count > 0).collect()
}

/// How a candidate was found, in a word or two; the word of another program as it is.
fn method_name(method: &str) -> String {
    match method {
        "closed-form" => "closed form",
        "direct-fit" => "fitted",
        "coefficient-matching" => "from an identified model",
        "curve-fit" => "from four exponentials",
        "firefly" => "firefly search",
        "l-shade" => "global search",
        "interior-point" => "interior point",
        other => return other.replace('-', " "),
    }
    .to_owned()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    fn parameters(names: &[&str]) -> Parameters {
        names.iter().map(|name| ((*name).to_owned(), 1.0)).collect()
    }

    fn names_of(all: &[(&str, Parameters)]) -> Vec<String> {
        let candidates = all.iter().map(|(id, parameters)| (*id, parameters));
        all.iter().map(|(id, _)| name_among(id, candidates.clone())).collect()
    }

    fn name_of(id: &str, names: &[&str]) -> String {
        names_of(&[(id, parameters(names))]).remove(0)
    }

    #[test]
    fn a_model_is_called_by_what_it_is_and_how_it_was_found() {
        assert_eq!(name_of("kelvin/direct-fit/1", &["mass_kg"]), "Kelvin model (fitted)");
        assert_eq!(name_of("maxwell/closed-form/1", &[]), "Maxwell model (closed form)");
        assert_eq!(name_of("elastoplastic/closed-form/1", &[]), "elastoplastic spring (closed form)");
        assert_eq!(name_of("nonlinear-2/interior-point/1", &[]), "nonlinear model II (interior point)");
        assert_eq!(name_of("triple-spring-mass-damper/l-shade/1", &[]), "triple spring-mass-damper (global search)");
        assert_eq!(
            name_of("double-spring-mass-damper/coefficient-matching/4", &[]),
            "double spring-mass-damper (from an identified model, solution 4)"
        );
    }

    #[test]
    fn the_knots_of_a_curve_are_counted() {
        let curve = ["knot1_m", "knot1_n", "knot2_m", "knot2_n", "mass_kg", "unloading_stiffness_n_per_m"];
        assert_eq!(name_of("force-deflection/direct-fit/3", &curve), "force-deflection curve with 2 knots (fitted)");
        assert_eq!(
            name_of("force-deflection/direct-fit/1", &["knot1_n"]),
            "force-deflection curve with 1 knot (fitted)"
        );
        let paths = ["front_knot1_n", "front_knot2_n", "parallel_knot1_n", "m1_kg", "m2_kg"];
        assert_eq!(
            name_of("force-deflection/direct-fit/1", &paths),
            "two-mass model with load paths of 2 and 1 knot (fitted)"
        );
        // Without a record the number tells curves apart.
        let unknown = name_among("force-deflection/direct-fit/3", std::iter::empty());
        assert_eq!(unknown, "force-deflection curve (fitted, solution 3)");
    }

    #[test]
    fn candidates_of_one_run_have_names_of_their_own() {
        let (curve, finer) = (parameters(&["knot1_n"]), parameters(&["knot1_n", "knot2_n"]));
        let all = [
            ("force-deflection/direct-fit/1", curve.clone()),
            ("force-deflection/direct-fit/2", finer),
            ("force-deflection/direct-fit/3", curve),
            ("kelvin/direct-fit/1", parameters(&[])),
            ("kelvin/fitted/1", parameters(&[])),
        ];
        assert_eq!(
            names_of(&all),
            [
                "force-deflection curve with 1 knot (fitted)",
                "force-deflection curve with 2 knots (fitted)",
                "force-deflection curve with 1 knot (fitted, solution 3)",
                "Kelvin model (fitted), kelvin/direct-fit/1",
                "Kelvin model (fitted), kelvin/fitted/1",
            ]
        );
    }

    #[test]
    fn no_two_candidates_of_a_fixture_have_one_name() {
        for fixture in ["double", "elastoplastic", "kelvin", "noisy"] {
            let file = format!("{}/../../fixtures/{fixture}/golden/summary.json", env!("CARGO_MANIFEST_DIR"));
            let summary: serde_json::Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
            let candidates = summary["candidates"].as_array().unwrap();
            let all: Vec<(&str, Parameters)> = candidates
                .iter()
                .map(|one| (one["id"].as_str().unwrap(), serde_json::from_value(one["parameters"].clone()).unwrap()))
                .collect();
            let names = names_of(&all);
            assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), all.len(), "{names:?}");
            assert!(names.iter().all(|name| name.ends_with(')')), "no id is needed: {names:?}");
        }
    }

    #[test]
    fn the_words_of_another_program_stay() {
        assert_eq!(name_of("chain/mine/1", &[]), "stated chain (mine)");
        assert_eq!(name_of("sled/my-program/2", &[]), "sled (my program, solution 2)");
        assert_eq!(name_of("sled/my-program/b", &[]), "sled (my program, b)");
        assert_eq!(name_of("anything", &[]), "anything");
    }
}
