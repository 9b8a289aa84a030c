//! How stiffness and damping of the vehicles of a fleet depend on mass, year and class.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;

use anyhow::Context;
use crumple_artifact::{OutputKind, write_atomically};
use crumple_report::words::Rounding;
use crumple_stage::say;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::fleet::study::{PredictionError, VehicleModel};

// Linear regression with exact intervals.

/// Share of cases that an interval holds.
const LEVEL: f64 = 0.95;

/// A column that the others explain but for this share of it says nothing of its own.
const LEAST_OWN_SHARE: f64 = 1e-10;

/// A quantity that may explain another.
#[derive(Debug, Clone)]
pub(crate) struct Regressor {
    /// What its coefficient is called, e.g. `per kg of mass`.
    pub(crate) name: String,
    /// Its value for each case.
    pub(crate) values: Vec<f64>,
}

/// A fitted coefficient.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Coefficient {
    /// What it multiplies.
    pub(crate) name: String,
    /// Estimate.
    pub(crate) value: f64,
    /// Standard deviation of the estimate.
    pub(crate) standard_deviation: f64,
    /// Lower end of the 95 % interval.
    pub(crate) low: f64,
    /// Upper end.
    pub(crate) high: f64,
}

/// A regression.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Regression {
    /// The intercept, which is the value at the means of all regressors, then a coefficient for each.
    pub(crate) coefficients: Vec<Coefficient>,
    /// Cases.
    pub(crate) cases: usize,
    /// Cases less coefficients.
    pub(crate) degrees_of_freedom: usize,
    /// Standard deviation of the residuals.
    pub(crate) residual_standard_deviation: f64,
    /// Share of the variance that is explained.
    pub(crate) r_squared: f64,
}

/// Least squares of `values` over the regressors, each less its mean. Intervals are those of independent normal
/// residuals of one variance: the estimate and Student's quantile times its standard deviation. `None`: no degree of
/// freedom is left, or a regressor is a combination of the others.
pub(crate) fn regression(values: &[f64], regressors: &[Regressor]) -> Option<Regression> {
    let (cases, count) = (values.len(), regressors.len() + 1);
    let degrees_of_freedom = cases.checked_sub(count).filter(|degrees| *degrees > 0)?;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let centred: Vec<Vec<f64>> = regressors
        .iter()
        .map(|regressor| {
            let mean = mean(&regressor.values);
            regressor.values.iter().map(|value| value - mean).collect()
        })
        .collect();
    // Columns of length 1: the conditioning is that of the regressors, not of their units.
    let lengths: Vec<f64> = centred.iter().map(|column| column.iter().map(|x| x * x).sum::<f64>().sqrt()).collect();
    if lengths.iter().any(|length| *length <= 0.0) {
        return None;
    }
    let scaled = DMatrix::from_fn(cases, regressors.len(), |row, column| centred[column][row] / lengths[column]);
    let inverse = match regressors.is_empty() {
        true => DMatrix::zeros(0, 0),
        false => (scaled.transpose() * &scaled).cholesky()?.inverse(),
    };
    if (0..regressors.len()).any(|column| 1.0 / inverse[(column, column)] < LEAST_OWN_SHARE) {
        return None;
    }
    let level = mean(values);
    let about_mean = DVector::from_iterator(cases, values.iter().map(|value| value - level));
    let slopes = &inverse * (scaled.transpose() * &about_mean);
    let residuals = &about_mean - &scaled * &slopes;
    let variance = residuals.norm_squared() / degrees_of_freedom as f64;
    let student = StudentsT::new(0.0, 1.0, degrees_of_freedom as f64).ok()?.inverse_cdf(0.5 + 0.5 * LEVEL);
    let coefficient = |name: &str, value: f64, standard_deviation: f64| Coefficient {
        name: name.to_owned(),
        value,
        standard_deviation,
        low: value - student * standard_deviation,
        high: value + student * standard_deviation,
    };
    let mut coefficients = vec![coefficient("at the means", level, (variance / cases as f64).sqrt())];
    coefficients.extend(regressors.iter().enumerate().map(|(number, regressor)| {
        let deviation = (variance * inverse[(number, number)]).sqrt() / lengths[number];
        coefficient(&regressor.name, slopes[number] / lengths[number], deviation)
    }));
    let total = about_mean.norm_squared();
    let r_squared = if total > 0.0 { 1.0 - residuals.norm_squared() / total } else { 0.0 };
    Some(Regression {
        coefficients,
        cases,
        degrees_of_freedom,
        residual_standard_deviation: variance.sqrt(),
        r_squared,
    })
}

// What a study says: `study.json`, and lines on the terminal.

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
                let rounding = Rounding::of_interval(c.low, c.high).unwrap_or(Rounding::WITHOUT_INTERVAL);
                let [value, low, high] = [c.value, c.low, c.high].map(|number| rounding.show(number));
                say(format_args!("study:   {:<28} {value:>12}  95 % from {low} to {high}", c.name));
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

    fn regressor(name: &str, values: &[f64]) -> Regressor {
        Regressor { name: name.to_owned(), values: values.to_vec() }
    }

    /// Norris of the NIST Statistical Reference Datasets, certified to 15 digits.
    #[test]
    fn norris_of_nist_comes_out() {
        let data = [
            (0.1, 0.2),
            (338.8, 337.4),
            (118.1, 118.2),
            (888.0, 884.6),
            (9.2, 10.1),
            (228.1, 226.5),
            (668.5, 666.3),
            (998.5, 996.3),
            (449.1, 448.6),
            (778.9, 777.0),
            (559.2, 558.2),
            (0.3, 0.4),
            (0.1, 0.6),
            (778.1, 775.5),
            (668.8, 666.9),
            (339.3, 338.0),
            (448.9, 447.5),
            (10.8, 11.6),
            (557.7, 556.0),
            (228.3, 228.1),
            (998.0, 995.8),
            (888.8, 887.6),
            (119.6, 120.2),
            (0.3, 0.3),
            (0.6, 0.3),
            (557.6, 556.8),
            (339.3, 339.1),
            (888.0, 887.2),
            (998.5, 999.0),
            (778.9, 779.0),
            (10.2, 11.1),
            (117.6, 118.3),
            (228.9, 229.2),
            (668.4, 669.1),
            (449.2, 448.9),
            (0.2, 0.5),
        ];
        let y: Vec<f64> = data.iter().map(|(y, _)| *y).collect();
        let x: Vec<f64> = data.iter().map(|(_, x)| *x).collect();
        let found = regression(&y, &[regressor("x", &x)]).unwrap();
        let slope = &found.coefficients[1];
        // The certified values to the digits that sums of 36 terms of size 1e3 leave.
        assert!((slope.value - 1.002_116_818_020_45).abs() < 1e-12, "{}", slope.value);
        assert!((slope.standard_deviation - 0.429_796_848_199_937e-3).abs() < 1e-14, "{}", slope.standard_deviation);
        assert!((found.residual_standard_deviation - 0.884_796_396_144_373).abs() < 1e-11);
        assert!((found.r_squared - 0.999_993_745_883_712).abs() < 1e-13);
        // Student's quantile of 34 degrees of freedom, from printed tables: 2.0322.
        assert!(((slope.high - slope.value) / slope.standard_deviation - 2.032_245).abs() < 1e-5);
    }

    #[test]
    fn what_cannot_be_told_apart_has_no_answer() {
        let x = [1.0, 2.0, 3.0, 5.0];
        let twice = x.map(|x| 2.0 * x + 1.0);
        let y = [1.0, 2.0, 2.5, 7.0];
        assert!(regression(&y, &[regressor("x", &x), regressor("2x", &twice)]).is_none());
        assert!(regression(&y, &[regressor("1", &[1.0; 4])]).is_none());
        assert!(regression(&y[..2], &[regressor("x", &x[..2])]).is_none());
    }

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
