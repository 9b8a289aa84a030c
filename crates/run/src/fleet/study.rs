//! What a fleet says of vehicles: one model for the tests of each, how stiffness and damping depend on mass, year and
//! class, and how far each test is predicted from the others.

use std::collections::{BTreeMap, HashMap};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::Mutex;

use anyhow::Context;
use crumple_artifact::records::PredictionV1;
use crumple_report::model_year;
use crumple_stage::{ExitStatus, Refused, Usage, by_way, say};
use rayon::prelude::*;
use serde::Serialize;

use crate::fleet::command::Options;
use crate::fleet::make::make;
use crate::fleet::regression::Study;
use crate::fleet::runs::{Journal, JournalEntry, digest_of_programs, digest_of_summary, jobs, read_journals};
use crate::fleet::tables::{Row, write_tables};
use crate::program::own_command;
use crate::steps::exit_code_of;
use crate::table::Kind::{Count, Flag, Number, Text};
use crate::table::{Cell, Table, columns};
use crate::together::summary::{JointSummary, LeftOut};

// Classes of vehicles, from a file.

/// The class of each vehicle that the file names.
pub(crate) fn read_classes(path: &Path) -> Result<BTreeMap<String, String>, Refused> {
    let refused = |found: String| {
        Refused::new(format!("{}: {found}", path.display()))
            .expected("a CSV file with the columns vehicle and class")
            .hint("name vehicles as `vehicle` in tests.csv of the fleet does")
    };
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(path).map_err(|error| refused(error.to_string()))?;
    let heads = reader.headers().map_err(|error| refused(error.to_string()))?.clone();
    let column = |name: &str| {
        heads
            .iter()
            .position(|head| head.eq_ignore_ascii_case(name))
            .ok_or_else(|| refused(format!("no column {name}")))
    };
    let (vehicle, class) = (column("vehicle")?, column("class")?);
    let mut classes = BTreeMap::new();
    for row in reader.records() {
        let row = row.map_err(|error| refused(error.to_string()))?;
        if let (Some(vehicle), Some(class)) = (row.get(vehicle), row.get(class)) {
            classes.insert(vehicle.to_owned(), class.to_owned());
        }
    }
    Ok(classes)
}

// How far each test is predicted from the other tests of its vehicle.

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
    let columns = columns(&[
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
    ]);
    Table::new("left_out", columns, all.iter().map(row).collect())
}

// The command line of `crumple-study`.

/// Fits one model to the tests of each vehicle of a fleet: runs the fleet, and regresses the models on mass and year.
///
/// The recipe `study` of the justfile calls it. Tests are of one vehicle where their records name the same one.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-study",
    version,
    after_help = "Exit codes: 0 done, vehicles without a joint model among them; 1 unforeseen failure, 2 usage, \
                  3 no record to be found, 4 too few vehicles for a regression."
)]
pub struct StudyOptions {
    #[command(flatten)]
    pub(crate) fleet: Options,

    /// Classes of vehicles: a CSV file with the columns `vehicle` and `class`.
    #[arg(long, value_name = "FILE")]
    pub(crate) classes: Option<PathBuf>,
}

// One model for the tests of a vehicle, by `crumple-together`.

/// Folder of the joint models in that of the fleet.
pub(crate) const STUDY: &str = "study";

/// Joint fits, those that are up to date left alone.
pub(crate) struct JointFits<'a> {
    options: &'a StudyOptions,
    fleet: &'a Path,
    programs: String,
    known: &'a HashMap<(String, String), JournalEntry>,
}

impl<'a> JointFits<'a> {
    /// Of a fleet with what its journals know.
    pub(crate) fn new(
        options: &'a StudyOptions,
        fleet: &'a Path,
        known: &'a HashMap<(String, String), JournalEntry>,
    ) -> anyhow::Result<Self> {
        let programs = digest_of_programs(&options.fleet.programs.commands()?).context("cannot read the programs")?;
        Ok(Self { options, fleet, programs, known })
    }

    /// Fits one model to the tests of a vehicle, unless that was done with these tests and programs.
    pub(crate) fn fit(&self, vehicle: &Vehicle<'_>) -> anyhow::Result<JournalEntry> {
        let mut hasher = blake3::Hasher::new();
        for row in &vehicle.tests {
            hasher.update(row.ended.summary.as_deref().unwrap_or_default().as_bytes());
        }
        hasher.update(self.programs.as_bytes());
        let folder = format!("{STUDY}/{}", folder_name(&vehicle.name));
        let key = hasher.finalize().to_hex().to_string();
        match self.known.get(&(folder.clone(), key.clone())) {
            Some(ended) if ended.stands(self.fleet) => Ok(ended.clone()),
            _ => self.fit_anew(vehicle, key, folder),
        }
    }

    fn fit_anew(&self, vehicle: &Vehicle<'_>, key: String, folder: String) -> anyhow::Result<JournalEntry> {
        let path = self.fleet.join(&folder);
        let force = if path.exists() { " --force" } else { "" };
        let mut arguments: Vec<OsString> = vec!["--project".into(), self.options.fleet.project.clone().into()];
        arguments.extend(["--pipeline".into(), OsString::from(&self.options.fleet.pipelines()[0])]);
        arguments.extend(["--out".into(), OsString::from(&path)]);
        arguments.extend(self.options.fleet.programs.arguments());
        arguments.extend(["--flags".into(), format!("-q{force}").into(), "--".into()]);
        arguments.extend(vehicle.tests.iter().map(|row| OsString::from(self.fleet.join(&row.run.folder))));
        let mut command = own_command("together");
        let output = command
            .args(arguments)
            .env("RAYON_NUM_THREADS", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .output()
            .with_context(|| format!("cannot start {}", command.get_program().display()))?;
        let exit_code = exit_code_of(output.status);
        let said = String::from_utf8_lossy(&output.stderr);
        let error = if exit_code == 0 { "" } else { said.lines().next().unwrap_or_default() };
        let summary = (exit_code == 0).then(|| digest_of_summary(&path)).flatten();
        Ok(JournalEntry { key, folder, exit_code, error: error.to_owned(), reason: None, summary, seconds: 0.0 })
    }
}

/// A vehicle as the name of a folder: two vehicles never share one.
fn folder_name(vehicle: &str) -> String {
    let plain: String = vehicle
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' })
        .take(60)
        .collect();
    format!("{plain}-{}", &blake3::hash(vehicle.as_bytes()).to_hex()[..8])
}

// A study, from the command line to what it says.

/// Makes the fleet, fits one model to the tests of each vehicle, and writes `study/` in its folder: the tables
/// `vehicles` and `left_out`, and `study.json`.
pub fn study(options: StudyOptions) -> anyhow::Result<ExitStatus> {
    if options.fleet.pipelines().len() > 1 || !options.fleet.sweeps.is_empty() || options.fleet.batch.is_some() {
        let problem = "a study is of one pipeline without --set and --batch";
        return Err(Usage::new(problem)
            .hint(format!("name one pipeline: {} DIR --pipelines default", by_way("just study", "crumple study")))
            .into());
    }
    let classes = options.classes.as_deref().map(read_classes).transpose()?.unwrap_or_default();
    let fleet = make(&options.fleet)?;
    let vehicles = vehicles(&fleet.rows);
    let known = read_journals(&fleet.folder)?;
    let fits = JointFits::new(&options, &fleet.folder, &known)?;
    let journal = Mutex::new(Journal::open(&fleet.folder, "study")?);
    let fit = |vehicle: &Vehicle<'_>| -> anyhow::Result<Option<JournalEntry>> {
        if vehicle.tests.len() < 2 {
            return Ok(None);
        }
        let ended = fits.fit(vehicle)?;
        // A poisoned lock means that another thread panicked while it wrote: the scope ends with that panic.
        let mut journal = journal.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        journal.add(&ended)?;
        Ok(Some(ended))
    };
    let threads = rayon::ThreadPoolBuilder::new().num_threads(jobs(&options.fleet)).build();
    let ended: Vec<Option<JournalEntry>> = threads
        .context("cannot start threads")?
        .install(|| vehicles.par_iter().map(fit).collect::<anyhow::Result<_>>())?;

    let (mut models, mut left_out) = (Vec::new(), Vec::new());
    for (vehicle, ended) in vehicles.iter().zip(&ended) {
        let class = classes.get(&vehicle.name);
        models.push(match ended {
            None => vehicle.model_of_one_test(class),
            Some(ended) if ended.exit_code != 0 => vehicle.model(format!("no joint model: {}", ended.error), class),
            Some(ended) => {
                let joint = JointSummary::read(&fleet.folder.join(&ended.folder))?;
                left_out.extend(joint.leave_one_out.iter().map(|left| (vehicle.name.clone(), left.clone())));
                VehicleModel {
                    stiffness_n_per_m: joint.kelvin("stiffness_n_per_m"),
                    damping_n_s_per_m: joint.kelvin("damping_n_s_per_m"),
                    recommended: joint.recommended,
                    ..vehicle.model("joint fit".to_owned(), class)
                }
            }
        });
    }
    unknown_classes(&classes, &models);
    let study = Study::new(&models, prediction_error(left_out.iter().map(|(_, left): &(String, LeftOut)| left)));
    let folder = fleet.folder.join(STUDY);
    write_tables(&folder, &[vehicle_table(&models), left_out_table(&left_out)])?;
    study.write(&folder)?;
    if !options.fleet.quiet {
        study.tell();
        say(format_args!("study: {}", folder.join("study.json").display()));
    }
    Ok(if study.has_regression() { ExitStatus::Done } else { ExitStatus::NoAcceptableResult })
}

/// Says how many names of the file of classes are no vehicles of the fleet: most likely they are spelt otherwise.
fn unknown_classes(classes: &BTreeMap<String, String>, models: &[VehicleModel]) {
    let is_known = |name: &&String| models.iter().any(|model| model.vehicle == **name);
    let unknown: Vec<&String> = classes.keys().filter(|name| !is_known(name)).collect();
    if let Some(first) = unknown.first() {
        say(format_args!(
            "study: {} names in the file of classes are no vehicles here, for example {first}",
            unknown.len()
        ));
    }
}

// The vehicles of a fleet with their tests.

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
    let columns = columns(&[
        ("vehicle", Text),
        ("model_year", Count),
        ("class", Text),
        ("mass_kg", Number),
        ("tests", Count),
        ("model_from", Text),
        ("kelvin_stiffness_n_per_m", Number),
        ("kelvin_damping_n_s_per_m", Number),
        ("recommended", Text),
    ]);
    Table::new("vehicles", columns, models.iter().map(row).collect())
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn columns_are_found_by_their_names() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("classes.csv");
        std::fs::write(&path, "class, vehicle\nSUV, 2018 A\n").unwrap();
        assert_eq!(read_classes(&path).unwrap()["2018 A"], "SUV");
        std::fs::write(&path, "kind,vehicle\nSUV,2018 A\n").unwrap();
        assert!(read_classes(&path).unwrap_err().to_string().ends_with("no column class"));
    }

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
