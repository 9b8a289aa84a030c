//! The discrete methods with an input: subspace, ARX, output error, and through Markov parameters OKID and FIR.

use crumple_identify::{
    ArxOrder, IdentifyError, IoData, Order, OutputErrorOptions, Stop, Subspace, SubspaceOptions, Weighting, arx,
    fit_measures, output_error, simulate_fitted,
};
use crumple_lti::{Mode, StateSpace, undo_zero_order_hold};
use crumple_signal::TestDescription;
use crumple_stage::{Inputs, Outcome, Output, RefuseExt};

use crate::by_markov::{impulse_response, okid};
use crate::evidence::{evidence, growth_notes, identification, modes, percent};
use crate::hankel_settings::HankelSettings;
use crate::input_output::{Cut, pair};
use crate::options::{BeyondEra, Settings};
use crate::to_records::state_space;

/// Block rows and lags are for orders up to this where the order is automatic.
const AUTOMATIC_ORDER: usize = 4;

/// A model of one order and what its method knows about it.
pub struct Found {
    pub model: StateSpace,
    pub parameters: usize,
    pub singular_values: Vec<f64>,
    pub prediction_fit_percent: Option<f64>,
    pub stop_reason: Option<&'static str>,
    pub notes: Vec<String>,
    /// Models written beside the one that is simulated, by the last part of their topic.
    pub beside: Vec<(&'static str, StateSpace)>,
}

impl Found {
    /// Nothing but the model.
    pub fn new(model: StateSpace, parameters: usize) -> Self {
        Self {
            model,
            parameters,
            singular_values: Vec::new(),
            prediction_fit_percent: None,
            stop_reason: None,
            notes: Vec::new(),
            beside: Vec::new(),
        }
    }
}

/// One model per order. What one order does not allow is a note; an error only if there is no model at all.
pub fn run(
    method: &str,
    settings: &Settings,
    test: &TestDescription,
    inputs: &Inputs,
    out: &mut Output,
) -> anyhow::Result<Outcome> {
    let Some(beyond) = &settings.beyond_era else { return Ok(Outcome::Done) };
    let (drive, answer, data) = pair(settings, beyond, test, inputs)?;
    let data = data.delayed(beyond.delay);
    let mut written = 0;
    let mut failure = None;
    for order in &settings.orders {
        let order = match order.0 {
            Order::Given(n) => n,
            Order::Automatic => {
                out.notes()
                    .info(format!("{method}: order auto is not a choice of this method; {AUTOMATIC_ORDER} is used"));
                AUTOMATIC_ORDER
            }
        };
        let found = identify(method, order, &data, beyond, settings.hankel.as_ref())
            .and_then(|found| Ok((simulate_fitted(&found.model, &data)?.0, found)));
        match found {
            Ok((mut simulated, found)) => {
                let mut found = found;
                if beyond.delay > 0 {
                    found
                        .notes
                        .push(format!("the input acts {} samples late; the model itself has no delay", beyond.delay));
                }
                put(method, order, &found, &simulated.swap_remove(0), (&drive, &answer), out)?;
                written += 1;
            }
            Err(error) => {
                out.notes().warning(format!("{method}-{order}: {error}"));
                failure.get_or_insert(error);
            }
        }
    }
    match failure.filter(|_| written == 0) {
        // Nothing is passed on, but what was found is written: it is a result.
        Some(error @ IdentifyError::Diverged { .. }) => Ok(Outcome::NoAcceptableResult(error.to_string())),
        Some(error) => {
            Err(error).refuse_with_hint("lower --orders, widen the window (--from, --to), or name other waveforms")
        }
        None => Ok(Outcome::Done),
    }
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
        ("fir", Some(hankel)) => return impulse_response(order, data, hankel, beyond.initial == "zero"),
        _ => {}
    }
    match method {
        "arx" => {
            let model = arx(data, ArxOrder { na: order, nb: order + 1, nk: 0 })?;
            let predicted = fit_measures(&data.outputs()[0], &model.predict(data)).and_then(|fit| fit.fit_percent);
            let parameters = 2 * order + 1;
            Ok(Found { prediction_fit_percent: predicted, ..Found::new(model.state_space()?, parameters) })
        }
        "output-error" => {
            let options = OutputErrorOptions {
                stop: Stop { max_iterations: beyond.max_iterations, ..Stop::default() },
                ..OutputErrorOptions::new(order)
            };
            let found = output_error(data, options)?;
            Ok(Found {
                stop_reason: Some(found.termination.name()),
                ..Found::new(found.model, found.criteria.parameters)
            })
        }
        name => {
            let weighting = Weighting::ALL.into_iter().find(|w| w.name() == name).unwrap_or(Weighting::N4sid);
            let block_rows = beyond.block_rows.unwrap_or((2 * order).max(10));
            let subspace = Subspace::new(data, SubspaceOptions { weighting, block_rows, direct: true })?;
            let found = subspace.realize(order)?;
            let mut notes = Vec::new();
            if found.reflected_poles > 0 {
                notes.push(format!(
                    "warning: {} growing poles were mirrored at the unit circle so that the model can be simulated",
                    found.reflected_poles
                ));
            }
            Ok(Found {
                singular_values: subspace.singular_values().to_vec(),
                notes,
                ..Found::new(found.model, 3 * order + 1)
            })
        }
    }
}

fn put(
    method: &str,
    order: usize,
    found: &Found,
    simulated: &[f64],
    (drive, answer): (&Cut, &Cut),
    out: &mut Output,
) -> anyhow::Result<()> {
    let id = format!("{method}-{order}");
    let (input, output) = (drive.describe(), answer.describe());
    let mut notes = found.notes.clone();
    out.put(&format!("/model/{id}/discrete"), &state_space(&found.model, &input, &output))?;
    match undo_zero_order_hold(&found.model) {
        Ok(continuous) => out.put(&format!("/model/{id}/continuous"), &state_space(&continuous, &input, &output))?,
        Err(error) => notes.push(format!("no continuous model: {error}")),
    }
    for (name, model) in &found.beside {
        let inputs = format!("{input}; {output}");
        out.put(&format!("/model/{id}/{name}"), &state_space(model, &inputs, &output))?;
    }
    let dt = answer.sampled.dt_s();
    let pairs: Vec<_> =
        found.model.poles()?.into_iter().filter_map(|z| Some((Mode::discrete(z, dt)?, Some(z)))).collect();
    growth_notes(&id, &pairs.iter().map(|(mode, _)| mode.pole).collect::<Vec<_>>(), &mut notes);
    out.put(&format!("/modes/{id}"), &modes(pairs.into_iter()))?;
    let mut record = identification(method, order, "input-output", answer, simulated, notes);
    record.singular_values = found.singular_values.clone();
    let mut support = evidence(Some(drive), answer, simulated, found.parameters);
    support.hold = Some("zero-order".to_owned());
    support.prediction_fit_percent = found.prediction_fit_percent;
    support.stop_reason = found.stop_reason.map(str::to_owned);
    out.summary(format!("{id}: {} of {} samples", percent(record.fit_percent), answer.sampled.len()));
    out.put(&format!("/identification/{id}"), &record)?;
    out.put(&format!("/evidence/{id}"), &support)?;
    Ok(())
}
