//! The tolerance of every number: tables by topic and place, options and rules of the user.

use crumple_artifact::topic_matches;

use super::candidate::Candidate;
use super::rules::ToleranceRule;
use super::tolerance::{Tolerance, tolerance};
use super::unit::Unit;

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
}

/// Topic pattern, place pattern, tolerance; the first that matches counts.
type Row = (&'static str, &'static str, Tolerance);

/// What is not the result: how many steps a solver took to it, which may differ where the last bit does, and what the
/// file was called that a record came in.
const ASIDE: [Row; 5] = [
    ("/parameters/*", "fit.iterations", Tolerance::ANY),
    ("/parameters/*", "fit.evaluations", Tolerance::ANY),
    ("summary.json", "candidates*fit.iterations", Tolerance::ANY),
    ("summary.json", "candidates*fit.evaluations", Tolerance::ANY),
    ("/test", "source.name", Tolerance::ANY),
];

/// The last bit differs between processors (fused multiply-add, order of sums in matrix kernels). A last bit changed in
/// every sample moves filtered and integrated waveforms by 1e-15, eigenvalues and models by 3e-13, and fitted
/// parameters by up to 7e-7, since an iteration stops where its own criterion is met, not at the last bit. The table
/// leaves room beyond that; a standard deviation comes from an inverse and gets more.
/// The absolute floors are for what is zero but for rounding: 1e-12 of an SI unit, 1e-9 for errors of fits.
const COMPUTATION: [Row; 17] = [
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
    ("/parameters/*", "*", tolerance(1e-9, 1e-5)),
    ("/simulation/*", "effective_samples", tolerance(0.0, 0.1)),
    // Models whose criteria are less than 2 apart are equally supported (Burnham and Anderson 2002, section 2.6).
    ("/simulation/*", "aicc", tolerance(0.2, 0.0)),
    ("/simulation/*", "*", tolerance(1e-6, 1e-5)),
    // The report's summary repeats all of the above; each number is compared where it comes from.
    ("summary.json", "candidates*uncertainty*", tolerance(0.0, 0.1)),
    ("summary.json", "candidates*effective_samples", tolerance(0.0, 0.1)),
    ("summary.json", "candidates*aicc", tolerance(0.2, 0.0)),
    ("summary.json", "*", tolerance(1e-6, 1e-5)),
    ("*", "*", tolerance(1e-12, 1e-9)),
];

impl Tolerances {
    /// The tolerance of a number, or of a whole topic where `place` is empty.
    pub(crate) fn tolerance_of(
        &self,
        topic: &str,
        place: &str,
        unit: Option<Unit>,
        candidate: Option<&Candidate>,
    ) -> Tolerance {
        let table = self.base_of(topic, place, unit);
        let in_candidate = candidate.filter(|_| self.base != Base::Exact && !table.is_any());
        let mut tolerance = in_candidate.and_then(|known| known.tolerance(place, unit, table)).unwrap_or(table);
        if !tolerance.is_any() {
            tolerance.abs = self.abs.unwrap_or(tolerance.abs);
            tolerance.rel = self.rel.unwrap_or(tolerance.rel);
        }
        let rule = self
            .rules
            .iter()
            .filter(|rule| topic_matches(&rule.topic, topic) && topic_matches(&rule.place, place))
            .max_by_key(|rule| (rule.length(), &rule.topic, &rule.place));
        match rule {
            None => tolerance,
            Some(rule) if rule.ignore => Tolerance::ANY,
            Some(rule) => {
                let rest = if tolerance.is_any() { Tolerance::ZERO } else { tolerance };
                Tolerance { abs: rule.abs.unwrap_or(rest.abs), rel: rule.rel.unwrap_or(rest.rel) }
            }
        }
    }

    fn base_of(&self, topic: &str, place: &str, unit: Option<Unit>) -> Tolerance {
        let row = |rows: &[Row]| {
            rows.iter().find(|row| topic_matches(row.0, topic) && topic_matches(row.1, place)).map(|row| row.2)
        };
        match self.base {
            Base::Exact => Tolerance::ZERO,
            Base::Computation => row(&ASIDE).or_else(|| row(&COMPUTATION)).unwrap_or(Tolerance::ZERO),
            Base::Engineering => row(&ASIDE).unwrap_or_else(|| Tolerance::engineering(place, unit)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse_rules;

    #[test]
    fn rules_of_the_user_go_before_flags_and_flags_before_the_table() {
        let mut tolerances = Tolerances::default();
        assert_eq!(tolerances.tolerance_of("/wave/93", "", None, None), tolerance(0.0, 1e-9));
        assert_eq!(
            tolerances.tolerance_of("/wave/kelvin/closed-form/1/velocity", "", None, None),
            tolerance(0.0, 1e-5)
        );
        tolerances.rel = Some(1e-3);
        assert_eq!(tolerances.tolerance_of("/wave/93", "", None, None), tolerance(0.0, 1e-3));
        assert!(tolerances.tolerance_of("/parameters/kelvin/fit/1", "fit.iterations", None, None).is_any());
        assert!(
            tolerances.tolerance_of("summary.json", "candidates[kelvin/fit/1].fit.iterations", None, None).is_any()
        );
        tolerances.rules = parse_rules(
            "\"/wave/*\" = { abs = 2.0 }\n\"/wave/93\" = { rel = 0.0 }\n\"#*_m\" = { abs = 5.0 }\n\"/notes\" = { \
             ignore = true }",
        )
        .unwrap();
        assert_eq!(tolerances.tolerance_of("/wave/94", "", None, None), tolerance(2.0, 1e-3));
        assert_eq!(
            tolerances.tolerance_of("/wave/93", "", None, None),
            tolerance(0.0, 0.0),
            "the longest pattern counts alone"
        );
        assert_eq!(tolerances.tolerance_of("/events", "dynamic_crush_m", None, None).abs, 5.0);
        assert!(tolerances.tolerance_of("/notes", "notes[0]", None, None).is_any());
    }

    #[test]
    fn engineers_have_a_tolerance_by_unit() {
        let tolerances = Tolerances { base: Base::Engineering, ..Tolerances::default() };
        assert_eq!(tolerances.tolerance_of("/events", "dynamic_crush_m", Some(Unit::Metre), None).abs, 1e-3);
        assert_eq!(tolerances.tolerance_of("/events", "coefficient_of_restitution", None, None).rel, 5e-3);
        assert_eq!(
            tolerances.tolerance_of("/model/era-4/discrete", "sample_time_s", Some(Unit::Second), None).abs,
            0.0
        );
    }
}
