//! `crumple-identify`: linear models from a crash pulse.

mod acceptable;
mod array_records;
mod arx_structure;
mod attempts;
mod automatic_order;
mod beyond_era;
mod by_arx;
mod by_era;
mod by_exponentials;
mod by_markov;
mod by_output_error;
mod by_state_space;
mod by_subspace;
mod by_transfer_function;
mod comparison;
mod diagram;
mod evidence;
mod evidence_options;
mod found;
mod hankel_settings;
mod input_output;
mod judgement;
mod options;
mod order_option;
mod paper;
mod records_together;
mod search_evidence;
mod settings;
mod state_space_records;
mod to_records;
mod window_start;

use std::path::PathBuf;
use std::process::ExitCode;

use crumple_signal::{Sampled, TestDescription};
use crumple_stage::records::{EventsV1, TestV1};
use crumple_stage::{Inputs, Loaded, Outcome, Output, RefuseExt, Refused, Stage};

use comparison::Comparison;
use options::Options;
use settings::Settings;
use window_start::window_start;

struct Identify;

impl Stage for Identify {
    const NAME: &'static str = "identify";
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
        if let (_, Some(rule)) = window_start(settings, inputs)? {
            out.notes().info(rule);
        }
        // A method that fails does not take the others with it.
        let mut error = None;
        let mut reason = None;
        let mut done = false;
        let alone = settings.methods.len() == 1;
        let mut comparison = Comparison::default();
        for method in &settings.methods {
            let outcome = match method.as_str() {
                "era" | "era-dc" => by_era::run(method, settings, &test, inputs, &mut comparison, out),
                "tfest" => by_transfer_function::run(settings, &test, inputs, &mut comparison, out),
                "arx" if settings.has_arx_structures() => by_arx::run(settings, &test, inputs, &mut comparison, out),
                "exponentials" => by_exponentials::run(settings, &test, inputs, &mut comparison, out),
                name => by_state_space::run(name, settings, &test, inputs, &mut comparison, out),
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

/// The channel asked for, else the crash pulse; `hint` tells what to name where there is none.
fn channel<'a>(settings: &'a Settings, test: &'a TestDescription, hint: &str) -> anyhow::Result<&'a str> {
    match &settings.channel {
        Some(id) => Ok(id),
        None => Ok(&test.pulse_channel().refuse_with_hint(hint)?.id),
    }
}

/// The samples of a record that a model is identified from, and those after them that are kept to judge it.
struct Window {
    /// Identified from.
    used: Sampled,
    /// What follows, if samples are kept for validation: no gap between.
    kept: Vec<f64>,
}

/// The part of the record that is used. The window counts from time zero, which the crash events state where they are
/// among the inputs; without them it is the record's own zero.
fn window(record: &Sampled, settings: &Settings, inputs: &Inputs) -> anyhow::Result<Window> {
    let zero_s = inputs.record_if::<EventsV1>("/events")?.map_or(0.0, |events| events.time_zero_s);
    // Half a sample of room for the rounding of times.
    let (from_s, rule) = window_start(settings, inputs)?;
    let room_s = if rule.is_some() { record.dt_s() / 2.0 } else { 0.0 };
    let first = record.index_at_or_after(zero_s + from_s - room_s);
    // The sample at `to` itself belongs to the window.
    let end = settings.to_s.map_or(record.len(), |to| record.index_at_or_after(zero_s + to + record.dt_s() / 2.0));
    let used = settings.validate_from_s.map_or(end, |from| end.min(record.index_at_or_after(zero_s + from)));
    let kept = record.slice(used.max(first), end).samples().to_vec();
    let end = settings.samples.map_or(used, |count| used.min(first.saturating_add(count)));
    let window = record.slice(first, end);
    if window.is_empty() {
        return Err(Refused::new(format!(
            "the window from {} s holds no sample: the record runs from {} s to {} s",
            settings.from_s,
            record.t0_s(),
            record.end_s()
        ))
        .hint("set --from and --to to times inside the record")
        .into());
    }
    if settings.validate_from_s.is_some() && (kept.is_empty() || end < used) {
        return Err(Refused::new("no sample is left for the validation, or --samples ends before it begins")
            .hint("set --validate-from to a time inside the window, without --samples")
            .into());
    }
    let kept = if settings.validate_from_s.is_some() { kept } else { Vec::new() };
    Ok(Window { used: window, kept })
}

fn main() -> ExitCode {
    crumple_stage::main::<Identify>()
}
