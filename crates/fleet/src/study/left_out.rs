//! How far each test is predicted from the other tests of its vehicle.

use serde::{Deserialize, Serialize};

use crumple_artifact::records::PredictionV1;

use crate::tables::table::Kind::{Flag, Number, Text};
use crate::tables::table::{Cell, Table, columns};

/// A test that was left out, as `crumple-together` writes it.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct LeftOut {
    test: String,
    #[serde(default)]
    predictions: Vec<PredictionV1>,
    #[serde(default)]
    no_prediction_because: Option<String>,
}

/// What the fleet says of predictions.
#[derive(Debug, Default, PartialEq, Serialize)]
pub(crate) struct PredictionError {
    /// Tests that were left out.
    pub(crate) tests: usize,
    /// Tests that are predicted.
    pub(crate) predicted: usize,
    /// Median of the size of the error of the dynamic crush, percent.
    pub(crate) median_percent: Option<f64>,
    /// Nine in ten errors are within this, percent.
    pub(crate) nine_in_ten_percent: Option<f64>,
    /// Mean error: what is predicted too much, percent.
    pub(crate) mean_percent: Option<f64>,
    /// Share of the tests whose crush the 90 % interval holds.
    pub(crate) held_share: Option<f64>,
}

impl LeftOut {
    /// The prediction by what is recommended, else by the first candidate that predicts.
    fn prediction(&self) -> Option<&PredictionV1> {
        let compared = || self.predictions.iter().filter(|prediction| prediction.against.is_some());
        compared().find(|prediction| prediction.recommended).or_else(|| compared().next())
    }

    fn crush_error_percent(&self) -> Option<f64> {
        self.prediction()?.against.as_ref()?.dynamic_crush_error_percent
    }

    fn is_held(&self) -> bool {
        let against = self.prediction().and_then(|prediction| prediction.against.as_ref());
        against.is_some_and(|against| against.held.iter().any(|name| name == "dynamic_crush_m"))
    }
}

/// The errors over all vehicles.
pub(crate) fn prediction_error<'a>(left_out: impl Iterator<Item = &'a LeftOut> + Clone) -> PredictionError {
    let errors: Vec<f64> = left_out.clone().filter_map(LeftOut::crush_error_percent).collect();
    let mut sizes: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let quantile = |share: f64| {
        let last = sizes.len().checked_sub(1)?;
        sizes.get((share * last as f64).round() as usize).copied()
    };
    let count = errors.len() as f64;
    let known = !errors.is_empty();
    PredictionError {
        tests: left_out.clone().count(),
        predicted: errors.len(),
        median_percent: quantile(0.5),
        nine_in_ten_percent: quantile(0.9),
        mean_percent: known.then(|| errors.iter().sum::<f64>() / count),
        held_share: known.then(|| left_out.filter(|left| left.is_held()).count() as f64 / count),
    }
}

/// The table `left_out`.
pub(crate) fn left_out_table(all: &[(String, LeftOut)]) -> Table {
    let row = |(vehicle, left): &(String, LeftOut)| {
        let prediction = left.prediction();
        let against = prediction.and_then(|prediction| prediction.against.as_ref());
        let held = against.map(|_| left.is_held());
        vec![
            vehicle.into(),
            (&left.test).into(),
            prediction.map(|prediction| prediction.candidate.as_str()).into(),
            prediction.map_or(Cell::Empty, |prediction| prediction.recommended.into()),
            prediction.map(|prediction| prediction.impact_speed_m_per_s).into(),
            against.and_then(|against| against.dynamic_crush_error_percent).into(),
            against.and_then(|against| against.time_of_dynamic_crush_error_percent).into(),
            against.and_then(|against| against.peak_acceleration_error_percent).into(),
            against.and_then(|against| against.iso18571_score).into(),
            held.map_or(Cell::Empty, Cell::Flag),
            left.no_prediction_because.as_deref().into(),
        ]
    };
    Table {
        name: "left_out",
        columns: columns(&[
            ("vehicle", Text),
            ("test", Text),
            ("candidate", Text),
            ("recommended", Flag),
            ("impact_speed_m_per_s", Number),
            ("dynamic_crush_error_percent", Number),
            ("time_of_dynamic_crush_error_percent", Number),
            ("peak_acceleration_error_percent", Number),
            ("iso18571_score", Number),
            ("interval_holds_crush", Flag),
            ("no_prediction_because", Text),
        ]),
        rows: all.iter().map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_of_what_is_recommended() {
        let text = r#"[
            {"test": "a", "predictions": [
                {"candidate": "x", "recommended": false, "impact_speed_m_per_s": 11.1, "mass_kg": 1500.0,
                 "extrapolates": false, "against": {"test": "a", "dynamic_crush_error_percent": 50.0}},
                {"candidate": "y", "recommended": true, "impact_speed_m_per_s": 11.1, "mass_kg": 1500.0,
                 "extrapolates": false,
                 "against": {"test": "a", "dynamic_crush_error_percent": -2.0, "held": ["dynamic_crush_m"]}}]},
            {"test": "b", "no_prediction_because": "nothing fits"}]"#;
        let left: Vec<LeftOut> = serde_json::from_str(text).unwrap();
        let error = prediction_error(left.iter());
        assert_eq!((error.tests, error.predicted), (2, 1));
        assert_eq!((error.median_percent, error.mean_percent, error.held_share), (Some(2.0), Some(-2.0), Some(1.0)));
    }
}
