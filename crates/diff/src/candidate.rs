//! Candidates of parameter solving: how far apart two of them may be, given what their record determines.

use std::collections::{BTreeMap, BTreeSet};

use crumple_artifact::records::CandidateV1;
use serde_json::{Map, Value};

use crate::Tolerance;
use crate::allowed::{Allowed, Unit, tolerance};
use crate::differences::{Reason, Side};

/// Share of its standard deviation by which a parameter may differ: it moves no interval in its second digit.
const SHARE_OF_DEVIATION: f64 = 0.01;

/// The same of a parameter beside others that the record leaves open and that have moved: it gives way with them along
/// the valley they lie in.
const SHARE_BESIDE_OPEN: f64 = 0.1;

/// Open parameters that are apart by more than this share have moved. The last bit of a sample moves one in a flat
/// valley by 1e-14 to 1e-4; one on a bound of its search stays where it is.
const MOVED: f64 = 1e-9;

/// Two fits closer than this, in percentage points, are called equally good, as for the best model of a run.
pub(crate) const EQUAL_FIT_POINTS: f64 = 0.1;

/// How sure a parameter is, is not known to more than this; nor is what a residual is worth.
const ESTIMATE: f64 = 0.1;

/// Errors of crush and its time are shares of those of the test: what an engineer calls the same is 0.5 % of them.
const EQUAL_ERROR: Tolerance = tolerance(5e-3, 0.0);

/// What two sides of one candidate say about how well the record determines it.
#[derive(Debug, Default)]
pub(crate) struct Candidate {
    /// Where it stands: `candidates[kelvin/closed-form/1]`, or nothing where the topic is the candidate.
    place: String,
    /// The smaller standard deviation of the sides that determine a parameter.
    deviations: BTreeMap<String, f64>,
    /// Parameters that both sides leave open.
    open: BTreeSet<String>,
    /// The side that determines a parameter, where the other leaves it open.
    determined: BTreeMap<String, Side>,
    /// Whether a parameter that both sides leave open has another value: what follows from it is another one of many.
    is_moved: bool,
    /// Parameters in the order of the correlation matrix.
    order: Vec<String>,
    /// Parameters in the order of the profiles.
    profiles: Vec<String>,
}

impl Candidate {
    /// Two records with parameters and what is known of them; `None` for anything else.
    pub(crate) fn from_records(place: &str, a: &Map<String, Value>, b: &Map<String, Value>) -> Option<Self> {
        let sides = [candidate_of(a)?, candidate_of(b)?];
        let deviation = |side: &CandidateV1, name| side.uncertainty.as_ref()?.standard_deviation.get(name).copied();
        let mut candidate = Self { place: place.to_owned(), ..Self::default() };
        for (name, x) in &sides[0].parameters {
            let Some(y) = sides[1].parameters.get(name) else { continue };
            let known = match sides.each_ref().map(|side| side.doubt(name).is_some()) {
                [true, true] => {
                    candidate.open.insert(name.clone());
                    candidate.is_moved |= (x - y).abs() > MOVED * x.abs().max(y.abs());
                    continue;
                }
                [false, true] => {
                    candidate.determined.insert(name.clone(), Side::A);
                    deviation(&sides[0], name)
                }
                [true, false] => {
                    candidate.determined.insert(name.clone(), Side::B);
                    deviation(&sides[1], name)
                }
                [false, false] => deviation(&sides[0], name).zip(deviation(&sides[1], name)).map(|(a, b)| a.min(b)),
            };
            candidate.deviations.extend(known.map(|deviation| (name.clone(), deviation)));
        }
        if let Some(known) = &sides[0].uncertainty {
            candidate.order.clone_from(&known.order);
            candidate.profiles = known.profile.iter().map(|profile| profile.parameter.clone()).collect();
        }
        Some(candidate)
    }

    /// Whether a parameter that both sides leave open has another value.
    pub(crate) fn is_moved(&self) -> bool {
        self.is_moved
    }

    /// The side that determines the parameter at a place, where the other leaves it open.
    pub(crate) fn determined_on(&self, place: &str) -> Option<Side> {
        self.determined.get(self.within(place)?.strip_prefix("parameters.")?).copied()
    }

    /// The names in a list of bounds without those of open parameters, which may be on a bound or not; `None` at other
    /// places.
    pub(crate) fn bounds_beside_open(&self, place: &str, list: &[Value]) -> Option<Vec<Value>> {
        let is_open = |name: &&Value| name.as_str().is_some_and(|name| self.open.contains(name));
        let is_list = self.is_moved && self.within(place)? == "fit.active_bounds";
        is_list.then(|| list.iter().filter(|name| !is_open(name)).cloned().collect())
    }

    /// The tolerance at a place of this candidate, where it is another one than the table's.
    pub(crate) fn tolerance(&self, place: &str, unit: Option<Unit>, table: Tolerance) -> Option<Allowed> {
        let (part, figure) = self.within(place)?.split_once('.')?;
        match part {
            "parameters" if self.open.contains(figure) => Some(Err(Reason::OpenParameter)),
            "parameters" => {
                let share = if self.is_moved { SHARE_BESIDE_OPEN } else { SHARE_OF_DEVIATION };
                let deviation = *self.deviations.get(figure)?;
                Some(Ok(Tolerance { abs: table.abs.max(share * deviation), ..table }))
            }
            "uncertainty" => self.of_uncertainty(figure, table),
            "simulation" | "evaluation" if self.is_moved => of_moved_simulation(figure, unit),
            "fit" if self.is_moved && figure == "stop_reason" => Some(Err(Reason::SolverSteps)),
            "fit" if self.is_moved && figure.ends_with("rmse") => Some(Ok(tolerance(table.abs, ESTIMATE))),
            _ => None,
        }
    }

    /// How well parameters are known: of those that are open it is not compared.
    fn of_uncertainty(&self, place: &str, table: Tolerance) -> Option<Allowed> {
        let parts: Vec<&str> = place.split(['.', '[', ']']).filter(|part| !part.is_empty()).collect();
        let named = |list: &[String], index: &str| list.get(index.parse::<usize>().ok()?).cloned();
        let parameters = match parts[..] {
            ["correlation", row, column] => vec![named(&self.order, row), named(&self.order, column)],
            ["profile", index, ..] => vec![named(&self.profiles, index)],
            [.., last] => vec![Some(last.to_owned())],
            [] => Vec::new(),
        };
        if parameters.iter().flatten().any(|name| self.open.contains(name)) {
            return Some(Err(Reason::OpenParameter));
        }
        if !self.is_moved {
            return None;
        }
        match parts[..] {
            ["condition" | "weakest_direction"] => Some(Err(Reason::FollowsOpenParameter)),
            ["rank"] => None,
            // An interval moves with its parameter.
            [.., "interval_low" | "interval_high" | "low" | "high", name] => {
                let deviation = self.deviations.get(name).copied().unwrap_or(0.0);
                Some(Ok(tolerance(table.abs.max(SHARE_BESIDE_OPEN * deviation), ESTIMATE)))
            }
            _ => Some(Ok(tolerance(table.abs, ESTIMATE))),
        }
    }

    fn within<'a>(&self, place: &'a str) -> Option<&'a str> {
        Some(place.strip_prefix(&self.place)?.trim_start_matches('.'))
    }
}

/// The tolerance in the simulation of a candidate whose open parameters have moved; `None`: the table's. It is one of
/// many sets that fit equally well: its motion in the window of the fit is the same to an engineer. Its interior and
/// its motion beyond are not compared.
pub(crate) fn of_moved_simulation(figure: &str, unit: Option<Unit>) -> Option<Allowed> {
    match figure {
        "fit_percent" | "fit_as_measured_percent" | "fit_velocity_percent" | "fit_acceleration_percent" => {
            Some(Ok(tolerance(EQUAL_FIT_POINTS, 0.0)))
        }
        "dynamic_crush_m"
        | "time_of_dynamic_crush_s"
        | "rmse_displacement_m"
        | "dynamic_crush_error_m"
        | "time_of_dynamic_crush_error_s"
        | "max_displacement_error_m" => Some(Ok(Tolerance::engineering(figure, unit))),
        "crush_error" | "time_error" => Some(Ok(EQUAL_ERROR)),
        "from_s" | "to_s" | "fitted_parameters" | "drive" | "aicc" | "effective_samples" => None,
        _ if figure.starts_with("notes") => None,
        _ => Some(Err(Reason::FollowsOpenParameter)),
    }
}

/// The same in its line of a recommendation.
pub(crate) fn of_moved_rating(figure: &str) -> Option<Allowed> {
    match figure {
        "crush_error" | "time_error" => Some(Ok(EQUAL_ERROR)),
        "fit_as_measured_percent" => Some(Ok(tolerance(EQUAL_FIT_POINTS, 0.0))),
        "misfit" => Some(Ok(tolerance(0.0, ESTIMATE))),
        // exp(-d/2) of a difference that is known to 0.2.
        "weight" => Some(Ok(tolerance(0.01, ESTIMATE))),
        "coefficient_of_restitution" | "restitution_error" | "force_misfit_percent" => {
            Some(Err(Reason::FollowsOpenParameter))
        }
        _ if figure.ends_with("].term") || figure.starts_with("log_deviations") => {
            Some(Err(Reason::FollowsOpenParameter))
        }
        _ => None,
    }
}

/// The parts of a record that say how well its parameters are known: the record itself judges by them
/// ([`CandidateV1::doubt`]). `None` for a record without uncertainty and without a fit.
fn candidate_of(record: &Map<String, Value>) -> Option<CandidateV1> {
    let part = |key: &str| record.get(key).cloned().unwrap_or_default();
    let mut uncertainty = part("uncertainty");
    if let Some(known) = uncertainty.as_object_mut() {
        known.entry("method").or_insert_with(|| "".into());
    }
    let candidate = CandidateV1 {
        parameters: serde_json::from_value(part("parameters")).ok()?,
        uncertainty: serde_json::from_value(uncertainty).ok()?,
        fit: serde_json::from_value(part("fit")).unwrap_or_default(),
        ..CandidateV1::default()
    };
    (candidate.uncertainty.is_some() || candidate.fit.is_some()).then_some(candidate)
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::differences::TopicReport;
    use crate::{Base, CompareSettings, Comparison, FileReport, TextOptions, Tolerances};
    use crate::{compare_artifacts, compare_json, open_candidates, write_text};
    use crumple_artifact::Artifact;
    use serde_json::json;

    fn settings(base: Base) -> CompareSettings {
        CompareSettings { tolerances: Tolerances { base, ..Tolerances::default() }, ..CompareSettings::default() }
    }

    /// A spring that the record determines or not, a damper that is zero, and a given mass.
    fn candidate(stiffness: f64, deviation: f64) -> Value {
        json!({
            "parameters": {"k_n_per_m": stiffness, "c_n_s_per_m": 0.0, "mass_kg": 873.0},
            "fit": {"channel": "93", "quantity": "displacement", "from_s": 0.0, "to_s": 0.0772, "samples": 772,
                "rmse": 1e-3, "iterations": 12, "evaluations": 300, "stop_reason": "cost-converged",
                "active_bounds": ["c_n_s_per_m"]},
            "uncertainty": {
                "method": "linearised",
                "standard_deviation": {"k_n_per_m": deviation, "c_n_s_per_m": 0.3}, "condition": 25.0,
                "interval_low": {"k_n_per_m": 1.0, "c_n_s_per_m": 0.0},
                "interval_high": {"k_n_per_m": null, "c_n_s_per_m": 0.6},
                "order": ["k_n_per_m", "c_n_s_per_m"], "correlation": [[1.0, 0.5], [0.5, 1.0]],
            },
            "simulation": {"fit_percent": 99.0, "dynamic_crush_m": 0.45, "energy": [{"stored_j": 5.0}]},
            "notes": ["the damper is zero"],
        })
    }

    /// The candidate with another value at a JSON pointer.
    fn with(candidate: &Value, pointer: &str, value: Value) -> Value {
        let mut changed = candidate.clone();
        *changed.pointer_mut(pointer).unwrap() = value;
        changed
    }

    fn compare(a: &Value, b: &Value) -> TopicReport {
        compare_json("/parameters/kelvin/direct-fit/1", a, b, &settings(Base::Computation))
    }

    fn places(a: &Value, b: &Value) -> Vec<String> {
        compare(a, b).differences.into_iter().map(|difference| difference.place).collect()
    }

    fn count(report: &TopicReport, reason: Reason) -> u64 {
        report.not_compared.iter().filter(|left| left.reason == reason).map(|left| left.count).sum()
    }

    /// What is printed of a comparison.
    fn text(topic: TopicReport) -> String {
        let file = FileReport { name: "5-parameter-solve.mcap".into(), same: topic.same, ..FileReport::default() };
        let file = FileReport { topics: vec![topic], ..file };
        let report = Comparison::new("a".into(), "b".into(), false, vec![file]);
        let mut text = Vec::new();
        write_text(&report, TextOptions { all: true }, &mut text).unwrap();
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn a_parameter_may_differ_by_a_hundredth_of_its_standard_deviation() {
        let reference = candidate(1000.0, 50.0);
        assert!(compare(&reference, &candidate(1000.4, 50.0)).same);
        assert!(!compare(&reference, &candidate(1000.6, 50.0)).same, "0.012 standard deviations");
        assert!(!compare(&reference, &candidate(1000.4, 10.0)).same, "the smaller deviation of both counts");
        assert!(!compare_json("/parameters/x", &reference, &candidate(1000.4, 50.0), &settings(Base::Exact)).same);
    }

    #[test]
    fn what_one_side_leaves_open_is_a_difference_by_itself() {
        let (known, open) = (candidate(330e3, 6.0), candidate(1000e3, 2000e3));
        let says = |a: &Value, b: &Value| text(compare(a, b)).replace("/parameters/kelvin/direct-fit/1, ", "");
        insta::assert_snapshot!(says(&known, &open), @"
        parameters.k_n_per_m: 330000.0  1000000.0  (abs 670000, rel 0.67), k is no longer determined
        uncertainty.standard_deviation.k_n_per_m: 6.0  2000000.0  (abs 2.0e6, rel 1)
        2 values are not compared: steps of solvers
        different: 1 of 1 topics
        ");
        assert!(says(&open, &known).contains("1000000.0  330000.0  (abs 670000, rel 0.67), k is determined now\n"));
        // The same value: its deviation alone says that it is one of many.
        let loose = candidate(330e3, 330e3);
        assert_eq!(places(&known, &loose), ["parameters.k_n_per_m", "uncertainty.standard_deviation.k_n_per_m"]);
        let summary = |of: &Value| {
            let mut of = of.clone();
            of["id"] = json!("kelvin/direct-fit/1");
            json!({"candidates": [of]})
        };
        let report = compare_json("summary.json", &summary(&known), &summary(&loose), &settings(Base::Engineering));
        assert_eq!(report.differences[0].place, "candidates[kelvin/direct-fit/1].parameters.k_n_per_m");
        assert_eq!(report.differences[0].determined, Some(Side::A));
    }

    #[test]
    fn what_is_known_of_a_zero_is_compared() {
        let known = candidate(330e3, 6.0);
        for (deviation, is_same) in [(0.3, true), (0.31, true), (0.36, false), (300.0, false), (0.0, false)] {
            let other = with(&known, "/uncertainty/standard_deviation/c_n_s_per_m", json!(deviation));
            assert_eq!(compare(&known, &other).same, is_same, "{deviation}");
        }
        let wide = with(&known, "/uncertainty/interval_high/c_n_s_per_m", json!(600.0));
        assert_eq!(places(&known, &wide), ["uncertainty.interval_high.c_n_s_per_m"]);
        assert_eq!(places(&with(&known, "/parameters/c_n_s_per_m", json!(2500.0)), &known), ["parameters.c_n_s_per_m"]);
    }

    #[test]
    fn of_what_both_sides_leave_open_nothing_is_compared_and_all_is_counted() {
        let report = compare(&candidate(1000.0, 2000.0), &candidate(1700.0, 3000.0));
        assert!(report.same, "{report:?}");
        // Its value, its deviation, both ends, and three of four correlations.
        assert_eq!(count(&report, Reason::OpenParameter), 7);
        // The condition and an energy.
        assert_eq!(count(&report, Reason::FollowsOpenParameter), 2);
        assert_eq!(count(&report, Reason::SolverSteps), 3);
        insta::assert_snapshot!(text(report).replace(", what", ",\nwhat"), @"
        12 values are not compared: parameters that both sides leave open (7),
        what follows from such parameters (2), steps of solvers (3)
        same within tolerance: 19 values in 1 topic, none differs
        ");
    }

    #[test]
    fn beside_what_is_open_the_rest_is_compared() {
        let open = candidate(1000.0, 2000.0);
        let moved = candidate(1700.0, 3000.0);
        for (pointer, same, differs) in [
            ("/simulation/fit_percent", json!(99.05), json!(98.0)),
            ("/simulation/dynamic_crush_m", json!(0.4505), json!(0.46)),
            ("/fit/rmse", json!(1.05e-3), json!(2e-3)),
            ("/fit/to_s", json!(0.0772), json!(77.2)),
            ("/uncertainty/standard_deviation/c_n_s_per_m", json!(0.32), json!(300.0)),
            ("/uncertainty/interval_high/c_n_s_per_m", json!(0.64), json!(600.0)),
            ("/notes/0", json!("the damper is zero"), json!("the spring is zero")),
        ] {
            assert_eq!(places(&open, &with(&moved, pointer, same)), Vec::<String>::new(), "{pointer}");
            assert_eq!(places(&open, &with(&moved, pointer, differs)).len(), 1, "{pointer}");
        }
        // What follows from open parameters is compared where they have not moved.
        let other = with(&open, "/simulation/energy/0/stored_j", json!(9.0));
        assert_eq!(places(&open, &other), ["simulation.energy[0].stored_j"]);
        assert_eq!(places(&moved, &other), Vec::<String>::new());
    }

    #[test]
    fn a_parameter_is_open_on_a_bound_or_without_an_interval_too() {
        let known = candidate(330e3, 6.0);
        let bounds = json!(["k_n_per_m", "c_n_s_per_m"]);
        let on_bound = |stiffness| with(&candidate(stiffness, 6.0), "/fit/active_bounds", bounds.clone());
        assert!(compare(&on_bound(1e9), &on_bound(2e9)).same);
        assert_eq!(compare(&known, &on_bound(330e3)).differences.last().unwrap().determined, Some(Side::A));
        let unknown = |stiffness: f64| {
            let ends = json!({"k": null});
            json!({"parameters": {"k": stiffness}, "uncertainty": {"standard_deviation": {}, "interval_low": ends,
                "interval_high": ends}})
        };
        assert!(compare(&unknown(1000.0), &unknown(1700.0)).same, "open without a deviation");
    }

    /// A case that is shared between the makers; `None`, with a word, where it is not here.
    fn shared(case: &str) -> Option<PathBuf> {
        let folder = std::env::var_os("CRUMPLE_SHARED").map(PathBuf::from)?.join("reference/cases").join(case);
        folder.is_dir().then_some(folder)
    }

    #[test]
    fn a_parameter_that_one_side_calls_open_hides_no_change() {
        let Some(folder) = shared("T4-f03-open-parameter-hides-a-change") else {
            eprintln!("SKIPPED: CRUMPLE_SHARED has no T4-f03-open-parameter-hides-a-change");
            return;
        };
        let open = |name: &str| Artifact::open(&folder.join(name)).unwrap();
        let a = open("a.mcap");
        for (name, parameter, determined) in [
            ("b-three-times-the-stiffness.mcap", "parameters.stiffness_n_per_m", Some(Side::A)),
            ("b-no-damping.mcap", "parameters.damping_n_s_per_m", None),
        ] {
            let b = open(name);
            for base in [Base::Engineering, Base::Computation] {
                let mut settings = settings(base);
                settings.tolerances.open = open_candidates(&a, &b).unwrap();
                let report = compare_artifacts(name, &a, &b, &settings).unwrap();
                let differences: Vec<_> = report.topics.iter().flat_map(|topic| &topic.differences).collect();
                let named = differences.iter().find(|difference| difference.place == parameter);
                assert_eq!(named.map(|difference| difference.determined), Some(determined), "{name}, {base:?}");
            }
        }
    }
}
