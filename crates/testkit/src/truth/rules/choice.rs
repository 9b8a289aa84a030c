//! The reasons of the choice of a model.

use super::models::{counts, fit_is_right};
use super::rule::{Rule, Spot, holds, misses_its_own_test, misses_time_or_rebound, numbers_of_records, says, shows};
use crate::truth::template::Place::{Number, Rest};
use crate::truth::template::Said;

/// The sentences.
pub const RULES: &[Rule] = &[
    says(
        "because.recommended",
        "{class}, {determined} of {parameters} numbers determined{more}",
        &[("determined", Number), ("parameters", Number), ("more", Rest)],
        recommended,
    ),
    says(
        "because.simplest",
        "{count} numbers, all determined, displacement fit as measured {fit}",
        &[("count", Number), ("fit", Number)],
        simplest,
    ),
    says(
        "because.simplest-open",
        "{determined} of {parameters} numbers determined{magnitude}, displacement fit as measured {fit}",
        &[("determined", Number), ("parameters", Number), ("magnitude", Rest), ("fit", Number)],
        simplest,
    ),
    says(
        "because.closest",
        "displacement fit as measured {fit}, the best of a physical candidate{open}",
        &[("fit", Number), ("open", Rest)],
        closest,
    ),
    says(
        "because.simplest-none",
        "each of the {count} adequate candidates has a number that the record does not determine",
        &[("count", Number)],
        each_has_an_open_number,
    ),
    says(
        "because.simplest-one",
        "one number, determined, displacement fit as measured {fit}",
        &[("fit", Number)],
        simplest,
    ),
    says(
        "because.simplest-unassessed",
        "{count} numbers, not known how well, displacement fit as measured {fit}",
        &[("count", Number), ("fit", Number)],
        unassessed,
    ),
    says("because.recommended-unassessed", "{class}, {count} numbers, not known how well{more}", &[], unassessed),
    says("because.none", "no candidate is adequate ({reasons})", &[], none_adequate),
    says("because.none-qualifies", "no adequate candidate qualifies ({reasons})", &[], |_, spot| {
        holds(spot.made.recommended().is_none(), || "a model is recommended".to_owned())
    }),
    says("because.no-waves", "no acceleration and displacement of the pulse up to dynamic crush", &[], none_adequate),
    says("because.no-closest", "no physical candidate has a displacement to compare", &[], |_, spot| {
        let physical = spot
            .made
            .list("/candidates")
            .iter()
            .find(|c| c["physical"] == true && c["simulation"]["fit_percent"].is_number());
        holds(physical.is_none(), || format!("{} has", physical.map_or("", |c| c["id"].as_str().unwrap_or_default())))
    }),
];

/// A candidate that is called adequate repeats its own test.
fn adequate(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = spot.made.candidate(spot.key).ok_or("there is no such candidate")?;
    let miss = misses_its_own_test(spot.made, own).filter(|_| spot.made.known.is_sound);
    holds(miss.is_none(), || miss.clone().unwrap_or_default())?;
    numbers_of_records(said, spot)
}

/// Counts of the candidate; one that is called damped has a damper, one that is called plastic none.
fn recommended(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = spot.made.candidate(spot.key).ok_or("there is no such candidate")?;
    counts(said, own)?;
    let has_damper = own["parameters"].as_object().is_some_and(|all| all.keys().any(|name| name.contains("n_s_per_m")));
    holds((said.text("class") == "damped") == has_damper || said.text("class") == "elastic", || {
        format!("it is called {}", said.text("class"))
    })?;
    adequate(said, spot)
}

fn simplest(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = spot.made.candidate(spot.key).ok_or("there is no such candidate")?;
    if said.places.contains_key("determined") {
        counts(said, own)?;
    } else if said.places.contains_key("count") {
        shows(said, "count", own["certainties"]["determined"].as_f64(), "the count of determined numbers")?;
    } else {
        holds(own["certainties"]["determined"] == 1, || format!("{} are", own["certainties"]["determined"]))?;
    }
    fit_is_right(said, spot, own)?;
    adequate(said, spot)
}

/// Of a candidate that is adequate, nobody says how well its numbers are known.
fn unassessed(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = spot.made.candidate(spot.key).ok_or("there is no such candidate")?;
    holds(own["certainties"]["parameters"] == 0, || format!("{} are known", own["certainties"]["parameters"]))?;
    adequate(said, spot)
}

/// As many adequate candidates as are said, each with an open number.
fn each_has_an_open_number(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let rated = spot.made.choice.iter().flat_map(|choice| &choice.candidates).filter(|rated| rated.adequate);
    let open =
        |id: &str| spot.made.candidate(id).map_or(0, |own| own["certainties"]["open"].as_array().map_or(0, Vec::len));
    let open: Vec<usize> = rated.map(|rated| open(&rated.id)).collect();
    shows(said, "count", Some(open.len() as f64), "the count of adequate candidates")?;
    holds(open.iter().all(|count| *count > 0), || format!("{open:?} are open"))
}

/// No physical candidate has a higher fit.
fn closest(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = spot.made.candidate(spot.key).ok_or("there is no such candidate")?;
    fit_is_right(said, spot, own)?;
    let fit = |candidate: &serde_json::Value| {
        let simulation = &candidate["simulation"];
        simulation["fit_as_measured_percent"].as_f64().or(simulation["fit_percent"].as_f64())
    };
    let physical = spot.made.list("/candidates").iter().filter(|candidate| candidate["physical"] == true);
    let best = physical.filter_map(fit).fold(f64::NEG_INFINITY, f64::max);
    let shown = said.number("fit").map_or(f64::NAN, |shown| shown.value);
    holds(shown >= best - 0.01, || format!("another has a fit of {best:.2} %"))
}

/// Nothing that a reader could use is called inadequate: no physical candidate with all of its own test right.
/// No model is recommended, or one for its crush alone, which misses its own test.
fn none_adequate(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let best = spot.made.recommended();
    holds(best.is_none_or(|best| misses_time_or_rebound(spot.made, best).is_some()), || {
        "an adequate model is recommended".to_owned()
    })
}
