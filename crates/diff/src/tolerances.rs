//! How far two values may be apart: tables, rules of the user, units.

use std::collections::{BTreeMap, BTreeSet};

use crumple_artifact::{ToleranceRule, WAVE_PREFIX, topic_matches};

use crate::DiffError;
use crate::allowed::{Allowed, Tolerance, Unit, tolerance};
use crate::candidate::{Candidate, of_moved_rating, of_moved_simulation};
use crate::differences::Reason;

// Tolerances as a user writes them: TOML, one line a pattern.

/// Reads the limits that a pipeline states: the lines of a tolerance file by their patterns.
pub fn rules_of(lines: &BTreeMap<String, serde_json::Value>) -> Result<Vec<ToleranceRule>, DiffError> {
    lines.iter().map(|(pattern, line)| ToleranceRule::read(pattern, line).map_err(DiffError::Tolerance)).collect()
}

/// Reads the text of a tolerance file: `"<topic>#<place>" = { abs = 1e-6, rel = 1e-9 }` or `{ ignore = true }`.
///
/// `#<place>` may be left out: everything under the topic. An empty topic: every topic.
pub fn parse_rules(text: &str) -> Result<Vec<ToleranceRule>, DiffError> {
    let lines: BTreeMap<String, toml::Value> =
        toml::from_str(text).map_err(|error| DiffError::Tolerance(error.to_string().trim_end().to_owned()))?;
    lines.into_iter().map(|(pattern, line)| ToleranceRule::read(&pattern, line).map_err(DiffError::Tolerance)).collect()
}

// Settings of a comparison.

/// What counts as different.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CompareSettings {
    /// Tolerance by topic and place.
    pub tolerances: Tolerances,
    /// Whether -0.0 and 0.0 differ.
    pub bits: bool,
    /// Whether another stage version, configuration or input is a difference by itself.
    pub provenance: bool,
}

// The tolerance of every number: tables by topic and place, options and rules of the user.

/// The table to start from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Base {
    /// The same computation on the same data, on any processor.
    #[default]
    Computation,
    /// What an engineer calls the same result: 0.1 ms, 1 mm, 0.01 m/s, else 0.5 %.
    Engineering,
    /// Equal numbers.
    Exact,
}

/// The tolerance of every number.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tolerances {
    /// The table to start from.
    pub base: Base,
    /// Replaces every absolute part of the table.
    pub abs: Option<f64>,
    /// Replaces every relative part of the table.
    pub rel: Option<f64>,
    /// What the user says of single topics and places; goes before all else. The longest pattern that matches counts.
    pub rules: Vec<ToleranceRule>,
    /// Candidates with a parameter that both sides leave open, and that has moved
    /// ([`open_candidates`](crate::open_candidates)).
    pub open: BTreeSet<String>,
}

/// Topic pattern, place pattern, tolerance; the first that matches counts.
type Row = (&'static str, &'static str, Tolerance);

/// What is not the result: how many steps a solver took to it, which may differ where the last bit does, what the file
/// was called that a record came in, and the program that stood for a stage.
const ASIDE: [(&str, &str, Reason); 6] = [
    ("/parameters/*", "fit.iterations", Reason::SolverSteps),
    ("/parameters/*", "fit.evaluations", Reason::SolverSteps),
    ("summary.json", "candidates*fit.iterations", Reason::SolverSteps),
    ("summary.json", "candidates*fit.evaluations", Reason::SolverSteps),
    ("/test", "source.name", Reason::SourceName),
    ("summary.json", "programs*", Reason::ProgramName),
];

/// What a residual is worth, for every base. The number of its effective samples is known to a tenth at best, and so is
/// a criterion, a sum over them. Models whose criteria are less than 2 apart are equally supported (Burnham and
/// Anderson 2002, section 2.6).
const ESTIMATED: [Row; 8] = [
    ("/simulation/*", "effective_samples", tolerance(0.0, 0.1)),
    ("/simulation/*", "aicc", tolerance(0.2, 0.1)),
    ("/recommendation", "candidates*aicc", tolerance(0.2, 0.1)),
    ("/recommendation", "candidates*aicc_difference", tolerance(0.2, 0.1)),
    ("/recommendation", "candidates*difference_with_priors", tolerance(0.2, 0.1)),
    ("summary.json", "candidates*effective_samples", tolerance(0.0, 0.1)),
    ("summary.json", "candidates*aicc", tolerance(0.2, 0.1)),
    ("summary.json", "candidates*difference_with_priors", tolerance(0.2, 0.1)),
];

/// The last bit differs between processors (fused multiply-add, order of sums in matrix kernels). A last bit changed in
/// every sample moves filtered and integrated waveforms by 1e-15, eigenvalues and models by 3e-13, and fitted
/// parameters by up to 7e-7, since an iteration stops where its own criterion is met, not at the last bit. The table
/// leaves room beyond that; a standard deviation comes from an inverse and gets more.
/// The absolute floors are for what is zero but for rounding: 1e-12 of an SI unit, 1e-9 for errors of fits.
const COMPUTATION: [Row; 15] = [
    // Responses of fitted candidates: /wave/<model>/<method>/<index>/<quantity>.
    ("/wave/*/*/*/*", "*", tolerance(0.0, 1e-5)),
    ("/wave/*", "*", tolerance(0.0, 1e-9)),
    // Jitter and noise of perfect records are rounding errors, in sampling intervals and SI units.
    ("/quality/*", "*", tolerance(1e-9, 1e-9)),
    ("/model/*", "*", tolerance(1e-12, 1e-6)),
    ("/modes/*", "*", tolerance(1e-9, 1e-6)),
    ("/identification/*", "*", tolerance(1e-9, 1e-6)),
    // Whiteness and information criteria come from residuals, which are small differences.
    ("/evidence/*", "*", tolerance(1e-9, 1e-6)),
    // How sure a parameter is, is not known to more than this; of perfect records the residuals are rounding errors.
    ("/parameters/*", "uncertainty.*", tolerance(0.0, 0.1)),
    ("/parameters/*", "evaluation.*", tolerance(1e-6, 1e-5)),
    ("/parameters/*", "*", tolerance(1e-9, 1e-5)),
    // What it compares are fits and their motion; of a perfect fit the misfit is a rounding error.
    ("/recommendation", "*", tolerance(1e-6, 1e-5)),
    ("/simulation/*", "*", tolerance(1e-6, 1e-5)),
    // The report's summary repeats all of the above; each number is compared where it comes from.
    ("summary.json", "candidates*uncertainty*", tolerance(0.0, 0.1)),
    ("summary.json", "*", tolerance(1e-6, 1e-5)),
    ("*", "*", tolerance(1e-12, 1e-9)),
];

impl Tolerances {
    /// With rules of others too, which stand behind all that is typed: rules of the same pattern, `abs`, `rel`, and
    /// that every number is equal.
    pub fn with_rules(&self, others: Vec<ToleranceRule>) -> Self {
        if self.base == Base::Exact {
            return self.clone();
        }
        let behind = |other: ToleranceRule| match other.ignore {
            true => other,
            false => ToleranceRule { abs: self.abs.or(other.abs), rel: self.rel.or(other.rel), ..other },
        };
        let is_own = |other: &ToleranceRule| {
            self.rules.iter().any(|own| (&own.topic, &own.place) == (&other.topic, &other.place))
        };
        let others = others.into_iter().filter(|other| !is_own(other)).map(behind);
        Self { rules: self.rules.iter().cloned().chain(others).collect(), ..self.clone() }
    }

    /// Errors: a rule for topics that neither side has.
    pub fn refuse_unmatched<'a>(&self, topics: impl Iterator<Item = &'a str> + Clone) -> Result<(), DiffError> {
        match self.rules.iter().find(|rule| !topics.clone().any(|topic| topic_matches(&rule.topic, topic))) {
            None => Ok(()),
            Some(rule) => Err(DiffError::Tolerance(format!("{:?}: neither side has such a topic", rule.topic))),
        }
    }

    /// The tolerance of a number, or of a whole topic where `place` is empty; or why it is not compared.
    pub(crate) fn tolerance_of(
        &self,
        topic: &str,
        place: &str,
        unit: Option<Unit>,
        candidate: Option<&Candidate>,
    ) -> Allowed {
        let own = |tolerance: Tolerance| Tolerance {
            abs: self.abs.unwrap_or(tolerance.abs),
            rel: self.rel.unwrap_or(tolerance.rel),
        };
        let allowed = self.before_options(topic, place, unit, candidate).map(own);
        let rule = self
            .rules
            .iter()
            .filter(|rule| topic_matches(&rule.topic, topic) && topic_matches(&rule.place, place))
            .max_by_key(|rule| (rule.length(), &rule.topic, &rule.place));
        match rule {
            None => allowed,
            Some(rule) if rule.ignore => Err(Reason::Ignored),
            Some(rule) => {
                let rest = allowed.unwrap_or(Tolerance::ZERO);
                Ok(Tolerance { abs: rule.abs.unwrap_or(rest.abs), rel: rule.rel.unwrap_or(rest.rel) })
            }
        }
    }

    /// By table and candidate, before flags and rules of the user.
    fn before_options(&self, topic: &str, place: &str, unit: Option<Unit>, candidate: Option<&Candidate>) -> Allowed {
        if self.base == Base::Exact {
            return Ok(Tolerance::ZERO);
        }
        let is_row = |row: &&(&str, &str, Reason)| topic_matches(row.0, topic) && topic_matches(row.1, place);
        if let Some((_, _, reason)) = ASIDE.iter().find(is_row) {
            return Err(*reason);
        }
        let table = self.base_of(topic, place, unit);
        let by_its_record = match candidate {
            Some(known) => known.tolerance(place, unit, table),
            None => self.of_moved(topic, place, unit),
        };
        by_its_record.unwrap_or(Ok(table))
    }

    /// What hangs on a candidate with open parameters that have moved, outside its own record: its simulation, its
    /// waves, its line in the recommendation.
    fn of_moved(&self, topic: &str, place: &str, unit: Option<Unit>) -> Option<Allowed> {
        // What follows the id of such a candidate.
        let after = |text: &str, start: &str| {
            let text = text.strip_prefix(start)?;
            let mut rests = self.open.iter().filter_map(|id| text.strip_prefix(id.as_str()));
            rests.find(|rest| !rest.starts_with(char::is_numeric)).map(str::to_owned)
        };
        if after(topic, "/simulation/").is_some() && !place.is_empty() {
            return of_moved_simulation(place, unit);
        }
        if topic == "/recommendation" {
            return of_moved_rating(after(place, "candidates[")?.strip_prefix("].")?);
        }
        after(topic, WAVE_PREFIX).map(|_| Err(Reason::FollowsOpenParameter))
    }

    fn base_of(&self, topic: &str, place: &str, unit: Option<Unit>) -> Tolerance {
        let row = |rows: &[Row]| {
            rows.iter().find(|row| topic_matches(row.0, topic) && topic_matches(row.1, place)).map(|row| row.2)
        };
        let estimated = || row(&ESTIMATED);
        match self.base {
            Base::Exact => Tolerance::ZERO,
            Base::Computation => estimated().or_else(|| row(&COMPUTATION)).unwrap_or(Tolerance::ZERO),
            Base::Engineering => estimated().unwrap_or_else(|| Tolerance::engineering(place, unit)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse_rules;
    use crate::{Base, CompareSettings, Tolerances, compare_json};
    use serde_json::json;

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

    #[test]
    fn says_what_is_wrong_with_a_line() {
        let problem = |text: &str| parse_rules(text).unwrap_err().to_string();
        insta::assert_snapshot!(
            problem("\"/a\" = { abs = -1.0 }"),
            @"tolerances: \"/a\": -1 is no tolerance, expected a number from 0"
        );
        insta::assert_snapshot!(
            problem("\"/a\" = {}"),
            @"tolerances: \"/a\": no tolerance is given, expected abs, rel or ignore = true"
        );
        insta::assert_snapshot!(
            problem("\"/a\" = { ignore = true, abs = 1.0 }"),
            @"tolerances: \"/a\": ignore is given together with abs or rel, expected one or the other"
        );
        assert!(problem("\"/a\" = { relative = 1.0 }").contains("unknown field `relative`"));
        assert!(problem("\"/a\" = nan").starts_with("tolerances: \"/a\": invalid type"));
        assert!(problem("\"/a\" = {").contains("TOML parse error at line 1"));
    }

    #[test]
    fn rules_of_the_user_go_before_flags_and_flags_before_the_table() {
        let mut tolerances = Tolerances::default();
        let of = |tolerances: &Tolerances, topic: &str, place: &str| tolerances.tolerance_of(topic, place, None, None);
        assert_eq!(of(&tolerances, "/wave/93", ""), Ok(tolerance(0.0, 1e-9)));
        assert_eq!(of(&tolerances, "/wave/kelvin/closed-form/1/velocity", ""), Ok(tolerance(0.0, 1e-5)));
        tolerances.rel = Some(1e-3);
        assert_eq!(of(&tolerances, "/wave/93", ""), Ok(tolerance(0.0, 1e-3)));
        assert_eq!(of(&tolerances, "/parameters/kelvin/fit/1", "fit.iterations"), Err(Reason::SolverSteps));
        let place = "candidates[kelvin/fit/1].fit.iterations";
        assert_eq!(of(&tolerances, "summary.json", place), Err(Reason::SolverSteps));
        assert_eq!(of(&tolerances, "/test", "source.name"), Err(Reason::SourceName));
        tolerances.rules = parse_rules(
            "\"/wave/*\" = { abs = 2.0 }\n\"/wave/93\" = { rel = 0.0 }\n\"#*_m\" = { abs = 5.0 }\n\"/notes\" = { \
             ignore = true }",
        )
        .unwrap();
        assert_eq!(of(&tolerances, "/wave/94", ""), Ok(tolerance(2.0, 1e-3)));
        assert_eq!(of(&tolerances, "/wave/93", ""), Ok(tolerance(0.0, 0.0)), "the longest pattern counts alone");
        assert_eq!(of(&tolerances, "/events", "dynamic_crush_m").unwrap().abs, 5.0);
        assert_eq!(of(&tolerances, "/notes", "notes[0]"), Err(Reason::Ignored));
    }

    #[test]
    fn engineers_have_a_tolerance_by_unit() {
        let tolerances = Tolerances { base: Base::Engineering, ..Tolerances::default() };
        let of = |topic: &str, place: &str, unit| tolerances.tolerance_of(topic, place, unit, None).unwrap();
        assert_eq!(of("/events", "dynamic_crush_m", Some(Unit::Metre)).abs, 1e-3);
        assert_eq!(of("/events", "coefficient_of_restitution", None).rel, 5e-3);
        assert_eq!(of("/model/era-4/discrete", "sample_time_s", Some(Unit::Second)).abs, 0.0);
    }

    /// Every figure is a power of two, so that the limits are exact.
    #[test]
    fn both_parts_add_up_and_the_relative_one_refers_to_the_scale() {
        let both = tolerance(0.5, 0.25);
        assert!(both.allows(10.0, 11.5, 4.0), "0.5 + 0.25 * 4 is 1.5");
        assert!(!both.allows(10.0, 11.5, 3.9));
        assert!(!both.allows(10.0, 11.75, 4.0));
        assert!(tolerance(0.5, 0.0).allows(1e6, 1e6 + 0.5, 1e6));
        assert!(!tolerance(0.5, 0.0).allows(1e6, 1e6 + 0.625, 1e6));
        assert!(tolerance(0.0, 0.25).allows(-4.0, -3.0, 4.0) && !tolerance(0.0, 0.25).allows(-4.0, -2.5, 4.0));
        assert!(!Tolerance::ZERO.allows(0.0, f64::MIN_POSITIVE, 1.0));
    }

    #[test]
    fn names_tell_the_unit() {
        let unit_of = |key| Unit::of_field(key, None);
        assert_eq!(unit_of("dynamic_crush_m"), Some(Unit::Metre));
        assert_eq!(unit_of("time_of_dynamic_crush_s"), Some(Unit::Second));
        assert_eq!(unit_of("delta_v_m_per_s"), Some(Unit::MetrePerSecond));
        for other in ["stiffness_n_per_m", "damping_n_s_per_m", "re_per_s", "im_rad_per_s", "mass_kg", "value"] {
            assert_eq!(unit_of(other), None, "{other}");
        }
        assert_eq!(Unit::of_field("value", Some(&json!("m/s"))), Some(Unit::MetrePerSecond));
        assert_eq!(Unit::of_field("value", Some(&json!("m/s^2"))), None);
    }
}
