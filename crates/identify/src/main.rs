//! `crumple-identify`: linear models from a crash pulse.

mod options;
mod to_records;

use std::path::PathBuf;
use std::process::ExitCode;

use crumple_identify::{Era, EraError, EraOptions, Order, Realization, caveats};
use crumple_signal::{Acceleration, Sampled, TestDescription};
use crumple_stage::records::TestV1;
use crumple_stage::{Inputs, Loaded, Outcome, Output, RefuseExt, Refused, Stage};

use options::{Options, Settings};
use to_records::{Window, put_model};

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
        let channel = channel(settings, &test)?;
        let record =
            inputs.wave(channel)?.signal::<Acceleration>().refuse_with_hint("name an accelerometer with --channel")?;
        let window = window(&record, settings)?;
        let cfc = test.channel(channel).and_then(|c| c.cfc);

        let options = EraOptions {
            max_order: settings.max_order,
            rows: settings.rows,
            columns: settings.columns,
            ..EraOptions::new(window.dt_s())
        };
        let orders: Vec<Order> = settings.orders.iter().map(|order| order.0).collect();
        let era = match Era::new(window.samples(), options, &orders) {
            Err(error @ EraError::Silent { .. }) => {
                return Ok(Outcome::NoAcceptableResult(format!("channel {channel}: {error}")));
            }
            result => {
                result.refuse_with_hint("widen the window (--from, --to, --samples), or lower --rows and --columns")?
            }
        };
        let mut written: Vec<usize> = Vec::new();
        let mut first_failure = None;
        for order in orders {
            let model = match realize(&era, order, out) {
                Ok(model) => model,
                Err(error) => {
                    out.notes().warning(error.to_string());
                    first_failure.get_or_insert(error);
                    continue;
                }
            };
            if written.contains(&model.order()) {
                continue;
            }
            written.push(model.order());
            let notes = caveats(&model, cfc);
            put_model(&model, &Window { channel, sampled: &window }, &notes, out)?;
            out.notes().extend(notes);
        }
        if let Some(error) = first_failure.filter(|_| written.is_empty()) {
            return Err(error).refuse_with_hint("lower --orders, or widen the window (--from, --to, --samples)");
        }
        Ok(Outcome::Done)
    }
}

/// The channel asked for, else the crash pulse.
fn channel<'a>(settings: &'a Settings, test: &'a TestDescription) -> anyhow::Result<&'a str> {
    match &settings.channel {
        Some(id) => Ok(id),
        None => Ok(&test.pulse_channel().refuse_with_hint("name one with --channel")?.id),
    }
}

/// The part of the record that is taken for an impulse response.
fn window(record: &Sampled, settings: &Settings) -> anyhow::Result<Sampled> {
    let first = record.index_at_or_after(settings.from_s);
    // The sample at `to` itself belongs to the window.
    let end = settings.to_s.map_or(record.len(), |to| record.index_at_or_after(to + record.dt_s() / 2.0));
    let end = settings.samples.map_or(end, |count| end.min(first.saturating_add(count)));
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
    Ok(window)
}

/// The model of one order. Where the record has less in it, the model of the highest order that it has, with a note.
fn realize(era: &Era<'_>, order: Order, out: &mut Output) -> Result<Realization, EraError> {
    match era.realize(order) {
        Err(error @ EraError::OrderAboveRank { rank, .. }) if rank > 0 => {
            out.notes().info(format!("{error}: order {rank} is used, which follows the record to rounding"));
            era.realize(Order::Given(rank))
        }
        result => result,
    }
}

fn main() -> ExitCode {
    crumple_stage::main::<Identify>()
}
