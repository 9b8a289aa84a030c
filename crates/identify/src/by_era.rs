//! The methods `era` and `era-dc`: records taken for impulse responses.

use crumple_identify::{Era, EraDc, EraDcOptions, EraError, EraOptions, MarkovParameters, Order, Realization, caveats};
use crumple_signal::{Acceleration, Sampled, TestDescription};
use crumple_stage::{Inputs, Outcome, Output, RefuseExt, Refused};

use crate::hankel_settings::HankelSettings;
use crate::options::Settings;
use crate::to_records::{Window, put_model};
use crate::{channel, window};

/// Models of every order asked for.
pub fn run(
    method: &str,
    settings: &Settings,
    test: &TestDescription,
    inputs: &Inputs,
    out: &mut Output,
) -> anyhow::Result<Outcome> {
    let several = settings.hankel.as_ref().map_or(&[][..], |hankel| &hankel.channels);
    let channels: Vec<&str> =
        if several.is_empty() { vec![channel(settings, test)?] } else { several.iter().map(String::as_str).collect() };
    let windows = windows(&channels, settings, inputs)?;
    let cfc = channels.iter().find_map(|channel| test.channel(channel).and_then(|c| c.cfc));
    let orders: Vec<Order> = settings.orders.iter().map(|order| order.0).collect();
    let decomposed = match decompose(method, settings, &windows, &orders) {
        Err(error @ EraError::Silent { .. }) => {
            return Ok(Outcome::NoAcceptableResult(format!("channel {}: {error}", channels.join(", "))));
        }
        result => {
            result.refuse_with_hint("widen the window (--from, --to, --samples), or lower --rows and --columns")?
        }
    };
    let mut written: Vec<usize> = Vec::new();
    let mut first_failure = None;
    for order in orders {
        let model = match realize(&decomposed, order, out) {
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
        let free = settings.hankel.as_ref().is_some_and(|hankel| hankel.free_decay_share.is_some());
        let treated_as = if free { "free-decay" } else { "impulse-response" };
        put_model(&model, &Window { method, channels: &channels, sampled: &windows, treated_as }, &notes, out)?;
        out.notes().extend(notes);
    }
    if let Some(error) = first_failure.filter(|_| written.is_empty()) {
        return Err(error).refuse_with_hint("lower --orders, or widen the window (--from, --to, --samples)");
    }
    Ok(Outcome::Done)
}

/// The window of every channel. Errors: not accelerations, not sampled together.
fn windows(channels: &[&str], settings: &Settings, inputs: &Inputs) -> anyhow::Result<Vec<Sampled>> {
    let mut windows: Vec<Sampled> = Vec::with_capacity(channels.len());
    for channel in channels {
        let record =
            inputs.wave(channel)?.signal::<Acceleration>().refuse_with_hint("name an accelerometer with --channel")?;
        let next = window(&record, settings, inputs)?;
        if let Some(first) = windows.first() {
            let dt = first.dt_s();
            let apart = (next.t0_s() - first.t0_s()).abs() > 1e-6 * dt || (next.dt_s() / dt - 1.0).abs() > 1e-9;
            if apart || next.len() != first.len() {
                return Err(Refused::new(format!(
                    "channels {} and {channel} are not sampled together: {} samples of {dt} s from {} s, and {} of {} s \
                     from {} s",
                    channels[0],
                    first.len(),
                    first.t0_s(),
                    next.len(),
                    next.dt_s(),
                    next.t0_s()
                ))
                .hint("name channels of one time base with --channels, or a window that all have")
                .into());
            }
        }
        windows.push(next);
    }
    Ok(windows)
}

/// What models of all orders follow from.
enum Decomposed<'a> {
    /// One decomposition of the record.
    Whole(Era<'a>),
    /// One of its correlations.
    Correlations(EraDc<'a>),
    /// One for every order, by the size of it.
    Sized(Vec<(Order, Era<'a>)>),
}

impl Decomposed<'_> {
    fn realize(&self, order: Order) -> Result<Realization, EraError> {
        match self {
            Self::Whole(era) => era.realize(order),
            Self::Correlations(era) => era.realize(order),
            Self::Sized(all) => {
                let sized = all.iter().find(|(of, _)| *of == order).or(all.first());
                sized.map_or(Err(EraError::OrderZero), |(_, era)| era.realize(order))
            }
        }
    }
}

fn decompose<'a>(
    method: &str,
    settings: &Settings,
    windows: &'a [Sampled],
    orders: &[Order],
) -> Result<Decomposed<'a>, EraError> {
    let hankel = settings.hankel.as_ref();
    let options = EraOptions {
        max_order: settings.max_order,
        rows: settings.rows,
        columns: settings.columns,
        shift: hankel.map(HankelSettings::form).unwrap_or_default(),
        ..EraOptions::new(windows[0].dt_s())
    };
    let markov = MarkovParameters::new(windows.iter().map(Sampled::samples).collect(), 1)?;
    match hankel {
        Some(hankel) if method == "era-dc" => {
            let options = EraDcOptions { era: options, offset: hankel.offset, lag_blocks: hankel.lag_blocks };
            Ok(Decomposed::Correlations(EraDc::of(markov, options, orders)?))
        }
        Some(hankel) if hankel.twice_the_order => {
            let mut all = Vec::with_capacity(orders.len());
            for &order in orders {
                let options = match order {
                    Order::Given(n) => options.twice_the_order(n),
                    Order::Automatic => options.twice_the_order(settings.max_order),
                };
                all.push((order, Era::of(markov.clone(), options, &[order])?));
            }
            Ok(Decomposed::Sized(all))
        }
        _ => Ok(Decomposed::Whole(Era::of(markov, options, orders)?)),
    }
}

/// The model of one order. Where the record has less in it, the model of the highest order that it has, with a note.
fn realize(era: &Decomposed<'_>, order: Order, out: &mut Output) -> Result<Realization, EraError> {
    match era.realize(order) {
        Err(error @ EraError::OrderAboveRank { rank, .. }) if rank > 0 => {
            out.notes().info(format!("{error}: order {rank} is used, which follows the record to rounding"));
            match era {
                Decomposed::Sized(all) => {
                    let sized = all.iter().find(|(of, _)| *of == order);
                    sized.map_or(Err(error), |(_, era)| era.realize(Order::Given(rank)))
                }
                _ => era.realize(Order::Given(rank)),
            }
        }
        result => result,
    }
}
