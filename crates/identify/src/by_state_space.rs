//! The discrete methods: subspace, ARX, output error.

use crumple_identify::{
    ArxOrder, IdentifyError, IoData, Order, OutputErrorOptions, Stop, Subspace, SubspaceOptions, Weighting, arx,
    continued, fit_measures, output_error, simulate_fitted, subspace_order_scan,
};
use crumple_lti::{Complex, Mode, StateSpace, undo_zero_order_hold};
use crumple_signal::TestDescription;
use crumple_stage::{Inputs, Outcome, Output, RefuseExt};

use crate::comparison::Comparison;
use crate::diagram;
use crate::evidence::{evidence, foretold, identification, modes, notes_on_modes, percent, validate};
use crate::input_output::{Cut, pair, whole};
use crate::judgement::{Band, Judged, put_spreads, spread, zeros_of};
use crate::options::{BeyondEra, Settings};
use crate::to_records::state_space;

/// Block rows and lags are for orders up to this where the order is automatic.
const AUTOMATIC_ORDER: usize = 4;

/// A model of one order and what its method knows about it.
struct Found {
    model: StateSpace,
    parameters: usize,
    singular_values: Vec<f64>,
    prediction_fit_percent: Option<f64>,
    stop_reason: Option<&'static str>,
    /// Standard deviations of frequency and damping of discrete poles, where the method has a covariance.
    deviations: Option<Deviations>,
    notes: Vec<String>,
}

type Deviations = Box<dyn Fn(&[Complex]) -> Vec<Option<(f64, f64)>>>;

/// What a model is for and from.
struct Task<'a> {
    method: &'a str,
    order: usize,
    beyond: &'a BeyondEra,
    drive: &'a Cut,
    answer: &'a Cut,
    /// The window.
    data: &'a IoData,
    /// The window and what is kept after it.
    whole: &'a IoData,
}

fn weighting(method: &str) -> Option<Weighting> {
    Weighting::ALL.into_iter().find(|w| w.name() == method)
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
    let (drive, answer, data) = pair(settings, beyond, test, inputs)?;
    let whole = whole(&drive, &answer, &data)?.delayed(beyond.delay);
    let data = data.delayed(beyond.delay);
    if let (Some(wanted), Some(weighting)) = (&settings.stabilisation, weighting(method)) {
        let block_rows = beyond.block_rows.unwrap_or(settings.max_order + 2);
        match Subspace::new(&data, SubspaceOptions { weighting, block_rows, direct: true }) {
            Ok(subspace) => {
                let models = subspace_order_scan(&subspace, settings.max_order);
                diagram::put(method, &answer.id, &models, data.sample_time_s(), wanted, out)?;
            }
            Err(error) => out.notes().warning(format!("{method}: no stabilisation diagram: {error}")),
        }
    }
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
        let found = identify(method, order, &data, beyond)
            .and_then(|found| Ok((simulate_fitted(&found.model, &data)?.0, found)));
        match found {
            Ok((mut simulated, found)) => {
                let mut found = found;
                if beyond.delay > 0 {
                    found
                        .notes
                        .push(format!("the input acts {} samples late; the model itself has no delay", beyond.delay));
                }
                let task = Task { method, order, beyond, drive: &drive, answer: &answer, data: &data, whole: &whole };
                put(&task, &found, &simulated.swap_remove(0), settings, comparison, out)?;
                written += 1;
            }
            Err(error) => {
                out.notes().warning(format!("{method}-{order}: {error}"));
                failure.get_or_insert(error);
            }
        }
    }
    match failure.filter(|_| written == 0) {
        Some(error) => {
            Err(error).refuse_with_hint("lower --orders, widen the window (--from, --to), or name other waveforms")
        }
        None => Ok(Outcome::Done),
    }
}

fn identify(method: &str, order: usize, data: &IoData, beyond: &BeyondEra) -> Result<Found, IdentifyError> {
    let none = |model: StateSpace, parameters: usize| Found {
        model,
        parameters,
        singular_values: Vec::new(),
        prediction_fit_percent: None,
        stop_reason: None,
        deviations: None,
        notes: Vec::new(),
    };
    match method {
        "arx" => {
            let model = arx(data, ArxOrder { na: order, nb: order + 1, nk: 0 })?;
            let predicted = fit_measures(&data.outputs()[0], &model.predict(data)).and_then(|fit| fit.fit_percent);
            let parameters = 2 * order + 1;
            let deviations = {
                let model = model.clone();
                Some(Box::new(move |poles: &[Complex]| model.mode_deviations(poles)) as Deviations)
            };
            Ok(Found { prediction_fit_percent: predicted, deviations, ..none(model.state_space()?, parameters) })
        }
        "output-error" => {
            let options = OutputErrorOptions {
                stop: Stop { max_iterations: beyond.max_iterations, ..Stop::default() },
                ..OutputErrorOptions::new(order)
            };
            let found = output_error(data, options)?;
            Ok(Found { stop_reason: Some(found.termination.name()), ..none(found.model, found.criteria.parameters) })
        }
        name => {
            let weighting = weighting(name).unwrap_or(Weighting::N4sid);
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
                ..none(found.model, 3 * order + 1)
            })
        }
    }
}

fn put(
    task: &Task<'_>,
    found: &Found,
    simulated: &[f64],
    settings: &Settings,
    comparison: &mut Comparison,
    out: &mut Output,
) -> anyhow::Result<()> {
    let Task { method, order, drive, answer, .. } = *task;
    let id = format!("{method}-{order}");
    let (input, output) = (drive.describe(), answer.describe());
    let mut notes = found.notes.clone();
    out.put(&format!("/model/{id}/discrete"), &state_space(&found.model, &input, &output))?;
    let continuous = undo_zero_order_hold(&found.model);
    match &continuous {
        Ok(continuous) => out.put(&format!("/model/{id}/continuous"), &state_space(continuous, &input, &output))?,
        Err(error) => notes.push(format!("no continuous model: {error}")),
    }
    let dt = answer.sampled.dt_s();
    let pairs: Vec<_> =
        found.model.poles()?.into_iter().filter_map(|z| Some((Mode::discrete(z, dt)?, Some(z)))).collect();
    let judged = judged(&found.model, continuous.as_ref().ok(), answer)?;
    let mut remarks = notes_on_modes(&id, &judged.poles, &[answer, drive]);
    out.put(&format!("/modes/{id}"), &modes(pairs.iter().copied()))?;

    let mut support = evidence(Some(drive), answer, simulated, found.parameters);
    support.hold = Some("zero-order".to_owned());
    support.prediction_fit_percent = found.prediction_fit_percent;
    support.stop_reason = found.stop_reason.map(str::to_owned);
    if let Some(deviations) = &found.deviations {
        let discrete: Vec<Complex> = pairs.iter().filter_map(|(_, z)| *z).collect();
        let deviations = deviations(&discrete);
        support.frequency_deviations = deviations.iter().map(|d| d.map(|d| d.0)).collect();
        support.damping_deviations = deviations.iter().map(|d| d.map(|d| d.1)).collect();
    }
    if !answer.kept.is_empty() {
        let foretold = continued(&found.model, task.data, task.whole, None)?;
        validate(answer, &foretold[0], &mut support);
    }
    let grid = judged.grid_hz();
    let spreads = spread(
        settings.bootstrap.as_ref(),
        (&id, &judged.sample(&grid)),
        (answer.sampled.samples(), simulated),
        found.parameters,
        &mut remarks,
        |y| {
            let data = IoData::single(task.data.inputs()[0].clone(), y.to_vec(), dt).ok()?;
            let model = identify(method, order, &data, task.beyond).ok()?.model;
            let continuous = undo_zero_order_hold(&model).ok();
            Some(self::judged(&model, continuous.as_ref(), answer).ok()?.sample(&grid))
        },
    );
    let band = spreads.as_ref().map(Band::from_bootstrap);
    if let Some(spreads) = &spreads {
        put_spreads(spreads, &mut support);
    }
    if let Some(record) = judged.response(&input, &output, band.as_ref()) {
        out.put(&format!("/response/{id}"), &record)?;
    }
    notes.extend(remarks.to_texts());
    out.notes().extend(remarks);
    let mut record = identification(method, order, "input-output", answer, simulated, notes);
    record.singular_values = found.singular_values.clone();
    out.summary(format!(
        "{id}: {} of {} samples{}",
        percent(record.fit_percent),
        answer.sampled.len(),
        foretold(&support)
    ));
    out.put(&format!("/identification/{id}"), &record)?;
    out.put(&format!("/evidence/{id}"), &support)?;
    comparison.enter(&id, answer.sampled.len(), &support);
    Ok(())
}

fn judged<'a>(
    model: &'a StateSpace,
    continuous: Option<&'a StateSpace>,
    answer: &Cut,
) -> Result<Judged<'a>, IdentifyError> {
    let dt_s = answer.sampled.dt_s();
    Ok(Judged {
        continuous,
        discrete: Some(model),
        poles: model.poles()?.into_iter().filter_map(|z| Some(Mode::discrete(z, dt_s)?.pole)).collect(),
        zeros: continuous.map(zeros_of).unwrap_or_default(),
        dt_s,
        samples: answer.sampled.len(),
    })
}
