//! What a study says: `study.json`, and lines on the terminal.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;

use anyhow::Context;
use crumple_artifact::{OutputKind, write_atomically};
use crumple_stage::say;
use serde::Serialize;

use crate::study::left_out::PredictionError;
use crate::study::regression::{Regression, Regressor, regression};
use crate::study::vehicles::VehicleModel;

/// Fewest vehicles of a class that has a coefficient of its own.
const FEWEST_OF_CLASS: usize = 3;

/// `study.json`.
#[derive(Debug, Serialize)]
pub(crate) struct Study {
    schema: &'static str,
    /// Vehicles with a model.
    vehicles: usize,
    /// By quantity: what explains it, or why nothing does.
    regressions: Vec<NamedRegression>,
    /// Every test predicted from the other tests of its vehicle.
    leave_one_test_out: PredictionError,
}

#[derive(Debug, Serialize)]
struct NamedRegression {
    quantity: &'static str,
    #[serde(flatten)]
    result: Option<Regression>,
    #[serde(skip_serializing_if = "Option::is_none")]
    none_because: Option<&'static str>,
    /// Vehicles left out, since their year or class is not known.
    left_out: usize,
}

impl Study {
    /// The regressions over the vehicles, beside the errors of predictions.
    pub(crate) fn new(models: &[VehicleModel], leave_one_test_out: PredictionError) -> Self {
        let of = |quantity, value: fn(&VehicleModel) -> Option<f64>| named_regression(quantity, models, value);
        Self {
            schema: "crumple.study.v1",
            vehicles: models.iter().filter(|model| model.stiffness_n_per_m.is_some()).count(),
            regressions: vec![
                of("kelvin_stiffness_n_per_m", |model| model.stiffness_n_per_m),
                of("kelvin_damping_n_s_per_m", |model| model.damping_n_s_per_m),
            ],
            leave_one_test_out,
        }
    }

    /// Whether anything was explained.
    pub(crate) fn has_regression(&self) -> bool {
        self.regressions.iter().any(|regression| regression.result.is_some())
    }

    /// Writes `study.json` in one piece.
    pub(crate) fn write(&self, folder: &Path) -> anyhow::Result<()> {
        let path = folder.join("study.json");
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        write_atomically(&path, OutputKind::Summary, |file| file.write_all(text.as_bytes()))
            .with_context(|| format!("cannot write {}", path.display()))
    }

    /// Says it in lines.
    pub(crate) fn tell(&self) {
        for named in &self.regressions {
            let Some(found) = &named.result else {
                say(format_args!("study: {}: {}", named.quantity, named.none_because.unwrap_or_default()));
                continue;
            };
            say(format_args!(
                "study: {} of {} vehicles, R² {:.3}, residuals {:.4}",
                named.quantity, found.cases, found.r_squared, found.residual_standard_deviation
            ));
            for c in &found.coefficients {
                say(format_args!("study:   {:<28} {:>12.4}  95 % from {:.4} to {:.4}", c.name, c.value, c.low, c.high));
            }
        }
        let error = &self.leave_one_test_out;
        if let (Some(median), Some(most), Some(held)) =
            (error.median_percent, error.nine_in_ten_percent, error.held_share)
        {
            say(format_args!(
                "study: crush of a test from the others of its vehicle: median error {median:.1} %, nine in ten within \
                 {most:.1} %, 90 % intervals hold {:.0} % ({} of {} tests predicted)",
                100.0 * held,
                error.predicted,
                error.tests
            ));
        }
    }
}

fn named_regression(
    quantity: &'static str,
    models: &[VehicleModel],
    value: fn(&VehicleModel) -> Option<f64>,
) -> NamedRegression {
    let with_model: Vec<&VehicleModel> =
        models.iter().filter(|model| value(model).is_some() && model.mass_kg.is_some()).collect();
    // What most vehicles lack explains nothing; of what most have, those without it are left out.
    let most_have =
        |has: fn(&VehicleModel) -> bool| 2 * with_model.iter().filter(|m| has(m)).count() > with_model.len();
    let (years, classes) = (most_have(|model| model.year.is_some()), most_have(|model| model.class.is_some()));
    let cases: Vec<&VehicleModel> = with_model
        .iter()
        .copied()
        .filter(|model| (!years || model.year.is_some()) && (!classes || model.class.is_some()))
        .collect();
    let values: Vec<f64> = cases.iter().copied().filter_map(value).collect();
    let mut regressors = vec![Regressor {
        name: "per kg of mass".to_owned(),
        values: cases.iter().filter_map(|model| model.mass_kg).collect(),
    }];
    if years {
        let values = cases.iter().filter_map(|model| model.year).map(|year| year as f64).collect();
        regressors.push(Regressor { name: "per model year".to_owned(), values });
    }
    if classes {
        regressors.extend(class_regressors(&cases));
    }
    let result = regression(&values, &regressors);
    let none_because = result
        .is_none()
        .then_some("too few vehicles, or mass, year and class do not vary on their own: more vehicles are needed");
    NamedRegression { quantity, result, none_because, left_out: with_model.len() - cases.len() }
}

/// One for each class beside the first that is large enough: how far it lies above that one.
fn class_regressors(cases: &[&VehicleModel]) -> Vec<Regressor> {
    let names: BTreeSet<&str> = cases.iter().filter_map(|model| model.class.as_deref()).collect();
    let is_of = |model: &VehicleModel, name: &str| model.class.as_deref() == Some(name);
    let large: Vec<&str> = names
        .into_iter()
        .filter(|name| cases.iter().filter(|model| is_of(model, name)).count() >= FEWEST_OF_CLASS)
        .collect();
    let Some((first, others)) = large.split_first() else { return Vec::new() };
    let regressor = |name: &&str| Regressor {
        name: format!("class {name} above {first}"),
        values: cases.iter().map(|model| f64::from(u8::from(is_of(model, name)))).collect(),
    };
    others.iter().map(regressor).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mass_year_and_class_are_told_apart() {
        let model = |number: i64| {
            let (year, class) = (2000 + (number * 7) % 20, if number % 3 == 0 { "SUV" } else { "SEDAN" });
            let mass_kg = 1200.0 + ((number * 37) % 100) as f64 * 10.0;
            let class_n_per_m = if class == "SUV" { 5e4 } else { 0.0 };
            VehicleModel {
                vehicle: number.to_string(),
                year: Some(year).filter(|_| number > 0),
                class: Some(class.to_owned()),
                mass_kg: Some(mass_kg),
                tests: 1,
                from: String::new(),
                stiffness_n_per_m: Some(400.0 * mass_kg + 2e3 * year as f64 + class_n_per_m),
                damping_n_s_per_m: None,
                recommended: None,
            }
        };
        let models: Vec<VehicleModel> = (0..40).map(model).collect();
        let study = Study::new(&models, PredictionError::default());
        let found = study.regressions[0].result.as_ref().unwrap();
        let values: Vec<f64> = found.coefficients[1..].iter().map(|coefficient| coefficient.value).collect();
        for (value, expected) in values.iter().zip([400.0, 2e3, 5e4]) {
            assert!((value / expected - 1.0).abs() < 1e-9, "{values:?}");
        }
        assert_eq!((found.cases, study.regressions[0].left_out), (39, 1));
        assert!(study.regressions[1].result.is_none());
    }
}
