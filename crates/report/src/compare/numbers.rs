//! The rows of a comparison of runs: key numbers, recommended models, predictions.

use std::collections::BTreeSet;

use crumple_diff::CompareSettings;

use crate::drawing::numbers::ABSENT;
use crate::findings::{CandidateResult, Summary, capitalised};
use crate::page::key_numbers::title;
use crate::words;

use super::compared_run::ComparedRun;
use super::quantities::{Group, Quantity, quantities};
use super::table::{Cell, Row};

/// The rows of the key numbers, of the recommended models and of the predictions: every number that a run has.
/// What differs is beyond these limits. There are no rows of models where no run recommends one.
pub fn number_rows(runs: &[ComparedRun], settings: &CompareSettings) -> [Vec<Row>; 3] {
    let summaries: Vec<&Summary> = runs.iter().map(|run| &run.summary).collect();
    let all = quantities(&summaries, settings);
    let of = |group: Group| all.iter().filter(move |quantity| quantity.group == group);
    let key_numbers = of(Group::KeyNumber).map(|quantity| Row { name: titles(runs, quantity), ..row(quantity) });
    let mut models = about_models(runs);
    models.extend(of(Group::Parameter).map(row));
    [key_numbers.collect(), models, of(Group::Prediction).map(row).collect()]
}

/// What every run says of a quantity.
pub fn row(quantity: &Quantity) -> Row {
    let cell = |k| Cell { text: quantity.shown(k), beside: quantity.beside(k), differs: quantity.differs(k) };
    Row { name: quantity.name.clone(), cells: (0..quantity.values.len()).map(cell).collect() }
}

/// What the runs call a key number. A peak of runs that were filtered differently is a peak.
fn titles(runs: &[ComparedRun], quantity: &Quantity) -> String {
    let has = |k: &usize| runs[*k].summary.key_numbers.iter().any(|number| number.name == quantity.key);
    let titles: BTreeSet<String> = (0..runs.len()).filter(has).map(|k| title(&runs[k].run, &quantity.key)).collect();
    let names: BTreeSet<&str> = titles.iter().filter_map(|title| title.split(", ").next()).collect();
    if titles.len() == 1 { titles.into_iter().collect() } else { names.into_iter().collect() }
}

/// Which models are recommended, how sure, how well they follow.
fn about_models(runs: &[ComparedRun]) -> Vec<Row> {
    let models: Vec<Option<&CandidateResult>> = runs.iter().map(ComparedRun::recommended).collect();
    if models.iter().all(Option::is_none) {
        return Vec::new();
    }
    let texts = |text: &dyn Fn(&CandidateResult) -> Option<String>| -> Vec<String> {
        models.iter().map(|model| model.and_then(text).unwrap_or_else(|| ABSENT.to_owned())).collect()
    };
    let names: Vec<String> = runs
        .iter()
        .zip(&models)
        .map(|(run, model)| model.map_or_else(|| ABSENT.to_owned(), |model| capitalised(&run.run.name_of(&model.id))))
        .collect();
    let determined = |model: &CandidateResult| model.certainties().words();
    vec![Row::of_texts("Recommended", &names), Row::of_texts("Certainty", &texts(&determined)), fit_row(&models)]
}

/// Displacement fits that differ by less, percentage points, are equal: at 10 m/s and half a metre of crush that is
/// about 0.1 mm.
const EQUAL_FIT_POINTS: f64 = 0.1;

/// How closely the model follows the displacement; apart where two fits are not called equally good.
fn fit_row(models: &[Option<&CandidateResult>]) -> Row {
    let fits: Vec<Option<f64>> = models.iter().map(|model| model.and_then(CandidateResult::fit_percent)).collect();
    let apart = |fit: Option<f64>| fit.zip(fits[0]).is_some_and(|(fit, first)| (fit - first).abs() > EQUAL_FIT_POINTS);
    let cell = |fit: &Option<f64>| Cell {
        text: fit.map_or_else(|| ABSENT.to_owned(), |fit| words::quantity(fit, 2, "%")),
        differs: apart(*fit),
        ..Cell::default()
    };
    Row { name: "Displacement fit".to_owned(), cells: fits.iter().map(cell).collect() }
}
