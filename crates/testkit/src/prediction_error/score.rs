//! Scores of predictions, and their tables.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use crumple_numerics::estimation::statistics::quantile;
use serde_json::Value;

use crate::prediction_error::car::Truth;
use crate::prediction_error::kind::KINDS;

/// The answers that a car is asked for: speed in km/h, factor of the mass. The kind at the pole, which is tested at 35,
/// is asked at 5/8 of these speeds.
pub(crate) const ASKED: [(f64, f64); 8] =
    [(56.0, 1.0), (30.0, 1.0), (40.0, 1.0), (48.0, 1.0), (64.0, 1.0), (72.0, 1.0), (56.0, 0.8), (56.0, 1.2)];
/// Places in [`ASKED`]: the test that was made, the speed that the status of a run is asked at, and what the cover of
/// intervals is counted over.
pub(crate) const OWN_TEST: usize = 0;
pub(crate) const LOWER: usize = 2;
const COUNTED: [usize; 5] = [2, 3, 4, 6, 7];

/// A number that is predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Dynamic crush.
    Crush,
    /// Its time.
    Time,
    /// Largest deceleration behind CFC 60.
    Peak,
    /// Change of velocity.
    DeltaV,
    /// Coefficient of restitution.
    Restitution,
}

impl Quantity {
    /// All of them, in the order of a [`Prediction`].
    pub(crate) const ALL: [Self; 5] = [Self::Crush, Self::Time, Self::Peak, Self::DeltaV, Self::Restitution];

    /// Name in the tables.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Crush => "dynamic crush",
            Self::Time => "time of dynamic crush",
            Self::Peak => "peak behind CFC 60",
            Self::DeltaV => "delta-v",
            Self::Restitution => "coefficient of restitution (difference times 100)",
        }
    }

    /// Field in the record of a prediction, and name of its interval.
    fn field(self) -> &'static str {
        match self {
            Self::Crush => "dynamic_crush_m",
            Self::Time => "time_of_dynamic_crush_s",
            Self::Peak => "peak_acceleration_m_per_s2",
            Self::DeltaV => "delta_v_m_per_s",
            Self::Restitution => "coefficient_of_restitution",
        }
    }

    fn of(self, truth: &Truth) -> f64 {
        match self {
            Self::Crush => truth.crush_m,
            Self::Time => truth.time_s,
            Self::Peak => truth.peak_m_per_s2,
            Self::DeltaV => truth.delta_v_m_per_s,
            Self::Restitution => truth.restitution,
        }
    }

    /// Error of a value: over the truth, but of restitution, which is a ratio itself.
    fn error(self, value: f64, truth: f64) -> f64 {
        if self == Self::Restitution { value - truth } else { value / truth - 1.0 }
    }
}

/// A predicted number beside the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scored {
    /// Over the truth; of restitution the difference.
    pub error: f64,
    /// The 90 % interval: whether it holds the truth, and its width over the truth.
    pub interval: Option<(bool, f64)>,
}

/// The numbers of one prediction in the order of `Quantity`; `None` where one was not predicted: a model that never
/// stops has no crush.
pub type Prediction = [Option<Scored>; 5];

/// A record `/prediction/<n>` beside the truth.
pub(crate) fn scored(record: &Value, truth: &Truth) -> Prediction {
    Quantity::ALL.map(|quantity| {
        let (value, truth) = (record[quantity.field()].as_f64()?.abs(), quantity.of(truth));
        let mut intervals = record["intervals"].as_array().into_iter().flatten();
        let interval = intervals.find(|interval| interval["name"] == quantity.field()).and_then(|interval| {
            let ends = [interval["low"].as_f64()?, interval["high"].as_f64()?];
            Some((ends[0] <= truth && truth <= ends[1], (ends[1] - ends[0]) / truth))
        });
        Some(Scored { error: quantity.error(value, truth), interval })
    })
}

/// What one car would show beside what another one does.
pub(crate) fn scored_truth(predicted: &Truth, truth: &Truth) -> Prediction {
    Quantity::ALL.map(|quantity| {
        Some(Scored { error: quantity.error(quantity.of(predicted), quantity.of(truth)), interval: None })
    })
}

/// Who answers.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Answer {
    /// The candidate that the programs recommend for prediction.
    Recommended,
    /// The car itself, its curves known as far as its tests crushed them: what no model of these tests can know.
    CarItself,
    /// The first candidate of this model and method.
    Candidate(String),
}

/// A car and what was predicted for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Its kind.
    pub kind: &'static str,
    /// Its number within the kind.
    pub number: usize,
    /// Crush and peak at the lower speed over those of its test.
    pub lower_ratios: [f64; 2],
    /// Model and method that were recommended; `None` where none was.
    pub recommended: Option<String>,
    /// Status of the run in `summary.json`, asked at the lower speed; `None` where it says none.
    pub status: Option<String>,
    /// By answer, in the order in which they are asked; `None` where an answer is missing.
    pub predictions: Vec<(Answer, Vec<Option<Prediction>>)>,
}

impl Outcome {
    /// What was predicted at a question.
    pub(crate) fn prediction(&self, who: &Answer, question: usize) -> Option<Prediction> {
        self.predictions.iter().find(|(answer, _)| answer == who)?.1[question]
    }

    /// Error of a quantity that the recommended model predicts.
    pub(crate) fn error(&self, quantity: Quantity, question: usize) -> Option<f64> {
        Some(self.prediction(&Answer::Recommended, question)?[quantity as usize]?.error)
    }

    /// Whether a model that does not stay crushed is recommended.
    pub(crate) fn is_damped(&self) -> bool {
        let model = self.recommended.as_deref().and_then(|id| id.split('/').next());
        model.is_some_and(|model| !["elastoplastic", "force-deflection"].contains(&model))
    }

    /// Whether the recommended model repeats the test it was fitted to: it stops, with its crush within 3.5 %, its time
    /// within 5 % and its restitution within 0.1.
    pub(crate) fn repeats_own_test(&self) -> bool {
        let limits = [(Quantity::Crush, 0.035), (Quantity::Time, 0.05), (Quantity::Restitution, 0.1)];
        limits.iter().all(|(quantity, limit)| self.error(*quantity, OWN_TEST).is_some_and(|e| e.abs() <= *limit))
    }
}

/// A status of `summary.json` that says a model may be relied on.
const USABLE: &str = "usable";
/// Place in [`ASKED`] of the speed above the tested one.
const HIGHER: usize = 4;

/// All tables: counts and what is recommended by kind; errors and intervals of each quantity by kind and question; the
/// cover of all intervals; errors of the car itself; every candidate.
pub fn tables(outcomes: &[Outcome]) -> String {
    let kind_of = |outcome: &Outcome| KINDS.iter().find(|kind| kind.name == outcome.kind);
    let is_plastic = |outcome: &&Outcome| kind_of(outcome).is_some_and(|kind| kind.is_plastic);
    let mut groups: Vec<(String, Vec<&Outcome>)> = vec![
        ("**all**".to_owned(), outcomes.iter().collect()),
        ("**plastic**".to_owned(), outcomes.iter().filter(is_plastic).collect()),
    ];
    groups.extend(
        KINDS
            .iter()
            .map(|kind| (kind.name.to_owned(), outcomes.iter().filter(|outcome| outcome.kind == kind.name).collect())),
    );
    groups.retain(|(_, cars)| !cars.is_empty());
    let mut tables = vec![counts(outcomes, &outcomes.iter().filter(is_plastic).collect::<Vec<_>>())];
    tables.push(recommended(&groups));
    tables.extend(Quantity::ALL.map(|quantity| errors(&groups, &Answer::Recommended, quantity)));
    tables.extend([cover(&groups), factors(&groups[0].1)]);
    tables.extend([errors(&groups, &Answer::CarItself, Quantity::Crush), candidates(outcomes)]);
    tables.join("\n")
}

/// What is recommended, and what should not be.
fn counts(outcomes: &[Outcome], plastic: &[&Outcome]) -> String {
    let damped: Vec<&&Outcome> = plastic.iter().filter(|car| car.is_damped()).collect();
    let not_repeated = damped.iter().filter(|car| !car.repeats_own_test()).count();
    let none = outcomes.iter().filter(|car| car.recommended.is_none()).count();
    let usable: Vec<&Outcome> = outcomes.iter().filter(|car| car.status.as_deref() == Some(USABLE)).collect();
    let off = usable.iter().filter(|car| car.error(Quantity::Crush, LOWER).is_none_or(|e| e.abs() > 0.1)).count();
    let status = outcomes.iter().filter(|car| car.status.is_some()).count();
    format!(
        "| count | cars | of |\n|---|---|---|\n\
         | plastic cars with a damped model | {} | {} |\n\
         | ... that does not repeat its own test | {not_repeated} | {} |\n\
         | cars without a recommendation | {none} | {} |\n\
         | runs that state a status | {status} | {} |\n\
         | ... \"{USABLE}\" for a crush at 40 km/h that is off by more than 10 % | {off} | {} |\n",
        damped.len(),
        plastic.len(),
        plastic.len(),
        outcomes.len(),
        outcomes.len(),
        usable.len(),
    )
}

/// Numbers of a quantity that an answer predicts at a question.
fn scored_cells<'a>(
    cars: &'a [&Outcome],
    who: &'a Answer,
    question: usize,
    quantity: Quantity,
) -> impl Iterator<Item = Scored> + 'a {
    let predictions = cars.iter().filter_map(move |car| car.prediction(who, question));
    predictions.filter_map(move |prediction: Prediction| prediction[quantity as usize])
}

/// Quantiles of sizes, in percent.
fn percent(sizes: impl Iterator<Item = f64>, shares: &[f64]) -> Vec<String> {
    let mut sorted: Vec<f64> = sizes.map(f64::abs).collect();
    sorted.sort_by(f64::total_cmp);
    let at =
        |share: &f64| quantile(&sorted, *share).map_or_else(|| "-".to_owned(), |size| format!("{:.1}", 100.0 * size));
    shares.iter().map(at).collect()
}

/// How many in a hundred intervals hold the truth, and their median width in percent of it.
fn held(scored: impl Iterator<Item = Scored>) -> Option<String> {
    let intervals: Vec<(bool, f64)> = scored.filter_map(|scored| scored.interval).collect();
    let held = intervals.iter().filter(|(held, _)| *held).count();
    let share = 100.0 * held as f64 / intervals.len() as f64;
    let width = percent(intervals.iter().map(|(_, width)| *width), &[0.5]);
    (!intervals.is_empty()).then(|| format!("{share:.0} {}", width[0]))
}

fn recommended(groups: &[(String, Vec<&Outcome>)]) -> String {
    let mut table = String::from(
        "Crush and peak at 40 km/h over those at 56, medians of the cars themselves; what is recommended\n\n\
         | kind | cars | crush | peak | recommended |\n|---|---|---|---|---|\n",
    );
    for (name, cars) in groups {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for car in cars {
            *counts.entry(car.recommended.as_deref().unwrap_or("none")).or_default() += 1;
        }
        let mut counts: Vec<_> = counts.into_iter().collect();
        counts.sort_by_key(|(name, count)| (std::cmp::Reverse(*count), *name));
        let counts: Vec<String> = counts.iter().map(|(name, count)| format!("{name} {count}")).collect();
        let ratio = |which: usize| {
            let mut ratios: Vec<f64> = cars.iter().map(|car| car.lower_ratios[which]).collect();
            ratios.sort_by(f64::total_cmp);
            quantile(&ratios, 0.5).unwrap_or_default()
        };
        let (crush, peak) = (ratio(0), ratio(1));
        let _infallible =
            writeln!(table, "| {name} | {} | {crush:.2} | {peak:.2} | {} |", cars.len(), counts.join(", "));
    }
    table
}

/// Names of the questions as heads of columns.
fn questions() -> String {
    ASKED.iter().fold(String::new(), |mut heads, (speed, factor)| {
        let _infallible =
            if *factor == 1.0 { write!(heads, " {speed} km/h |") } else { write!(heads, " {factor} of the mass |") };
        heads
    })
}

/// Errors of a quantity by question; of what is recommended with the intervals.
fn errors(groups: &[(String, Vec<&Outcome>)], who: &Answer, quantity: Quantity) -> String {
    let of_whom = match who {
        Answer::Recommended => "median (nine in ten, worst); cover and median width of the 90 % intervals",
        _ => "of the car itself, its curves known as far as it was crushed: median (nine in ten, worst)",
    };
    let mut table = format!(
        "Error of {}, %, {of_whom}\n\n| kind |{}\n|---|{}\n",
        quantity.name(),
        questions(),
        "---|".repeat(ASKED.len())
    );
    for (name, cars) in groups {
        let _infallible = write!(table, "| {name} |");
        for question in 0..ASKED.len() {
            let sizes =
                percent(scored_cells(cars, who, question, quantity).map(|scored| scored.error), &[0.5, 0.9, 1.0]);
            let held =
                held(scored_cells(cars, who, question, quantity)).map_or_else(String::new, |held| format!("; {held}"));
            let _infallible = write!(table, " {} ({}, {}){held} |", sizes[0], sizes[1], sizes[2]);
        }
        table.push('\n');
    }
    table
}

/// Cover and median width of every quantity's intervals over all questions beside the own test.
fn cover(groups: &[(String, Vec<&Outcome>)]) -> String {
    let mut table = String::from(
        "Cover and median width of the 90 % intervals, %, at 40, 48 and 64 km/h and both masses; at the own test\n\n\
         | kind | crush | time | peak | delta-v | restitution |\n|---|---|---|---|---|---|\n",
    );
    for (name, cars) in groups {
        let _infallible = write!(table, "| {name} |");
        for quantity in Quantity::ALL {
            let of = |questions: &[usize]| {
                let who = &Answer::Recommended;
                let scored = questions.iter().flat_map(|question| scored_cells(cars, who, *question, quantity));
                held(scored).unwrap_or_else(|| "-".to_owned())
            };
            let _infallible = write!(table, " {}; {} |", of(&COUNTED), of(&[OWN_TEST]));
        }
        table.push('\n');
    }
    table
}

/// By what the half width of an interval has to be multiplied for nine in ten to hold the truth, by question: the 90 %
/// quantile of error over half width. Split conformal prediction (V. Vovk, A. Gammerman & G. Shafer, *Algorithmic
/// Learning in a Random World*, 2005) takes it from cars that nothing else is tested with.
fn factors(outcomes: &[&Outcome]) -> String {
    let mut table = format!(
        "Factor of the half width with which nine in ten intervals hold the truth\n\n| quantity |{}\n|---|{}\n",
        questions(),
        "---|".repeat(ASKED.len())
    );
    // A restitution is a ratio itself, and its interval stays between 0 and 1.
    for quantity in Quantity::ALL.into_iter().filter(|quantity| *quantity != Quantity::Restitution) {
        let _infallible = write!(table, "| {} |", quantity.name());
        for question in 0..ASKED.len() {
            let scored = scored_cells(outcomes, &Answer::Recommended, question, quantity);
            let ratios = scored.filter_map(|scored| Some(2.0 * scored.error.abs() / scored.interval?.1));
            let mut ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
            ratios.sort_by(f64::total_cmp);
            // Of n cars the next one is below the ceil(0.9 (n + 1))-th of them in nine of ten cases.
            let place = (0.9 * (ratios.len() + 1) as f64).ceil() as usize;
            let at = ratios.get(place.saturating_sub(1)).map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.2}"));
            let _infallible = write!(table, " {at} |");
        }
        table.push('\n');
    }
    table
}

/// Every candidate over all cars, at the tested speed and away from it.
fn candidates(outcomes: &[Outcome]) -> String {
    let mut table = String::from(
        "Error of dynamic crush by candidate, %: median (worst)\n\n\
         | candidate | cars | at 56 km/h | at 40 | at 64 | peak at 40 and 64, median |\n|---|---|---|---|---|---|\n",
    );
    let cars: Vec<&Outcome> = outcomes.iter().collect();
    let names: BTreeSet<&Answer> = outcomes.iter().flat_map(|o| o.predictions.iter().map(|(who, _)| who)).collect();
    for who in names {
        let name = match who {
            Answer::Recommended => "**recommended**",
            Answer::CarItself => "the car itself, as far as it was crushed",
            Answer::Candidate(name) => name,
        };
        let count = scored_cells(&cars, who, OWN_TEST, Quantity::Crush).count();
        let _infallible = write!(table, "| {name} | {count} |");
        for question in [OWN_TEST, LOWER, HIGHER] {
            let errors = scored_cells(&cars, who, question, Quantity::Crush).map(|scored| scored.error);
            let sizes = percent(errors, &[0.5, 1.0]);
            let _infallible = write!(table, " {} ({}) |", sizes[0], sizes[1]);
        }
        let peaks = [LOWER, HIGHER].into_iter().flat_map(|question| scored_cells(&cars, who, question, Quantity::Peak));
        let _infallible = writeln!(table, " {} |", percent(peaks.map(|scored| scored.error), &[0.5])[0]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRUTH: Truth =
        Truth { crush_m: 0.5, time_s: 0.06, peak_m_per_s2: 300.0, delta_v_m_per_s: 17.0, restitution: 0.1 };

    #[test]
    fn numbers_of_a_record_stand_beside_the_truth() {
        let record = serde_json::json!({
            "dynamic_crush_m": 0.55, "time_of_dynamic_crush_s": 0.06, "peak_acceleration_m_per_s2": 270.0,
            "coefficient_of_restitution": 0.15,
            "intervals": [
                { "name": "dynamic_crush_m", "low": 0.51, "high": 0.59 },
                { "name": "peak_acceleration_m_per_s2", "low": 200.0, "high": 350.0 },
            ],
        });
        let prediction = scored(&record, &TRUTH);
        let near = |quantity: Quantity, error: f64, interval: Option<(bool, f64)>| {
            let scored = prediction[quantity as usize].expect("predicted");
            assert!((scored.error - error).abs() < 1e-12, "{quantity:?} {scored:?}");
            assert_eq!(scored.interval.map(|(held, _)| held), interval.map(|(held, _)| held), "{quantity:?}");
            let width = |interval: Option<(bool, f64)>| interval.map_or(0.0, |(_, width)| width);
            assert!((width(scored.interval) - width(interval)).abs() < 1e-12, "{quantity:?} {scored:?}");
        };
        near(Quantity::Crush, 0.1, Some((false, 0.16)));
        near(Quantity::Time, 0.0, None);
        near(Quantity::Peak, -0.1, Some((true, 0.5)));
        near(Quantity::Restitution, 0.05, None);
        assert_eq!(prediction[Quantity::DeltaV as usize], None);
    }

    #[test]
    fn a_damped_model_that_stops_elsewhere_or_never_does_not_repeat_its_test() {
        let outcome = |own: Option<Truth>| Outcome {
            kind: "",
            number: 0,
            lower_ratios: [1.0; 2],
            recommended: Some("maxwell/direct-fit".to_owned()),
            status: None,
            predictions: vec![(Answer::Recommended, vec![own.map(|own| scored_truth(&own, &TRUTH))])],
        };
        assert!(outcome(None).is_damped());
        assert!(outcome(Some(Truth { crush_m: 0.517, time_s: 0.058, restitution: 0.19, ..TRUTH })).repeats_own_test());
        for other in [
            Some(Truth { crush_m: 0.518, ..TRUTH }),
            Some(Truth { time_s: 0.064, ..TRUTH }),
            Some(Truth { restitution: 0.21, ..TRUTH }),
            None,
        ] {
            assert!(!outcome(other).repeats_own_test(), "{other:?}");
        }
    }
}
