//! The method `era`: the record taken for an impulse response.

use crumple_identify::{Era, EraError, EraOptions, Order, Realization, caveats};
use crumple_signal::{Acceleration, TestDescription};
use crumple_stage::{Inputs, Outcome, Output, RefuseExt};

use crate::options::Settings;
use crate::to_records::{Window, put_model};
use crate::{channel, window};

/// Models of every order asked for.
pub fn run(settings: &Settings, test: &TestDescription, inputs: &Inputs, out: &mut Output) -> anyhow::Result<Outcome> {
    let channel = channel(settings, test)?;
    let record =
        inputs.wave(channel)?.signal::<Acceleration>().refuse_with_hint("name an accelerometer with --channel")?;
    let window = window(&record, settings, inputs)?;
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
