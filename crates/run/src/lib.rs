//! Runs the stages of a pipeline one after another into one folder: the program behind `just run`.
//!
//! The stages know nothing of each other and this program knows nothing of what they compute. It knows the chain
//! (`pipelines/chain`) and the commands of its stages, and it keeps the promises of a run folder: one run at a time, no
//! results of two records side by side, nothing lost by a run that fails, and a plain word where a program breaks the
//! contract of a stage.
//!
//! `together` fits one model to several tests after their runs; `fleet` runs many records.

mod command;
mod compare;
mod damage {
    //! Speed from damage: stiffness of a front by barrier tests, energy of a profile, speeds of a collision.

    pub mod lines;
    pub mod program;
    pub mod result;
    pub mod stiffness;
    pub mod typed;
}
mod export {
    //! The results of a run for other programs: tables, a file for viewers of recordings, a model as Modelica text.

    pub mod layouts;
    pub mod modelica;
    pub mod program;
    mod us_units;
    pub mod view;
    pub mod view_file;
    pub mod waves;
    pub mod workbook;
}
mod demo;
pub mod fleet;
mod folder {
    //! The run folder: its lock, who holds it, whose files are in it, what an earlier run left behind.

    pub mod content;
    pub mod lock;
}
mod fail_on;
mod messages;
mod names;
mod open_page;
mod passport {
    //! The passport of a run: a Workflow Run RO-Crate with digests of what it was made from and made, and its check.

    pub mod asked;
    pub mod check;
    pub mod contents;
    pub mod crate_files;
    pub mod metadata;
    pub mod program;
    pub mod record;
}
mod program;
mod recipe;
mod run;
mod steps;
mod table;
mod together {
    //! One model for several tests: their runs, the joint stages, every test predicted from the others.

    pub mod joint_run;
    pub mod summary;
}
mod why;
mod words;

use std::ffi::OsString;
use std::path::Path;

use crumple_stage::{Call, ExitStatus, Program, run_tool};

use command::{Options, WithFlagsOfRecord, named, sorted};
use compare::CompareOptions;
use together::joint_run::TogetherOptions;

/// `crumple-run`: one record.
pub const RUN: Program = Program::of_tool::<WithFlagsOfRecord<Options>>("run", |call| {
    let call = sorted::<Options>(call, Some(&(crumple_ingest::PROGRAM.command)()));
    run_tool(&call, |WithFlagsOfRecord(options)| run::run(options))
});
/// `crumple-compare`, which runs records first.
pub const COMPARE: Program = Program::of_tool::<WithFlagsOfRecord<CompareOptions>>("compare", |call| {
    let sorted = sorted::<CompareOptions>(call, Some(&(crumple_ingest::PROGRAM.command)()));
    run_tool(&sorted, |WithFlagsOfRecord(options)| compare::compare(options, call))
});
/// `crumple demo`: a sample record, and its run.
pub const DEMO: Program =
    Program::of_tool::<demo::DemoOptions>("demo", |call| run_tool(call, |options| demo::demo(&options)));
/// `crumple-together`: one model for several tests.
pub const TOGETHER: Program = Program::of_tool::<TogetherOptions>("together", |call| {
    run_tool(&sorted::<TogetherOptions>(call, None), together::joint_run::together)
});
/// `crumple-fleet`: many records.
pub const FLEET: Program = Program::of_tool::<fleet::Options>("fleet", |call| run_tool(call, fleet::fleet));
/// `crumple-study`: what a fleet says of its vehicles.
pub const STUDY: Program = Program::of_tool::<fleet::StudyOptions>("study", |call| run_tool(call, fleet::study));
/// `crumple watch`: a folder that records arrive in.
pub const WATCH: Program = Program::of_tool::<fleet::WatchOptions>("watch", |call| run_tool(call, fleet::watch));
/// `crumple-export`: a run as tables.
pub const EXPORT: Program =
    Program::of_tool::<export::program::ExportOptions>("export", |call| run_tool(call, export::program::export));
/// `crumple-damage`: speed from damage.
pub const DAMAGE: Program = Program::of_tool::<damage::program::DamageOptions>("damage", |call| {
    run_tool(call, |options| damage::program::damage(options, &call.words))
});
/// `crumple-passport`: what a run was made from and what it made, for others to run again.
pub const PASSPORT: Program = Program::of_tool::<passport::program::PassportOptions>("passport", |call| {
    run_tool(call, passport::program::passport)
});
/// `crumple-artifact`, which can run a passport again.
pub const ARTIFACT: Program = Program {
    run: |call| crumple_artifact_cli::artifact(call, Some(passport::check::check)),
    ..crumple_artifact_cli::PROGRAM
};
/// `crumple-diff`, which can run the chain again.
pub const DIFF: Program = Program { run: |call| crumple_report::diff(call, Some(why::why)), ..crumple_report::DIFF };
/// `crumple-view`: a run as a recording for viewers.
pub const VIEW: Program =
    Program::of_tool::<export::view::ViewOptions>("view", |call| run_tool(call, export::view::view));

/// Predicts again in the folder of a run, where a call of `predict` names one: `RUN --speed 40km/h`. `None`: it is one
/// of the stage.
pub fn predict_in_a_run(call: &Call) -> Option<ExitStatus> {
    // A stage is told where to write.
    let is_of_stage = call.has("-o") || call.has("--output");
    let is_meant = |folder: &OsString| {
        let is_flag = folder.as_encoded_bytes().starts_with(b"-");
        Path::new(folder).is_dir() || !(is_flag || is_of_stage || Path::new(folder).exists())
    };
    let folder = named::<Options>(call, None).filter(is_meant)?;
    let Call { words, .. } = sorted::<Options>(call, None);
    let again = ["--again".into(), folder];
    let (own, of_stage) = words.split_at(words.iter().position(|word| word == "--")?);
    let words: Vec<OsString> = [own, &again, &of_stage[..1], &of_stage[2..]].concat();
    Some(run_tool(&Call { words, ..call.clone() }, run::run))
}
