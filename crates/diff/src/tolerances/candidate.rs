//! Candidates of parameter solving: how far apart two of them may be, given what their record determines.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value};

use crate::Tolerance;
use crate::tolerances::unit::Unit;

/// Share of its standard deviation by which a parameter may differ: it moves no interval in its second digit.
const SHARE_OF_DEVIATION: f64 = 0.01;
/// The same of a parameter beside others that the record leaves open: it gives way with them along the valley they lie
/// in.
const SHARE_BESIDE_OPEN: f64 = 0.1;
/// Two fits closer than this, in percentage points, are called equally good, as for the best model of a run.
const EQUAL_FIT_POINTS: f64 = 0.1;

/// What two sides of one candidate say about how well the record determines it.
#[derive(Debug)]
pub(crate) struct Candidate {
    /// Where it stands: `candidates[kelvin/closed-form/1]`, or nothing where the topic is the candidate.
    place: String,
    /// The smaller standard deviation of both sides, by parameter; infinite where a side calls the parameter not
    /// determined.
    deviations: BTreeMap<String, f64>,
}

impl Candidate {
    /// Two records with parameters and their uncertainty; `None` for anything else.
    pub(crate) fn from_records(place: &str, a: &Map<String, Value>, b: &Map<String, Value>) -> Option<Self> {
        let names = a.get("parameters")?.as_object()?.keys();
        let (known_a, known_b) = (a.get("uncertainty")?.as_object()?, b.get("uncertainty")?.as_object()?);
        let deviations = names
            .filter_map(|name| {
                if open(a, known_a, name) || open(b, known_b, name) {
                    return Some((name.clone(), f64::INFINITY));
                }
                Some((name.clone(), deviation(known_a, name)?.min(deviation(known_b, name)?)))
            })
            .collect();
        Some(Self { place: place.to_owned(), deviations })
    }

    /// The tolerance at a place of this candidate, where it is another one than the table's.
    pub(crate) fn tolerance(&self, place: &str, unit: Option<Unit>, table: Tolerance) -> Option<Tolerance> {
        let place = place.strip_prefix(&self.place)?.trim_start_matches('.');
        if let Some(name) = place.strip_prefix("parameters.") {
            let deviation = *self.deviations.get(name)?;
            let share = if self.is_open() { SHARE_BESIDE_OPEN } else { SHARE_OF_DEVIATION };
            return Some(Tolerance { abs: table.abs.max(share * deviation), ..table });
        }
        if !self.is_open() {
            return None;
        }
        // The part of the record that it was fitted to is a setting, however little the record determines.
        if place.starts_with("fit.") && place.ends_with("_s") {
            return None;
        }
        // One of many sets that fit equally well: its responses are the same to an engineer, its interior is not.
        match place.strip_prefix("simulation.") {
            Some("fit_percent" | "fit_as_measured_percent") => Some(Tolerance { abs: EQUAL_FIT_POINTS, rel: 0.0 }),
            Some("dynamic_crush_m" | "time_of_dynamic_crush_s") => Some(Tolerance::engineering(place, unit)),
            Some(_) => Some(Tolerance::ANY),
            None if place.starts_with("uncertainty") || place.starts_with("fit") || place.starts_with("notes") => {
                Some(Tolerance::ANY)
            }
            None => None,
        }
    }

    fn is_open(&self) -> bool {
        self.deviations.values().any(|deviation| deviation.is_infinite())
    }
}

/// Whether two rankings of a summary differ only in the order of candidates that are equally good on both sides: fits
/// within 0.1 points, or AICc within 2 (Burnham and Anderson 2002, section 2.6).
pub(crate) fn same_ranking(key: &str, a: &Map<String, Value>, b: &Map<String, Value>) -> bool {
    let (figures, equal) = match key {
        "ranking" => (&["fit_as_measured_percent", "fit_percent"][..], EQUAL_FIT_POINTS),
        "ranking_by_aicc" => (&["aicc"][..], 2.0),
        _ => return false,
    };
    let ids = |side: &Map<String, Value>| -> Option<Vec<String>> {
        side.get(key)?.as_array()?.iter().map(|id| id.as_str().map(str::to_owned)).collect()
    };
    let figure_of = |side: &Map<String, Value>, id: &str| {
        let all = side.get("candidates")?.as_array()?;
        let simulation = &all.iter().find(|candidate| candidate["id"] == id)?["simulation"];
        figures.iter().find_map(|figure| simulation[*figure].as_f64())
    };
    let apart = |side, x: &str, y: &str| Some((figure_of(side, x)? - figure_of(side, y)?).abs());
    let tied = |x: &str, y: &str| [a, b].into_iter().all(|side| apart(side, x, y).is_some_and(|d| d <= equal));
    let (Some(first), Some(second)) = (ids(a), ids(b)) else { return false };
    let set = |list: &[String]| list.iter().cloned().collect::<BTreeSet<_>>();
    set(&first) == set(&second) && first.iter().zip(&second).all(|(x, y)| x == y || tied(x, y))
}

fn deviation(known: &Map<String, Value>, name: &str) -> Option<f64> {
    known.get("standard_deviation")?.get(name)?.as_f64()
}

/// Not determined: a standard deviation as large as the value, or an interval open at both ends.
fn open(candidate: &Map<String, Value>, known: &Map<String, Value>, name: &str) -> bool {
    let value = candidate.get("parameters").and_then(|all| all.get(name)).and_then(Value::as_f64);
    let large = deviation(known, name).zip(value).is_some_and(|(d, value)| d >= value.abs());
    let ends = ["interval_low", "interval_high"];
    large || ends.iter().all(|end| known.get(*end).and_then(|all| all.get(name)).is_some_and(Value::is_null))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use crate::{Base, CompareSettings, Tolerances, compare_json};

    fn candidate(stiffness: f64, deviation: f64, fit: f64, energy: f64) -> serde_json::Value {
        json!({
            "parameters": {"k": stiffness, "mass": 873.0},
            "uncertainty": {
                "standard_deviation": {"k": deviation}, "interval_low": {"k": 1.0}, "interval_high": {"k": null},
            },
            "simulation": {"fit_percent": fit, "energy": [{"stored_j": energy}]},
        })
    }

    fn same(a: &serde_json::Value, b: &serde_json::Value) -> bool {
        compare_json("/parameters/kelvin/closed-form/1", a, b, &CompareSettings::default()).same
    }

    #[test]
    fn a_parameter_may_differ_by_a_hundredth_of_its_standard_deviation() {
        let reference = candidate(1000.0, 50.0, 99.0, 5.0);
        assert!(same(&reference, &candidate(1000.4, 50.0, 99.0, 5.0)));
        assert!(!same(&reference, &candidate(1000.6, 50.0, 99.0, 5.0)), "0.012 standard deviations");
        assert!(!same(&reference, &candidate(1000.4, 10.0, 99.0, 5.0)), "the smaller deviation of both counts");
        let exact = CompareSettings {
            tolerances: Tolerances { base: Base::Exact, ..Tolerances::default() },
            ..CompareSettings::default()
        };
        assert!(!compare_json("/parameters/x", &reference, &candidate(1000.4, 50.0, 99.0, 5.0), &exact).same);
    }

    #[test]
    fn of_a_candidate_that_its_record_leaves_open_the_response_counts_and_not_the_interior() {
        let open = candidate(1000.0, 2000.0, 99.0, 5.0);
        assert!(same(&open, &candidate(1700.0, 3000.0, 99.05, 9.0)));
        assert!(!same(&open, &candidate(1700.0, 3000.0, 98.0, 9.0)), "another fit");
        let fitted_to = |to_s: f64, rmse: f64| {
            let mut record = open.clone();
            record["fit"] = json!({"from_s": 0.0, "to_s": to_s, "rmse": rmse});
            record
        };
        assert!(same(&fitted_to(0.0772, 1.0), &fitted_to(0.0772, 2.0)));
        assert!(!same(&fitted_to(0.0772, 1.0), &fitted_to(77200.0, 1.0)), "another part of the record");
        let unknown = |stiffness: f64| {
            json!({
                "parameters": {"k": stiffness},
                "uncertainty": {"standard_deviation": {}, "interval_low": {"k": null}, "interval_high": {"k": null}},
            })
        };
        assert!(same(&unknown(1000.0), &unknown(1700.0)), "open without a deviation");
        assert!(
            !same(&candidate(1000.0, 50.0, 99.0, 5.0), &candidate(1000.0, 50.0, 99.0, 9.0)),
            "not open: all counts"
        );
    }

    #[test]
    fn equally_good_candidates_may_change_places_in_a_ranking() {
        let summary = |order: [&str; 2], fit: f64| {
            let candidates = json!([
                {"id": "a", "simulation": {"fit_percent": 99.00}},
                {"id": "b", "simulation": {"fit_percent": fit}},
            ]);
            json!({"candidates": candidates, "ranking": order})
        };
        let compare = |fit| {
            compare_json(
                "summary.json",
                &summary(["a", "b"], fit),
                &summary(["b", "a"], fit),
                &CompareSettings::default(),
            )
            .same
        };
        assert!(compare(99.05));
        assert!(!compare(99.5));
    }
}
