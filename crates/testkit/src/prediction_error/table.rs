//! The tables of the benchmark, as Markdown.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use crumple_numerics::estimation::statistics::quantile;

use super::kind::KINDS;
use super::score::{ASKED, Answer, COUNTED, LOWER, OWN_TEST, Outcome, Prediction, Quantity, Scored};

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
    tables.extend([cover(&groups), errors(&groups, &Answer::CarItself, Quantity::Crush), candidates(outcomes)]);
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
fn scored<'a>(
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
            let sizes = percent(scored(cars, who, question, quantity).map(|scored| scored.error), &[0.5, 0.9, 1.0]);
            let held = held(scored(cars, who, question, quantity)).map_or_else(String::new, |held| format!("; {held}"));
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
                let scored = questions.iter().flat_map(|question| scored(cars, who, *question, quantity));
                held(scored).unwrap_or_else(|| "-".to_owned())
            };
            let _infallible = write!(table, " {}; {} |", of(&COUNTED), of(&[OWN_TEST]));
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
        let count = scored(&cars, who, OWN_TEST, Quantity::Crush).count();
        let _infallible = write!(table, "| {name} | {count} |");
        for question in [OWN_TEST, LOWER, HIGHER] {
            let errors = scored(&cars, who, question, Quantity::Crush).map(|scored| scored.error);
            let sizes = percent(errors, &[0.5, 1.0]);
            let _infallible = write!(table, " {} ({}) |", sizes[0], sizes[1]);
        }
        let peaks = [LOWER, HIGHER].into_iter().flat_map(|question| scored(&cars, who, question, Quantity::Peak));
        let _infallible = writeln!(table, " {} |", percent(peaks.map(|scored| scored.error), &[0.5])[0]);
    }
    table
}
