//! A study, from the command line to what it says.

use std::collections::BTreeMap;
use std::sync::Mutex;

use anyhow::Context;
use crumple_stage::{ExitStatus, Usage, say};
use rayon::prelude::*;

use crate::fleet::make;
use crate::runs::jobs;
use crate::runs::{Ended, Journal, read_journals};
use crate::study::classes::read_classes;
use crate::study::left_out::{LeftOut, left_out_table, prediction_error};
use crate::study::options::StudyOptions;
use crate::study::report::Study;
use crate::study::together::{JointFits, STUDY, joint_summary};
use crate::study::vehicles::{Vehicle, VehicleModel, vehicle_table, vehicles};
use crate::tables::write::write_tables;

/// Makes the fleet, fits one model to the tests of each vehicle, and writes `study/` in its folder: the tables
/// `vehicles` and `left_out`, and `study.json`.
pub fn study(options: StudyOptions) -> anyhow::Result<ExitStatus> {
    if options.fleet.pipelines().len() > 1 || !options.fleet.sweeps.is_empty() || options.fleet.batch.is_some() {
        let problem = "a study is of one pipeline without --set and --batch";
        return Err(Usage::new(problem).hint("name one pipeline: just study DIR --pipelines default").into());
    }
    let classes = options.classes.as_deref().map(read_classes).transpose()?.unwrap_or_default();
    let fleet = make(&options.fleet)?;
    let vehicles = vehicles(&fleet.rows);
    let known = read_journals(&fleet.folder)?;
    let fits = JointFits::new(&options, &fleet.folder, &known)?;
    let journal = Mutex::new(Journal::open(&fleet.folder, "study")?);
    let fit = |vehicle: &Vehicle<'_>| -> anyhow::Result<Option<Ended>> {
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
    let ended: Vec<Option<Ended>> = threads
        .context("cannot start threads")?
        .install(|| vehicles.par_iter().map(fit).collect::<anyhow::Result<_>>())?;

    let (mut models, mut left_out) = (Vec::new(), Vec::new());
    for (vehicle, ended) in vehicles.iter().zip(&ended) {
        let class = classes.get(&vehicle.name);
        models.push(match ended {
            None => vehicle.model_of_one_test(class),
            Some(ended) if ended.exit_code != 0 => vehicle.model(format!("no joint model: {}", ended.error), class),
            Some(ended) => {
                let joint = joint_summary(&fleet.folder, ended)?;
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
