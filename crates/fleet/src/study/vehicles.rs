//! The vehicles of a fleet with their tests.

use std::collections::BTreeMap;

use crumple_report::model_year;

use crate::tables::rows::Row;
use crate::tables::table::Kind::{Count, Number, Text};
use crate::tables::table::{Cell, Table, columns};

/// A vehicle.
#[derive(Debug)]
pub(crate) struct Vehicle<'a> {
    /// As its records name it; a record without a name is a vehicle of its own, named after the record.
    pub(crate) name: String,
    /// Its tests, in the order of the tables.
    pub(crate) tests: Vec<&'a Row>,
}

/// One model of a vehicle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct VehicleModel {
    /// The vehicle.
    pub(crate) vehicle: String,
    /// Model year.
    pub(crate) year: Option<i64>,
    /// Class, where one is stated.
    pub(crate) class: Option<String>,
    /// Mean of the test masses.
    pub(crate) mass_kg: Option<f64>,
    /// Number of tests.
    pub(crate) tests: usize,
    /// `joint fit`, `one test`, or why there is no model.
    pub(crate) from: String,
    /// Stiffness of the Kelvin model.
    pub(crate) stiffness_n_per_m: Option<f64>,
    /// Its damping.
    pub(crate) damping_n_s_per_m: Option<f64>,
    /// Candidate that is recommended for predictions.
    pub(crate) recommended: Option<String>,
}

/// The vehicles of the runs that are done, by name.
pub(crate) fn vehicles(rows: &[Row]) -> Vec<Vehicle<'_>> {
    let mut vehicles: BTreeMap<String, Vec<&Row>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.ended.exit_code == 0) {
        let Some(summary) = &row.summary else { continue };
        let named = summary.test.vehicle.as_deref().map(str::trim).filter(|name| !name.is_empty());
        vehicles.entry(named.unwrap_or(&row.run.record.identity).to_owned()).or_default().push(row);
    }
    vehicles.into_iter().map(|(name, tests)| Vehicle { name, tests }).collect()
}

impl Vehicle<'_> {
    /// Its model without stiffness and damping.
    pub(crate) fn model(&self, from: String, class: Option<&String>) -> VehicleModel {
        let masses: Vec<f64> = self.tests.iter().filter_map(|row| row.summary.as_ref()?.test.mass_kg).collect();
        VehicleModel {
            vehicle: self.name.clone(),
            year: model_year(&self.name),
            class: class.cloned(),
            mass_kg: (!masses.is_empty()).then(|| masses.iter().sum::<f64>() / masses.len() as f64),
            tests: self.tests.len(),
            from,
            stiffness_n_per_m: None,
            damping_n_s_per_m: None,
            recommended: None,
        }
    }

    /// What its only test says.
    pub(crate) fn model_of_one_test(&self, class: Option<&String>) -> VehicleModel {
        let summary = self.tests.first().and_then(|row| row.summary.as_ref());
        VehicleModel {
            stiffness_n_per_m: summary.and_then(|summary| summary.parameter("kelvin", "stiffness_n_per_m")),
            damping_n_s_per_m: summary.and_then(|summary| summary.parameter("kelvin", "damping_n_s_per_m")),
            recommended: summary.and_then(|summary| summary.recommended.clone()),
            ..self.model("one test".to_owned(), class)
        }
    }
}

/// The table `vehicles`.
pub(crate) fn vehicle_table(models: &[VehicleModel]) -> Table {
    let row = |model: &VehicleModel| {
        vec![
            (&model.vehicle).into(),
            model.year.map_or(Cell::Empty, Cell::Count),
            model.class.as_deref().into(),
            model.mass_kg.into(),
            i64::try_from(model.tests).map_or(Cell::Empty, Cell::Count),
            (&model.from).into(),
            model.stiffness_n_per_m.into(),
            model.damping_n_s_per_m.into(),
            model.recommended.as_deref().into(),
        ]
    };
    Table {
        name: "vehicles",
        columns: columns(&[
            ("vehicle", Text),
            ("model_year", Count),
            ("class", Text),
            ("mass_kg", Number),
            ("tests", Count),
            ("model_from", Text),
            ("kelvin_stiffness_n_per_m", Number),
            ("kelvin_damping_n_s_per_m", Number),
            ("recommended", Text),
        ]),
        rows: models.iter().map(row).collect(),
    }
}
