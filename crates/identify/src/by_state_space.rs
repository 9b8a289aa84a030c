//! The discrete methods with an input: subspace, ARX, output error, and through Markov parameters OKID and FIR.

use crumple_identify::{
    Horizons, IdentifyError, IoData, Order, Subspace, SubspaceModel, SubspaceOptions, Weighting, automatic_thinning,
    horizons, simulate_fitted, subspace_order_scan, thinned,
};
use crumple_lti::{Complex, StateSpace};
use crumple_signal::TestDescription;
use crumple_stage::{Inputs, Outcome, Output, RefuseExt};

use crate::acceptable::{simulated, steady};
use crate::automatic_order::automatic_order;
use crate::beyond_era::BeyondEra;
use crate::by_markov::{impulse_response, okid};
use crate::comparison::Comparison;
use crate::diagram;
use crate::evidence_options::Stabilisation;
use crate::hankel_settings::HankelSettings;
use crate::input_output::{Record, record};
use crate::judgement::Equation;
use crate::settings::Settings;
use crate::state_space_records::{Task, put};
use crate::{by_arx, by_output_error};

/// The order where it is left to a method that does not choose one.
const AUTOMATIC_ORDER: usize = 4;

/// Block rows of past and future, at least.
const SHORTEST_HORIZON: usize = 10;

/// Samples that a thinned record keeps at least, in units of what its factorisation needs.
const KEPT: usize = 2;

/// A model of one order and what its method knows about it.
pub struct Found {
    pub model: StateSpace,
    /// Numbers that were fitted, the initial state of the simulation among them.
    pub parameters: usize,
    pub singular_values: Vec<f64>,
    /// One-step predictions of every output; empty: none.
    pub predicted: Vec<Vec<f64>>,
    /// First sample that is predicted; those before are the measured ones.
    pub predicted_from: usize,
    /// The equation, where the model is a regression of one output.
    pub equation: Option<Equation>,
    pub stop_reason: Option<&'static str>,
    /// Condition number of the sensitivities of an iterative fit.
    pub condition: Option<f64>,
    /// Loss of every refined start of one, best first, outputs divided by their root mean squares.
    pub losses: Vec<f64>,
    /// Standard deviations of frequency and damping of discrete poles, where the method has a covariance.
    pub deviations: Option<Deviations>,
    pub notes: Vec<String>,
    /// Models written beside the one that is simulated, by the last part of their topic.
    pub beside: Vec<(&'static str, StateSpace)>,
    /// What the method chose by the record and a fit to a replicate of it keeps.
    pub chosen: Chosen,
}

/// Standard deviations of frequency (rad/s) and damping ratio of discrete poles.
pub type Deviations = Box<dyn Fn(&[Complex]) -> Vec<Option<(f64, f64)>>>;

/// Choices that a method makes by the record before it fits.
#[derive(Debug, Clone, Copy, Default)]
pub struct Chosen {
    /// The subspace methods find poles from every n-th sample.
    pub thin: Option<usize>,
    /// Past samples that the observer sees.
    pub lags: Option<usize>,
    /// Block rows of the subspace methods.
    pub block_rows: Option<usize>,
}

impl Found {
    /// Nothing but the model.
    pub fn new(model: StateSpace, parameters: usize) -> Self {
        Self {
            model,
            parameters,
            singular_values: Vec::new(),
            predicted: Vec::new(),
            predicted_from: 0,
            equation: None,
            stop_reason: None,
            condition: None,
            losses: Vec::new(),
            deviations: None,
            notes: Vec::new(),
            beside: Vec::new(),
            chosen: Chosen::default(),
        }
    }
}

/// One model per order. What one order does not allow is a note; an error only if there is no model at all.
pub fn run(
    method: &str,
    settings: &Settings,
    test: &TestDescription,
    inputs: &Inputs,
    comparison: &mut Comparison,
    out: &mut Output,
) -> anyhow::Result<Outcome> {
    let Some(beyond) = &settings.beyond_era else { return Ok(Outcome::Done) };
    let record = record(settings, beyond, test, inputs)?;
    let (data, whole) = (record.data.delayed(beyond.delay), record.whole.delayed(beyond.delay));
    if let (Some(wanted), Some(weighting)) = (&settings.stabilisation, weighting(method)) {
        put_diagram((method, weighting), settings.max_order, (&record, &data), beyond, wanted, out)?;
    }
    let mut written = 0;
    let mut failures = Vec::new();
    let mut orders: Vec<usize> = Vec::with_capacity(settings.orders.len());
    for order in &settings.orders {
        let order = match order.0 {
            Order::Given(n) => n,
            Order::Automatic => chosen_order(method, settings.max_order, &data, beyond, out),
        };
        if !orders.contains(&order) {
            orders.push(order);
        }
    }
    for order in orders {
        let hankel = settings.hankel.as_ref();
        let found = identify(method, order, &data, beyond, hankel).and_then(|found| simulated(found, &data));
        match found {
            Ok((simulated, mut found)) => {
                if beyond.delay > 0 {
                    found
                        .notes
                        .push(format!("the input acts {} samples late; the model itself has no delay", beyond.delay));
                }
                let Chosen { thin, lags, block_rows } = found.chosen;
                let block_rows = block_rows.or(beyond.block_rows);
                let beyond_again = BeyondEra { thin: thin.or(beyond.thin), block_rows, ..beyond.clone() };
                let hankel_again = hankel.map(|hankel| HankelSettings { lags: lags.or(hankel.lags), ..hankel.clone() });
                let refit = |y: &[Vec<f64>]| {
                    let again = IoData::new(data.inputs().to_vec(), y.to_vec(), data.sample_time_s()).ok()?;
                    Some(identify(method, order, &again, &beyond_again, hankel_again.as_ref()).ok()?.model)
                };
                let task = Task {
                    id: &format!("{method}-{order}"),
                    method,
                    order,
                    record: &record,
                    hold: &beyond.hold,
                    data: &data,
                    whole: &whole,
                    bootstrap: settings.bootstrap.as_ref(),
                    refit: &refit,
                };
                put(&task, &found, &simulated, comparison, out)?;
                written += 1;
            }
            Err(error) => {
                failures.push((order, error));
            }
        }
    }
    let mut failures = failures.into_iter();
    // Where there is no model the first failure is the answer, told by who asked.
    let answer = if written == 0 { failures.next() } else { None };
    for (order, error) in failures {
        out.notes().warning(format!("{method}-{order}: {error}"));
    }
    match answer.map(|(_, error)| error) {
        // Nothing is passed on, but what was found is written: it is a result.
        Some(error @ (IdentifyError::Diverged { .. } | IdentifyError::Misses { .. })) => {
            Ok(Outcome::NoAcceptableResult(error.to_string()))
        }
        Some(error) => {
            Err(error).refuse_with_hint("lower --orders, widen the window (--from, --to), or name other waveforms")
        }
        None => Ok(Outcome::Done),
    }
}

fn weighting(method: &str) -> Option<Weighting> {
    Weighting::ALL.into_iter().find(|w| w.name() == method)
}

/// Every how manieth sample the subspace methods find poles from.
fn thinning(beyond: &BeyondEra, block_rows: usize, data: &IoData) -> usize {
    match (beyond.thin, beyond.block_rows) {
        (Some(every), _) => every,
        (None, Some(_)) => 1,
        (None, None) => {
            automatic_thinning(data, KEPT * Subspace::needed(block_rows, data.inputs().len(), data.outputs().len()))
        }
    }
}

/// Factorises the record, thinned as for its models, with a horizon for all orders up to `max_order`; `work` takes the
/// factorisation and what was factorised.
fn with_all_orders<T>(
    weighting: Weighting,
    max_order: usize,
    data: &IoData,
    beyond: &BeyondEra,
    work: impl FnOnce(&Subspace<'_>, &IoData) -> T,
) -> Result<T, IdentifyError> {
    let shortest = max_order + 2;
    let every = thinning(beyond, beyond.block_rows.unwrap_or(shortest), data);
    let thin = if every > 1 { thinned(data, every)? } else { data.clone() };
    let block_rows =
        beyond.block_rows.or_else(|| horizons(&thin, shortest).block_rows.last().copied()).unwrap_or(shortest);
    let subspace = Subspace::new(&thin, SubspaceOptions { weighting, block_rows, direct: true })?;
    Ok(work(&subspace, &thin))
}

/// The number of states where it is left to the method, with a note.
fn chosen_order(method: &str, max_order: usize, data: &IoData, beyond: &BeyondEra, out: &mut Output) -> usize {
    let Some(weighting) = weighting(method) else {
        let instead = if method == "arx" { "; --arx-scan compares structures" } else { "" };
        out.notes()
            .info(format!("{method}: order auto is not a choice of this method; {AUTOMATIC_ORDER} is used{instead}"));
        return AUTOMATIC_ORDER;
    };
    let (m, q) = (data.inputs().len(), data.outputs().len());
    // A short record has no room for the horizon of high orders.
    let highest = (1..=max_order).rev().find(|n| Subspace::needed(n + 2, m, q) <= data.samples()).unwrap_or(1);
    let found = with_all_orders(weighting, highest, data, beyond, |subspace, thin| {
        automatic_order(subspace, thin.samples() < data.samples(), data, highest)
    });
    match found {
        Ok(Some(order)) => {
            out.notes().info(format!(
                "{method}: order {order} of 1 to {highest} has the smallest BIC of the simulation, with the effective number of samples"
            ));
            order
        }
        Ok(None) | Err(_) => {
            let reason = found.err().map_or("no order has a model".to_owned(), |error| error.to_string());
            out.notes().warning(format!("{method}: no order can be chosen ({reason}); {AUTOMATIC_ORDER} is used"));
            AUTOMATIC_ORDER
        }
    }
}

/// The stabilisation diagram of a subspace method, from as many samples as its models.
fn put_diagram(
    (method, weighting): (&str, Weighting),
    max_order: usize,
    (record, data): (&Record, &IoData),
    beyond: &BeyondEra,
    wanted: &Stabilisation,
    out: &mut Output,
) -> anyhow::Result<()> {
    let models = with_all_orders(weighting, max_order, data, beyond, |subspace, thin| {
        (subspace_order_scan(subspace, max_order), thin.sample_time_s())
    });
    match models {
        Ok((models, dt_s)) => {
            let names: Vec<&str> = record.answers.iter().map(|cut| cut.id.as_str()).collect();
            diagram::put(method, &names.join(", "), &models, dt_s, wanted, out)?;
        }
        Err(error) => out.notes().warning(format!("{method}: no stabilisation diagram: {error}")),
    }
    Ok(())
}

fn identify(
    method: &str,
    order: usize,
    data: &IoData,
    beyond: &BeyondEra,
    hankel: Option<&HankelSettings>,
) -> Result<Found, IdentifyError> {
    match (method, hankel) {
        ("okid", Some(hankel)) => return okid(order, data, hankel),
        ("fir", Some(hankel)) => {
            return steady(impulse_response(order, data, hankel, beyond.initial == "zero")?, data);
        }
        _ => {}
    }
    let (m, q) = (data.inputs().len(), data.outputs().len());
    match method {
        "arx" => by_arx::of_order(order, data),
        "output-error" => by_output_error::of_order(order, data, beyond),
        name => {
            let weighting = weighting(name).unwrap_or(Weighting::N4sid);
            let shortest = (2 * order).max(SHORTEST_HORIZON);
            let every = thinning(beyond, beyond.block_rows.unwrap_or(shortest), data);
            let thin = if every > 1 { Some(thinned(data, every)?) } else { None };
            let mut notes = Vec::new();
            let Horizons { block_rows: candidates, lags } = match beyond.block_rows {
                Some(given) => Horizons { block_rows: vec![given], lags: None },
                None => horizons(thin.as_ref().unwrap_or(data), shortest),
            };
            let mut results = Vec::with_capacity(candidates.len());
            for &block_rows in &candidates {
                let options = SubspaceOptions { weighting, block_rows, direct: true };
                results.push(of_horizon(options, order, data, thin.as_ref()));
            }
            let results = results.into_iter();
            // The shortest of several that simulate alike; if none leads to a model, why the shortest does not.
            let best = results.reduce(|best, next| if losses(&next) < losses(&best) { next } else { best });
            let OfHorizon { block_rows, subspace: (singular_values, (excited, full)), found, .. } =
                best.ok_or(IdentifyError::OrderZero)??;
            if beyond.block_rows.is_none() {
                notes.push(match lags {
                    Some(lags) => format!(
                        "horizon of {block_rows} block rows: of {candidates:?} the one whose model simulates best; a regression on the past needs {lags} lags by BIC"
                    ),
                    None => format!("horizon of {block_rows} block rows: twice the order, {SHORTEST_HORIZON} at least"),
                });
            }
            if excited < full {
                notes.push(format!(
                    "warning: the input is worth {excited} of {full} independent ones: it follows from its own past, so driven and free motion cannot be told apart and the poles mean little; take tfest, or --inputs none for a free motion"
                ));
            }
            if let Some(thin) = &thin {
                notes.push(format!(
                    "poles from every {every}th sample behind a low-pass filter ({} samples of {:.4e} s), inputs and initial state from all: as many block rows of the whole record are too short a horizon",
                    thin.samples(),
                    thin.sample_time_s()
                ));
            }
            if found.reflected_poles > 0 {
                notes.push(format!(
                    "warning: {} growing poles were mirrored at the unit circle so that the model can be simulated",
                    found.reflected_poles
                ));
            }
            let chosen = Chosen { thin: Some(every), lags: None, block_rows: Some(block_rows) };
            Ok(Found { singular_values, notes, chosen, ..Found::new(found.model, order * (m + q + 1) + m * q) })
        }
    }
}

/// A subspace model of one horizon.
struct OfHorizon {
    block_rows: usize,
    /// Singular values, and of how many independent inputs the record has how many.
    subspace: (Vec<f64>, (usize, usize)),
    found: SubspaceModel,
    /// Squares of the simulation errors over those of the outputs, summed over outputs.
    loss: f64,
}

fn of_horizon(
    options: SubspaceOptions,
    order: usize,
    data: &IoData,
    thin: Option<&IoData>,
) -> Result<OfHorizon, IdentifyError> {
    let subspace = Subspace::new(thin.unwrap_or(data), options)?;
    let found = if thin.is_some() { subspace.realize_on(order, data)? } else { subspace.realize(order)? };
    let (simulated, _) = simulate_fitted(&found.model, data)?;
    let relative = |(y, yh): (&Vec<f64>, &Vec<f64>)| {
        let error: f64 = y.iter().zip(yh).map(|(y, yh)| (y - yh).powi(2)).sum();
        error / y.iter().map(|y| y * y).sum::<f64>().max(f64::MIN_POSITIVE)
    };
    let loss = data.outputs().iter().zip(&simulated).map(relative).sum();
    let known = (subspace.singular_values().to_vec(), subspace.excitation());
    Ok(OfHorizon { block_rows: options.block_rows, subspace: known, found, loss })
}

/// Infinite without a model.
fn losses(result: &Result<OfHorizon, IdentifyError>) -> f64 {
    result.as_ref().map_or(f64::INFINITY, |found| if found.loss.is_nan() { f64::INFINITY } else { found.loss })
}
