//! The discrete methods with an input: subspace, ARX, output error, and through Markov parameters OKID and FIR.

use crumple_identify::{
    ArxOrder, IdentifyError, IoData, Order, OutputErrorOptions, Stop, Subspace, SubspaceOptions, Weighting, arx,
    automatic_thinning, fit_measures, output_error, simulate_fitted, thinned, vector_arx,
};
use crumple_lti::{InputHold, Mode, StateSpace, to_continuous, to_transfer_function};
use crumple_signal::TestDescription;
use crumple_stage::{Inputs, Outcome, Output, RefuseExt};

use crate::by_markov::{impulse_response, okid};
use crate::evidence::{growth_notes, modes, of_record, percent, put_evidence, put_transfer_functions};
use crate::hankel_settings::HankelSettings;
use crate::input_output::{Record, record};
use crate::options::{BeyondEra, Settings};
use crate::to_records::state_space;

/// Block rows and lags are for orders up to this where the order is automatic.
const AUTOMATIC_ORDER: usize = 4;

/// Transfer functions of more states are not written: their coefficients say nothing.
const MOST_COEFFICIENTS: usize = 10;

/// Samples that a thinned record keeps at least, in units of what its factorisation needs.
const KEPT: usize = 2;

/// A model of one order and what its method knows about it.
pub struct Found {
    pub model: StateSpace,
    pub parameters: usize,
    pub singular_values: Vec<f64>,
    /// One-step predictions of every output; empty: none.
    pub predicted: Vec<Vec<f64>>,
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
            predicted: Vec::new(),
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
    let record = record(settings, beyond, test, inputs)?;
    let data = record.data.delayed(beyond.delay);
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
            Ok((simulated, mut found)) => {
                if beyond.delay > 0 {
                    found
                        .notes
                        .push(format!("the input acts {} samples late; the model itself has no delay", beyond.delay));
                }
                put(method, order, &found, &simulated, (&record, &beyond.hold), out)?;
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
    let (m, q) = (data.inputs().len(), data.outputs().len());
    match method {
        "arx" if q == 1 => {
            let model = arx(data, ArxOrder { na: order, nb: order + 1, nk: 0 })?;
            let parameters = order + m * (order + 1);
            Ok(Found { predicted: vec![model.predict(data)], ..Found::new(model.state_space()?, parameters) })
        }
        "arx" => {
            let lags = order.div_ceil(q);
            let model = vector_arx(data, ArxOrder { na: lags, nb: lags + 1, nk: 0 })?;
            let note = format!("{lags} lags of {q} outputs make {} states", lags * q);
            let parameters = q * (lags * q + (lags + 1) * m);
            let predicted = model.predict(data);
            Ok(Found { predicted, notes: vec![note], ..Found::new(model.state_space()?, parameters) })
        }
        "output-error" => {
            let options = OutputErrorOptions {
                stop: Stop { max_iterations: beyond.most_iterations(), ..Stop::default() },
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
            let every = match (beyond.thin, beyond.block_rows) {
                (Some(every), _) => every,
                (None, Some(_)) => 1,
                (None, None) => automatic_thinning(data, KEPT * Subspace::needed(block_rows, m, q)),
            };
            let mut notes = Vec::new();
            let options = SubspaceOptions { weighting, block_rows, direct: true };
            let mut warn = |subspace: &Subspace<'_>| {
                let (excited, full) = subspace.excitation();
                if excited < full {
                    notes.push(format!(
                        "warning: the input is worth {excited} of {full} independent ones: it follows from its own past, so driven and free motion cannot be told apart and the poles mean little; take tfest, or --inputs none for a free motion"
                    ));
                }
                subspace.singular_values().to_vec()
            };
            let (singular_values, found) = if every > 1 {
                let thin = thinned(data, every)?;
                let subspace = Subspace::new(&thin, options)?;
                let result = (warn(&subspace), subspace.realize_on(order, data)?);
                notes.push(format!(
                    "poles from every {every}th sample behind a low-pass filter ({} samples of {:.4e} s), inputs and initial state from all: {block_rows} block rows of the whole record are too short a horizon",
                    thin.samples(),
                    thin.sample_time_s()
                ));
                result
            } else {
                let subspace = Subspace::new(data, options)?;
                (warn(&subspace), subspace.realize(order)?)
            };
            if found.reflected_poles > 0 {
                notes.push(format!(
                    "warning: {} growing poles were mirrored at the unit circle so that the model can be simulated",
                    found.reflected_poles
                ));
            }
            Ok(Found { singular_values, notes, ..Found::new(found.model, order * (m + q + 1) + m * q) })
        }
    }
}

fn put(
    method: &str,
    order: usize,
    found: &Found,
    simulated: &[Vec<f64>],
    (record, hold): (&Record, &str),
    out: &mut Output,
) -> anyhow::Result<()> {
    let id = format!("{method}-{order}");
    let (input, output) = (record.input(), record.output());
    let mut notes = found.notes.clone();
    for text in notes.iter().filter_map(|note| note.strip_prefix("warning: ")) {
        out.notes().warning(format!("{id}: {text}"));
    }
    out.put(&format!("/model/{id}/discrete"), &state_space(&found.model, &input, &output))?;
    put_continuous(&id, &found.model, (record, hold), &mut notes, out)?;
    for (name, model) in &found.beside {
        let inputs = format!("{input}; {output}");
        out.put(&format!("/model/{id}/{name}"), &state_space(model, &inputs, &output))?;
    }
    let dt = record.data.sample_time_s();
    let pairs: Vec<_> =
        found.model.poles()?.into_iter().filter_map(|z| Some((Mode::discrete(z, dt)?, Some(z)))).collect();
    growth_notes(&id, &pairs.iter().map(|(mode, _)| mode.pole).collect::<Vec<_>>(), &mut notes);
    out.put(&format!("/modes/{id}"), &modes(pairs.into_iter()))?;
    let (mut whole, mut supports) = of_record(method, order, record, simulated, found.parameters, notes);
    whole.singular_values = found.singular_values.clone();
    for (k, support) in supports.iter_mut().enumerate() {
        support.hold = (!record.drives.is_empty()).then(|| hold.to_owned());
        support.prediction_fit_percent = found
            .predicted
            .get(k)
            .and_then(|predicted| fit_measures(&record.data.outputs()[k], predicted))
            .and_then(|fit| fit.fit_percent);
        support.stop_reason = found.stop_reason.map(str::to_owned);
    }
    out.summary(format!("{id}: {} of {} samples", percent(whole.fit_percent), record.data.samples()));
    out.put(&format!("/identification/{id}"), &whole)?;
    put_evidence(&id, &supports, out)
}

/// The continuous model by the logarithm for the hold declared, and its transfer functions.
fn put_continuous(
    id: &str,
    model: &StateSpace,
    (record, hold): (&Record, &str),
    notes: &mut Vec<String>,
    out: &mut Output,
) -> anyhow::Result<()> {
    let hold = if hold == "zero-order" { InputHold::Zero } else { InputHold::First };
    let found = match to_continuous(model, hold) {
        Ok(found) => found,
        Err(error) => {
            notes.push(format!("no continuous model: {error}"));
            return Ok(());
        }
    };
    for z in &found.conjugated {
        notes.push(format!(
            "the pole z = {z:.6} has no continuous counterpart: the continuous model has one more state, a conjugate at the Nyquist frequency, and agrees at the samples only"
        ));
    }
    let continuous = found.model;
    out.put(&format!("/model/{id}/continuous"), &state_space(&continuous, &record.input(), &record.output()))?;
    if continuous.order() > MOST_COEFFICIENTS {
        return Ok(());
    }
    let mut entries = Vec::new();
    for i in 0..record.answers.len() {
        for j in 0..record.drives.len() {
            let path = StateSpace::new(
                continuous.a.clone(),
                continuous.b.columns(j, 1).into_owned(),
                continuous.c.rows(i, 1).into_owned(),
                continuous.d.view((i, j), (1, 1)).into_owned(),
                None,
            )?;
            match to_transfer_function(&path) {
                Ok(tf) => entries.push((tf.numerator().to_vec(), tf.denominator().to_vec())),
                Err(error) => {
                    notes.push(format!("no transfer function: {error}"));
                    return Ok(());
                }
            }
        }
    }
    let inputs = record.drives.len();
    put_transfer_functions(id, record, |i, j| entries[i * inputs + j].clone(), out)
}
