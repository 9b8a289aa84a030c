//! The stage: models of every method asked for, one after the other, and their comparison.
//! May use the rooms below; the estimators are those of `crumple-sysid`.
//!
//! rooms: methods | records | waves | options

mod methods;
mod options;
mod records;
mod waves;

use std::path::PathBuf;

use crumple_stage::records::TestV1;
use crumple_stage::{Inputs, Loaded, Outcome, Output, Stage};

use crate::stage::methods::discrete::arx;
use crate::stage::methods::discrete::dispatch;
use crate::stage::methods::era;
use crate::stage::methods::exponentials;
use crate::stage::methods::tfest;
use crate::stage::options::flags::Options;
use crate::stage::options::settings::Settings;
use crate::stage::records::results::Results;
use crate::stage::records::selection::Comparison;
use crate::stage::waves::source::Source;
use crate::stage::waves::window::window_start;

/// The stage.
pub struct Identify;

impl Stage for Identify {
    const NAME: &'static str = "identify";
    const BUILD: &'static str = env!("CRUMPLE_BUILD");
    const ABOUT: &'static str =
        "Identifies linear models from a crash pulse: poles, natural frequencies, damping, and the evidence for them";
    type Options = Options;
    type Settings = Settings;
    type Input = Inputs;

    fn resolve(options: Options) -> anyhow::Result<Settings> {
        Ok(Settings::resolve(options)?)
    }

    fn load(paths: &[PathBuf], _: &Settings) -> anyhow::Result<Loaded<Inputs>> {
        crumple_stage::load_artifacts(paths)
    }

    fn run(settings: &Settings, inputs: &Inputs, out: &mut Output) -> anyhow::Result<Outcome> {
        let test = inputs.test()?;
        out.put("/test", &TestV1::from(&test))?;
        let source = Source { settings, test: &test, inputs };
        if let (_, Some(rule)) = window_start(source)? {
            out.notes().info(rule);
        }
        // A method that fails does not take the others with it.
        let mut error = None;
        let mut reason = None;
        let mut done = false;
        let alone = settings.methods.len() == 1;
        let mut results = Results { comparison: Comparison::default(), out };
        for method in &settings.methods {
            let outcome = match method.as_str() {
                "era" | "era-dc" => era::run(method, source, &mut results),
                "tfest" => tfest::run(source, &mut results),
                "arx" if settings.has_arx_structures() => arx::run(source, &mut results),
                "exponentials" => exponentials::run(source, &mut results),
                name => dispatch::run(name, source, &mut results),
            };
            match outcome {
                Ok(Outcome::Done) => done = true,
                Ok(Outcome::NoAcceptableResult(text)) => {
                    reason.get_or_insert(if alone { text } else { format!("{method}: {text}") });
                }
                Err(failed) => {
                    error.get_or_insert(if alone { failed } else { failed.context(format!("method {method}")) });
                }
            }
        }
        let Results { comparison, out } = results;
        comparison.put(out)?;
        match (done, error, reason) {
            (false, Some(error), _) => Err(error),
            (false, None, Some(reason)) => Ok(Outcome::NoAcceptableResult(reason)),
            (_, error, reason) => {
                for text in error.map(|e| format!("{e:#}")).into_iter().chain(reason) {
                    out.notes().warning(text);
                }
                Ok(Outcome::Done)
            }
        }
    }
}
