//! The subspace methods: an order, the order that the record asks for, and the stabilisation diagram.

use crumple_signal::Notes;
use crumple_stage::Output;
use crumple_sysid::{
    Contender, Horizons, IdentifyError, IoData, Subspace, SubspaceModel, SubspaceOptions, Weighting,
    automatic_thinning, autoregressive_effective_samples, best_of_many, horizons, left_by_unseen, select,
    simulate_fitted, subspace_order_scan, thinned, unseen_squares,
};
use rayon::prelude::*;

use crate::stage::options::settings::{InputOutputSettings, Stabilisation};
use crate::stage::records::discrete::{DiscreteModel, RecordChoices};
use crate::stage::records::realization;
use crate::stage::waves::Record;

/// Block rows of past and future, at least.
const SHORTEST_HORIZON: usize = 10;

/// Samples that a thinned record keeps at least, in units of what its factorisation needs.
const KEPT: usize = 2;

/// How a record is factorised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Horizon {
    /// The poles are found from every so many samples.
    every: usize,
    /// Block rows of past and of future.
    block_rows: usize,
}

/// The subspace methods find poles from every so many samples.
fn thinning(input_output: &InputOutputSettings, block_rows: usize, data: &IoData) -> usize {
    match (input_output.thin, input_output.block_rows) {
        (Some(every), _) => every,
        (None, Some(_)) => 1,
        (None, None) => {
            automatic_thinning(data, KEPT * Subspace::needed(block_rows, data.inputs().len(), data.outputs().len()))
        }
    }
}

/// Factorises the record, thinned as for its models, with a horizon for all orders up to `max_order`; `work` takes the
/// factorisation, what was factorised, and the horizon.
fn with_all_orders<T>(
    weighting: Weighting,
    max_order: usize,
    data: &IoData,
    input_output: &InputOutputSettings,
    work: impl FnOnce(&Subspace<'_>, &IoData, Horizon) -> T,
) -> Result<T, IdentifyError> {
    let shortest = max_order + 2;
    let every = thinning(input_output, input_output.block_rows.unwrap_or(shortest), data);
    let thin = if every > 1 { thinned(data, every)? } else { data.clone() };
    let block_rows =
        input_output.block_rows.or_else(|| horizons(&thin, shortest).block_rows.last().copied()).unwrap_or(shortest);
    let subspace = Subspace::new(&thin, SubspaceOptions { weighting, block_rows, direct: true })?;
    Ok(work(&subspace, &thin, Horizon { every, block_rows }))
}

/// The number of states that the record asks for, and why in words.
///
/// The models compared come from one factorisation with a horizon for the highest order, which is returned too: the
/// model that is written may choose it for its own, so it simulates no worse than the one that was compared.
pub fn chosen_order(
    weighting: Weighting,
    max_order: usize,
    (data, whole): (&IoData, &IoData),
    input_output: &InputOutputSettings,
) -> Result<(usize, Horizon, String), String> {
    let (m, q) = (data.inputs().len(), data.outputs().len());
    // What is thinned by itself keeps enough samples.
    let kept = match input_output.thin {
        Some(every) => thinned(data, every).map_err(|error| error.to_string())?.samples(),
        None => data.samples(),
    };
    // A short record has no room for the horizon of high orders.
    let room = |n: &usize| Subspace::needed(n + 2, m, q) <= kept;
    let highest = match input_output.block_rows {
        Some(given) => max_order.min((given.saturating_sub(1) * q).max(1)),
        None => (1..=max_order).rev().find(room).unwrap_or(1),
    };
    let (order, horizon) = with_all_orders(weighting, highest, data, input_output, |subspace, thin, horizon| {
        (automatic_order(subspace, thin.samples() < data.samples(), (data, whole), highest), horizon)
    })
    .map_err(|error| error.to_string())?;
    let order = order.ok_or("no order has a model")?;
    let among = match whole.samples() > data.samples() {
        true => ", among those that follow unseen samples as well as any",
        false => "",
    };
    let why = format!(
        "order {order} of 1 to {highest} has the smallest BIC of the simulation, with the effective number of samples\
         {among}, in models of one horizon of {} block rows",
        horizon.block_rows
    );
    Ok((order, horizon, why))
}

/// The stabilisation diagram of a subspace method, from as many samples as its models.
pub fn put_subspace_diagram(
    weighting: Weighting,
    max_order: usize,
    (record, data): (&Record, &IoData),
    input_output: &InputOutputSettings,
    wanted: &Stabilisation,
    out: &mut Output,
) -> anyhow::Result<()> {
    let method = weighting.name();
    let models = with_all_orders(weighting, max_order, data, input_output, |subspace, thin, _| {
        (subspace_order_scan(subspace, max_order), thin.sample_time_s())
    });
    match models {
        Ok((models, dt_s)) => {
            let names: Vec<&str> = record.outputs.iter().map(|wave| wave.id.as_str()).collect();
            realization::put_diagram(method, &names.join(", "), &models, dt_s, wanted, out)?;
        }
        Err(error) => out.notes().warning(format!("{method}: no stabilisation diagram: {error}")),
    }
    Ok(())
}

/// Whether all inputs rest, each at one value, in half of the samples or more: what follows a blow is a free motion,
/// and its poles stand in the record without the input.
fn rests_for_half(inputs: &[Vec<f64>]) -> bool {
    let samples = inputs.first().map_or(0, Vec::len);
    let rests = |k: usize| k > 0 && inputs.iter().all(|u| u[k] == u[k - 1]);
    2 * (0..samples).filter(|k| rests(*k)).count() >= samples
}

/// A subspace model of one order, from the horizon that simulates best: of those that the order and the record ask for,
/// and of that by which the order was chosen, where it was.
pub fn identify_order(
    weighting: Weighting,
    order: usize,
    data: &IoData,
    input_output: &InputOutputSettings,
    compared: Option<Horizon>,
) -> Result<DiscreteModel, IdentifyError> {
    let (m, q) = (data.inputs().len(), data.outputs().len());
    let shortest = (2 * order).max(SHORTEST_HORIZON);
    let every = thinning(input_output, input_output.block_rows.unwrap_or(shortest), data);
    let thin = Thinned::new(data, every)?;
    let Horizons { block_rows: candidates, lags } = match input_output.block_rows {
        Some(given) => Horizons { block_rows: vec![given], lags: None },
        None => horizons(thin.samples(), shortest),
    };
    let compared = compared.filter(|other| {
        input_output.block_rows.is_none() && !(other.every == every && candidates.contains(&other.block_rows))
    });
    let mut results: Vec<Result<HorizonModel, IdentifyError>> = candidates
        .iter()
        .map(|&block_rows| identify_with_horizon(SubspaceOptions { weighting, block_rows, direct: true }, order, &thin))
        .collect();
    if let Some(Horizon { every, block_rows }) = compared {
        let options = SubspaceOptions { weighting, block_rows, direct: true };
        results.push(Thinned::new(data, every).and_then(|thin| identify_with_horizon(options, order, &thin)));
    }
    // The first of several that simulate alike; if none leads to a model, why the shortest does not.
    let best = results.into_iter().reduce(|best, next| if loss_of(&next) < loss_of(&best) { next } else { best });
    let HorizonModel { every, thin_samples, block_rows, subspace: (singular_values, (excited, full)), model, .. } =
        best.ok_or(IdentifyError::OrderZero)??;
    let mut notes = Notes::new();
    if input_output.block_rows.is_none() {
        let mut tried: Vec<String> = candidates.iter().map(ToString::to_string).collect();
        tried.extend(compared.map(|other| format!("{} by which the order was chosen", other.block_rows)));
        let mut text = format!("horizon of {block_rows} block rows: ");
        text.push_str(&match tried.len() {
            1 => format!("twice the order, {SHORTEST_HORIZON} at least"),
            _ => format!("of [{}] the one whose model simulates best", tried.join(", ")),
        });
        text.extend(lags.map(|lags| format!("; a regression on the past needs {lags} lags by BIC")));
        notes.info(text);
    }
    if excited < full && !rests_for_half(data.inputs()) {
        notes.warning(format!(
            "the input excites {excited} of {full} directions only: it follows from its own past, so driven and free \
             motion cannot be separated and the poles are unreliable; use tfest, or --inputs none for a free motion"
        ));
    }
    if every > 1 {
        notes.info(format!(
            "the poles were found from every {every}th sample after a low-pass filter ({thin_samples} samples of \
             {:.4e} s), the input matrix and the initial state from all samples: on the whole record the same block \
             rows would span too short a time",
            data.sample_time_s() * every as f64
        ));
    }
    if model.reflected_poles > 0 {
        notes.warning(format!(
            "{} unstable poles were mirrored into the unit circle so that the model can be simulated; arx with \
             --allow-unstable gives them as they are",
            model.reflected_poles
        ));
    }
    let choices = RecordChoices { thin: Some(every), lags: None, block_rows: Some(block_rows) };
    Ok(DiscreteModel {
        singular_values,
        notes,
        choices,
        ..DiscreteModel::new(model.model, order * (m + q + 1) + m * q)
    })
}

/// A record and every n-th sample of it.
struct Thinned<'a> {
    whole: &'a IoData,
    every: usize,
    thin: Option<IoData>,
}

impl<'a> Thinned<'a> {
    fn new(whole: &'a IoData, every: usize) -> Result<Self, IdentifyError> {
        let thin = if every > 1 { Some(thinned(whole, every)?) } else { None };
        Ok(Self { whole, every, thin })
    }

    /// What is factorised.
    fn samples(&self) -> &IoData {
        self.thin.as_ref().unwrap_or(self.whole)
    }
}

/// A subspace model of one horizon.
struct HorizonModel {
    every: usize,
    thin_samples: usize,
    block_rows: usize,
    /// Singular values, and of how many independent inputs the record has how many.
    subspace: (Vec<f64>, (usize, usize)),
    model: SubspaceModel,
    /// Squares of the simulation errors over those of the outputs, summed over outputs.
    loss: f64,
}

fn identify_with_horizon(
    options: SubspaceOptions,
    order: usize,
    record: &Thinned<'_>,
) -> Result<HorizonModel, IdentifyError> {
    let data = record.whole;
    let subspace = Subspace::new(record.samples(), options)?;
    let model = if record.thin.is_some() { subspace.realize_on(order, data)? } else { subspace.realize(order)? };
    let (simulated, _) = simulate_fitted(&model.model, data)?;
    let relative = |(y, yh): (&Vec<f64>, &Vec<f64>)| {
        let error: f64 = y.iter().zip(yh).map(|(y, yh)| (y - yh).powi(2)).sum();
        error / y.iter().map(|y| y * y).sum::<f64>().max(f64::MIN_POSITIVE)
    };
    let loss = data.outputs().iter().zip(&simulated).map(relative).sum();
    let summary = (subspace.singular_values().to_vec(), subspace.excitation());
    Ok(HorizonModel {
        every: record.every,
        thin_samples: record.samples().samples(),
        block_rows: options.block_rows,
        subspace: summary,
        model,
        loss,
    })
}

/// Infinite without a model.
fn loss_of(result: &Result<HorizonModel, IdentifyError>) -> f64 {
    result.as_ref().map_or(f64::INFINITY, |model| if model.loss.is_nan() { f64::INFINITY } else { model.loss })
}

/// Errors below this share of the root mean square of an output are rounding: models that are exact compare by their
/// parameters.
const ROUNDING: f64 = 1e-10;

/// The order from 1 to `highest` whose model has the smallest BIC of its simulation; `None` where no order has a model.
///
/// The models come from one factorisation, of the record or, if `thin`, of every n-th sample of it; all are simulated
/// on the record. Samples that the whole has beyond it are unseen, and orders that follow them worse than by chance are
/// left out ([`left_by_unseen`]). Criteria count the effective samples of the model with the smallest loss; of several
/// outputs the losses are multiplied. BIC asks for more than AICc where records are long, and finds the true order of
/// many samples.
pub fn automatic_order(
    subspace: &Subspace<'_>,
    thin: bool,
    (data, whole): (&IoData, &IoData),
    highest: usize,
) -> Option<usize> {
    let orders: Vec<usize> = (1..=highest.min(subspace.highest_order())).collect();
    let unseen = whole.slice(data.samples(), whole.samples()).ok();
    let all: Vec<Contender> =
        orders.par_iter().filter_map(|order| contender(subspace, thin, (data, unseen.as_ref()), *order).ok()).collect();
    let left: Vec<Contender> = left_by_unseen(&all, best_of_many(all.len())).into_iter().cloned().collect();
    match select(&left) {
        Some(selection) => left.iter().find(|c| c.id == selection.best_by_bic).map(|c| c.order),
        None => left.first().map(|c| c.order),
    }
}

fn contender(
    subspace: &Subspace<'_>,
    thin: bool,
    (data, unseen): (&IoData, Option<&IoData>),
    order: usize,
) -> Result<Contender, IdentifyError> {
    let candidate = if thin { subspace.realize_on(order, data)? } else { subspace.realize(order)? };
    let (simulated, _) = simulate_fitted(&candidate.model, data)?;
    let unseen_squares = match unseen {
        Some(unseen) => unseen_squares(unseen.outputs(), &simulate_fitted(&candidate.model, unseen)?.0),
        None => Vec::new(),
    };
    let (m, q) = (data.inputs().len(), data.outputs().len());
    let mut log_loss = 0.0;
    let mut effective = 0.0;
    for (measured, model) in data.outputs().iter().zip(&simulated) {
        let error: Vec<f64> = measured.iter().zip(model).map(|(y, yh)| y - yh).collect();
        let mean_square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64;
        let floor = (ROUNDING * ROUNDING * mean_square(measured)).max(f64::MIN_POSITIVE);
        let loss = mean_square(&error);
        if !loss.is_finite() {
            return Err(IdentifyError::NotConverged("simulation"));
        }
        log_loss += loss.max(floor).ln();
        effective += autoregressive_effective_samples(&error);
    }
    Ok(Contender {
        id: order.to_string(),
        parameters: order * (m + q + 1) + m * q,
        loss: (log_loss / q as f64).exp(),
        effective_samples: effective,
        validation_fit_percent: None,
        order,
        restarted_fit_percent: None,
        unseen_squares,
    })
}
