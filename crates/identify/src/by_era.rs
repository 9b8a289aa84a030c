//! The method `era`: the record taken for an impulse response.

use crumple_identify::{Era, EraError, EraOptions, Order, Realization, caveats, era_order_scan};
use crumple_signal::{Acceleration, QuantityKind, TestDescription};
use crumple_stage::{Inputs, Outcome, Output, RefuseExt};

use crate::comparison::Comparison;
use crate::input_output::Cut;
use crate::options::Settings;
use crate::to_records::{Pass, put_model};
use crate::{Window, channel, diagram, paper, window};

/// Models of every order asked for, or those of the paper.
pub fn run(
    settings: &Settings,
    test: &TestDescription,
    inputs: &Inputs,
    comparison: &mut Comparison,
    out: &mut Output,
) -> anyhow::Result<Outcome> {
    let channel = channel(settings, test)?;
    let record =
        inputs.wave(channel)?.signal::<Acceleration>().refuse_with_hint("name an accelerometer with --channel")?;
    let Window { used, kept } = window(&record, settings, inputs)?;
    let cfc = test.channel(channel).and_then(|c| c.cfc);
    let cut = Cut { id: channel.to_owned(), quantity: QuantityKind::Acceleration, sampled: used, kept, cfc };
    out.notes().info(format!(
        "era: the record of {channel} is taken for an impulse response; of a crash pulse the strongest poles are often those of its filter and of its shape, not of the car"
    ));
    if settings.paper.is_some() {
        return by_paper(settings, &cut, comparison, out);
    }
    if let Some(wanted) = &settings.stabilisation {
        match era_order_scan(cut.sampled.samples(), settings.max_order, settings.rows, settings.columns) {
            Ok(models) => diagram::put("era", channel, &models, cut.sampled.dt_s(), wanted, out)?,
            Err(error) => out.notes().warning(format!("era: no stabilisation diagram: {error}")),
        }
    }
    let orders: Vec<Order> = settings.orders.iter().map(|order| order.0).collect();
    realize_all(settings, &cut, &orders, &[], comparison, out)
}

/// The realisations of the paper: each order from its own number of samples, as far as the record has them.
fn by_paper(settings: &Settings, cut: &Cut, comparison: &mut Comparison, out: &mut Output) -> anyhow::Result<Outcome> {
    let remarks = paper::remarks("era");
    remarks.iter().for_each(|remark| out.notes().info(*remark));
    let mut outcome = Outcome::Done;
    for (order, samples) in paper::ERA_RUNS {
        let shorter = Cut {
            id: cut.id.clone(),
            quantity: cut.quantity,
            sampled: cut.sampled.slice(0, samples),
            kept: Vec::new(),
            cfc: cut.cfc,
        };
        let found = shorter.sampled.len();
        if found < samples {
            out.notes().info(format!("paper era: the window has {found} samples, not {samples}"));
        }
        match realize_all(settings, &shorter, &[order], remarks, comparison, out)? {
            Outcome::Done => {}
            other => outcome = other,
        }
    }
    Ok(outcome)
}

/// Models of several orders from one decomposition. `remarks`: those of a paper, whose models are named so.
fn realize_all(
    settings: &Settings,
    cut: &Cut,
    orders: &[Order],
    remarks: &[&str],
    comparison: &mut Comparison,
    out: &mut Output,
) -> anyhow::Result<Outcome> {
    let window = &cut.sampled;
    let options = EraOptions {
        max_order: settings.max_order,
        rows: settings.rows,
        columns: settings.columns,
        ..EraOptions::new(window.dt_s())
    };
    let era = match Era::new(window.samples(), options, orders) {
        Err(error @ EraError::Silent { .. }) => {
            return Ok(Outcome::NoAcceptableResult(format!("channel {}: {error}", cut.id)));
        }
        result => {
            result.refuse_with_hint("widen the window (--from, --to, --samples), or lower --rows and --columns")?
        }
    };
    let mut written: Vec<usize> = Vec::new();
    let mut first_failure = None;
    for &order in orders {
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
        let mut notes = caveats(&model, cut.cfc);
        out.notes().extend(notes.clone());
        remarks.iter().for_each(|remark| notes.info(*remark));
        let pass = Pass { cut, options, bootstrap: settings.bootstrap.as_ref(), paper: !remarks.is_empty() };
        put_model(&model, &pass, &notes, comparison, out)?;
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
