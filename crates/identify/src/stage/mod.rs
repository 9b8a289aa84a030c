//! The stage: models of every method asked for, one after the other, and their comparison. The estimators are those of
//! `crumple-sysid`.

mod checks;
mod methods;
mod options;
mod records;
mod waves;

use std::fmt;
use std::path::PathBuf;

use crumple_numerics::estimation::work::determined;
use crumple_signal::{About, Kind, Weight, remarks};
use crumple_stage::{Inputs, LeftOut, Loaded, Outcome, Output, Stage};
use crumple_sysid::CAVEAT_REMARKS;

use crate::stage::methods::discrete::NoModel;
use crate::stage::methods::{arx, discrete, era, exponentials, okid, subspace, tfest};
use crate::stage::options::choices::Method;
use crate::stage::options::flags::Options;
use crate::stage::options::left_out::LEFT_OUT;
use crate::stage::options::paper;
use crate::stage::options::settings::Settings;
use crate::stage::records::results::Results;
use crate::stage::records::{discrete as records_of_discrete, model, realization, responses, results};
use crate::stage::waves::{Source, level_note, window_start};

/// The stage.
pub struct Identify;

impl Stage for Identify {
    const NAME: &'static str = "identify";
    const BUILD: &'static str = env!("CRUMPLE_BUILD");
    const ABOUT: &'static str =
        "Identifies linear models from records: poles, natural frequencies, damping, and the evidence for them";
    const REMARKS: &'static [&'static [&'static Kind]] = &[
        CAVEAT_REMARKS,
        checks::REMARKS,
        waves::REMARKS,
        REMARKS,
        arx::REMARKS,
        discrete::REMARKS,
        era::REMARKS,
        exponentials::REMARKS,
        okid::REMARKS,
        subspace::REMARKS,
        tfest::REMARKS,
        paper::REMARKS,
        records_of_discrete::REMARKS,
        model::REMARKS,
        realization::REMARKS,
        responses::REMARKS,
        results::REMARKS,
    ];
    type Options = Options;
    type Settings = Settings;
    type Input = Inputs;
    const LEFT_OUT: &'static [LeftOut] = LEFT_OUT;

    fn resolve(options: Options) -> anyhow::Result<Settings> {
        Ok(Settings::resolve(options)?)
    }

    fn load(paths: &[PathBuf], _: &Settings) -> anyhow::Result<Loaded<Inputs>> {
        crumple_stage::load_artifacts(paths)
    }

    fn run(settings: &Settings, inputs: &Inputs, out: &mut Output) -> anyhow::Result<Outcome> {
        let test = inputs.test()?;
        out.put("/test", &inputs.test_with_samples(&test))?;
        let (settings, checks) = checks::prepared(Source { settings, test: &test, inputs }, out)?;
        let mut settings = settings;
        let ambient = checks::put_ambient(Source { settings: &settings, test: &test, inputs }, out)?;
        if let Some(ambient) = ambient {
            discrete::take_from_ambient(&mut settings, &ambient, &test, inputs, out);
        }
        let settings = &settings;
        let source = Source { settings, test: &test, inputs };
        if let (_, Some(start)) = window_start(source)? {
            out.notes().push(start);
        }
        if let Some(rate_per_s) = settings.window_per_s {
            out.notes().push(ExponentialWindow { time_constant_s: rate_per_s.recip(), rate_per_s });
        }
        let mut results = Results::new(out);
        let mut failures: Vec<(Method, Failure)> = Vec::new();
        for &method in &settings.methods {
            let outcome = determined(|| match method {
                Method::Era => era::run(source, &mut results),
                Method::Tfest => tfest::run(source, &mut results),
                Method::Arx if settings.has_arx_structures() => arx::run(source, &mut results),
                Method::Exponentials => exponentials::run(source, &mut results),
                _ => discrete::run(method, source, &mut results),
            });
            match outcome.unwrap_or_else(|reason| Ok(Outcome::NoAcceptableResult(reason.to_string()))) {
                Ok(Outcome::Done) => {}
                Ok(Outcome::NoAcceptableResult(reason)) => failures.push((method, Failure::NoResult(reason))),
                Err(error) => failures.push((method, Failure::Refused(error))),
            }
        }
        let order = results.conclude()?;
        checks::finish(source, order, checks, out)?;
        if let Some(note) = level_note(source)? {
            out.notes().push(note);
        }
        if failures.len() == settings.methods.len() {
            return without_a_model(failures);
        }
        // A method that fails does not take the others with it.
        for (method, failure) in failures {
            let method = method.to_string();
            out.notes().push(NoModel { what: method.clone(), method, reason: failure.to_string() });
        }
        Ok(Outcome::Done)
    }
}

/// Why a method gave no model.
enum Failure {
    /// It does not work on these samples or settings.
    Refused(anyhow::Error),
    /// What it found is no acceptable result.
    NoResult(String),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(error) => write!(f, "{error:#}"),
            Self::NoResult(reason) => write!(f, "{reason}"),
        }
    }
}

/// The answer of a run in which every method failed: all of them with their reasons, methods of one reason together.
/// One that does not work on the input refuses it, as it would alone.
fn without_a_model(failures: Vec<(Method, Failure)>) -> anyhow::Result<Outcome> {
    let mut reasons: Vec<(String, Vec<String>)> = Vec::new();
    for (method, failure) in &failures {
        let reason = failure.to_string();
        match reasons.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, methods)) => methods.push(method.to_string()),
            None => reasons.push((reason, vec![method.to_string()])),
        }
    }
    let several = failures.len() > 1;
    let all = reasons.iter().map(|(reason, methods)| match several {
        true => format!("{}: {reason}", methods.join(", ")),
        false => reason.clone(),
    });
    let all = all.collect::<Vec<_>>().join("; ");
    let refused = failures.into_iter().find_map(|(_, failure)| match failure {
        Failure::Refused(error) => Some(error),
        Failure::NoResult(_) => None,
    });
    match refused {
        // One reason is that of the error itself.
        Some(error) if reasons.len() == 1 && several => {
            Err(error.context(format!("methods {}", reasons[0].1.join(", "))))
        }
        Some(error) if several => Err(error.context(format!("no method gave a model: {all}"))),
        Some(error) => Err(error),
        None => Ok(Outcome::NoAcceptableResult(all)),
    }
}

remarks! {
    /// Remarks of the stage itself.
    REMARKS;

    /// The damping that an exponential window added is taken off every pole.
    CR427 ExponentialWindow { time_constant_s: f64, rate_per_s: f64 }
    bears on (About::IdentifiedModels, Weight::None)
    decided "--window-time-constant states the window exp(-t/T) that an analyser multiplied the record with."
    means "Frequencies, damping ratios and their intervals are those without the window. Models and fits are those of \
           the record as it is."
    remedy "nothing; leave --window-time-constant out where the record has no such window"
    says format!(
        "the exponential window of {time_constant_s} s on the record is taken off every pole: {rate_per_s:.4}/s of its \
         decay"
    );
}
