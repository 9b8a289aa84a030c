//! The tables of the benchmark, as Markdown.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use crumple_estimation::statistics::quantile;

use super::kind::KINDS;
use super::score::{ASKED, Answer, Outcome, Prediction};

/// All tables: what is recommended by kind, its errors and those of the car itself by kind and question, its intervals,
/// and every candidate.
pub fn tables(outcomes: &[Outcome]) -> String {
    let mut groups: Vec<(String, Vec<&Outcome>)> = KINDS
        .iter()
        .map(|kind| (kind.name.to_owned(), outcomes.iter().filter(|o| o.kind == kind.name).collect()))
        .collect();
    let told = |outcome: &&Outcome| KINDS.iter().any(|kind| kind.name == outcome.kind && kind.told_by_one_test);
    groups.push(("**all that one test can tell**".to_owned(), outcomes.iter().filter(told).collect()));
    groups.push(("**all**".to_owned(), outcomes.iter().collect()));
    groups.retain(|(_, cars)| !cars.is_empty());
    let of_recommended = crush(&groups, &Answer::Recommended, "of what is recommended");
    let of_the_car = crush(&groups, &Answer::CarItself, "of the car itself, its curves known as far as it was crushed");
    [recommended(&groups), of_recommended, of_the_car, other(&groups), intervals(&groups), by_candidate(outcomes)]
        .join("\n")
}

/// The predictions of an answer at the question of this number.
fn of(cars: &[&Outcome], who: &Answer, question: usize) -> Vec<Prediction> {
    let answers = cars.iter().flat_map(|car| car.predictions.iter().filter(|(answer, _)| answer == who));
    answers.filter_map(|(_, predictions)| predictions[question]).collect()
}

/// Quantile of sizes, in percent.
fn percent(sizes: impl Iterator<Item = f64>, share: f64) -> String {
    let mut sorted: Vec<f64> = sizes.map(f64::abs).collect();
    sorted.sort_by(f64::total_cmp);
    quantile(&sorted, share).map_or_else(|| "-".to_owned(), |size| format!("{:.1}", 100.0 * size))
}

fn recommended(groups: &[(String, Vec<&Outcome>)]) -> String {
    let mut table = String::from("| kind | cars | recommended |\n|---|---|---|\n");
    for (name, cars) in groups {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for car in cars {
            *counts.entry(car.recommended.as_deref().unwrap_or("none")).or_default() += 1;
        }
        let mut counts: Vec<_> = counts.into_iter().collect();
        counts.sort_by_key(|(name, count)| (std::cmp::Reverse(*count), *name));
        let counts: Vec<String> = counts.iter().map(|(name, count)| format!("{name} {count}")).collect();
        let _infallible = writeln!(table, "| {name} | {} | {} |", cars.len(), counts.join(", "));
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

fn crush(groups: &[(String, Vec<&Outcome>)], who: &Answer, of_whom: &str) -> String {
    let mut table = format!(
        "Error of dynamic crush {of_whom}, %: median, nine in ten within\n\n| kind |{}\n|---|{}\n",
        questions(),
        "---|".repeat(ASKED.len())
    );
    for (name, cars) in groups {
        let _infallible = write!(table, "| {name} |");
        for question in 0..ASKED.len() {
            let answers = of(cars, who, question);
            let at = |share| percent(answers.iter().map(|p| p.crush), share);
            let _infallible = write!(table, " {}, {} |", at(0.5), at(0.9));
        }
        table.push('\n');
    }
    table
}

fn other(groups: &[(String, Vec<&Outcome>)]) -> String {
    let mut table = String::from(
        "Median errors of what is recommended at 40 and 64 km/h: time of crush and peak behind CFC 60 in %, \
         coefficient of restitution\n\n| kind | time | peak | restitution |\n|---|---|---|---|\n",
    );
    for (name, cars) in groups {
        let answers: Vec<Prediction> =
            [2, 4].iter().flat_map(|question| of(cars, &Answer::Recommended, *question)).collect();
        let mut restitution: Vec<f64> = answers.iter().filter_map(|p| p.restitution).map(f64::abs).collect();
        restitution.sort_by(f64::total_cmp);
        let restitution = quantile(&restitution, 0.5).map_or_else(|| "-".to_owned(), |e| format!("{e:.3}"));
        let _infallible = writeln!(
            table,
            "| {name} | {} | {} | {restitution} |",
            percent(answers.iter().map(|p| p.time), 0.5),
            percent(answers.iter().filter_map(|p| p.peak), 0.5)
        );
    }
    table
}

fn intervals(groups: &[(String, Vec<&Outcome>)]) -> String {
    let mut table = format!(
        "90 % intervals of dynamic crush: held in %, median width in % of the crush\n\n| kind |{} all |\n|---|{}---|\n",
        questions(),
        "---|".repeat(ASKED.len())
    );
    for (name, cars) in groups {
        let _infallible = write!(table, "| {name} |");
        let each = (0..ASKED.len()).map(|question| of(cars, &Answer::Recommended, question));
        let all = (0..ASKED.len()).flat_map(|question| of(cars, &Answer::Recommended, question)).collect();
        for answers in each.chain([all]) {
            let held: Vec<bool> = answers.iter().filter_map(|p| p.interval).map(|(held, _)| held).collect();
            let share = 100.0 * held.iter().filter(|held| **held).count() as f64 / held.len() as f64;
            let width = percent(answers.iter().filter_map(|p| p.interval).map(|(_, width)| width), 0.5);
            let _infallible =
                if held.is_empty() { write!(table, " - |") } else { write!(table, " {share:.0}, {width} |") };
        }
        table.push('\n');
    }
    table
}

/// Every candidate over all cars, at the tested speed and away from it.
fn by_candidate(outcomes: &[Outcome]) -> String {
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
        let _infallible = write!(table, "| {name} | {} |", of(&cars, who, 0).len());
        for question in [0, 2, 4] {
            let answers = of(&cars, who, question);
            let at = |share| percent(answers.iter().map(|p| p.crush), share);
            let _infallible = write!(table, " {} ({}) |", at(0.5), at(1.0));
        }
        let peaks = [2, 4].iter().flat_map(|question| of(&cars, who, *question)).filter_map(|p| p.peak);
        let _infallible = writeln!(table, " {} |", percent(peaks, 0.5));
    }
    table
}
