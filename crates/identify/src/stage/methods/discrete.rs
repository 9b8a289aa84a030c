//! The discrete methods with an input: every model asked for is identified, simulated and written.

use crumple_numerics::lti::Complex;
use crumple_signal::{About, Note, Notes, TestDescription, Weight, remarks};
use crumple_stage::{Inputs, Outcome, Output, RefuseExt};
use crumple_sysid::{
    AmbientModes, Horizon, IdentifyError, IoData, MissReason, Order, OutputErrorOptions, Stop, Weighting, fit_measures,
    output_error, weak_fit,
};

use crate::stage::methods::okid::okid;
use crate::stage::methods::subspace::{chosen_order, put_subspace_diagram};
use crate::stage::methods::{arx, subspace};
use crate::stage::options::choices::{Initial, Method};
use crate::stage::options::orders::OrderOption;
use crate::stage::options::settings::{HankelSettings, InputOutputSettings, Settings};
use crate::stage::records::discrete::{
    DiscreteModel, DiscreteTask, RecordChoices, put_discrete_model, simulate_accepted,
};
use crate::stage::records::evidence::of_model;
use crate::stage::records::results::Results;
use crate::stage::waves::{Record, Source, flag, record, widen_the_window};

/// A method and the waveforms that it works on.
pub struct MethodRun<'a> {
    /// Name of the method.
    pub method: Method,
    /// Settings of the stage.
    pub settings: &'a Settings,
    /// Settings of the methods other than `era`.
    pub input_output: &'a InputOutputSettings,
    /// The waveforms.
    pub record: Record,
    /// The window, inputs delayed.
    pub data: IoData,
    /// The same with what is kept after it.
    pub whole: IoData,
    /// What a user can do where no request leads to a model.
    pub hint: String,
}

/// Identifies a model from a record.
pub type Estimator<'a> = Box<dyn Fn(&IoData, RecordChoices) -> Result<DiscreteModel, IdentifyError> + Sync + 'a>;

/// One model that is asked for.
pub struct ModelRequest<'a> {
    /// Its id.
    pub id: String,
    /// States asked for.
    pub order: usize,
    /// Identifies the model from a record, the measured one or a replicate of it, with the choices already made.
    pub identify: Estimator<'a>,
    /// A note on why this model is asked for.
    pub remark: Option<Note>,
}

impl<'a> MethodRun<'a> {
    /// Reads the waveforms.
    pub fn new(
        method: Method,
        source: Source<'a>,
        input_output: &'a InputOutputSettings,
        hint: String,
    ) -> anyhow::Result<Self> {
        let record = record(source, input_output)?;
        let (data, whole) = (record.data.delayed(input_output.delay), record.whole.delayed(input_output.delay));
        Ok(Self { method, settings: source.settings, input_output, record, data, whole, hint })
    }

    /// Writes one model per request. A request that cannot be met is a warning; where none can, the first reason is
    /// returned, as an error or as a diagnosis.
    pub fn put_all(&self, requests: &[ModelRequest<'_>], results: &mut Results<'_>) -> anyhow::Result<Outcome> {
        let mut written = 0;
        let mut failures = Vec::new();
        for request in requests {
            let identified = (request.identify)(&self.data, RecordChoices::default());
            let allowed = self.input_output.allow_unstable;
            match identified.and_then(|model| simulate_accepted(model, &self.data, allowed)) {
                Ok((simulated, model)) => {
                    self.put_model(request, model, simulated, results)?;
                    written += 1;
                }
                Err(error) => failures.push((&request.id, error)),
            }
        }
        let mut failures = failures.into_iter();
        // Where there is no model the first failure is the answer.
        let answer = if written == 0 { failures.next() } else { None };
        for (id, error) in failures {
            let (method, what) = (self.method.to_string(), id.clone());
            results.out.notes().push(NoModel { method, what, reason: self.reason(&error) });
        }
        match answer.map(|(_, error)| error) {
            // Nothing is passed on, but what was found is written: it is a result.
            Some(error @ (IdentifyError::Diverged { .. } | IdentifyError::Misses { .. })) => {
                Ok(Outcome::NoAcceptableResult(self.reason(&error)))
            }
            Some(error) => Err(error).refuse_with_hint(&self.hint),
            None => Ok(Outcome::Done),
        }
    }

    /// Why a request has no model, with the flag that gives the poles of one that grows.
    fn reason(&self, error: &IdentifyError) -> String {
        match error {
            IdentifyError::Misses { why: MissReason::Grows { .. }, .. } if self.method.predicts() => {
                format!("{error}; {} gives its poles and its one-step prediction", flag("allow-unstable"))
            }
            _ => error.to_string(),
        }
    }

    fn put_model(
        &self,
        request: &ModelRequest<'_>,
        mut model: DiscreteModel,
        simulated: Vec<Vec<f64>>,
        results: &mut Results<'_>,
    ) -> anyhow::Result<()> {
        let Self { method, settings, input_output, record, data, whole, .. } = self;
        request.remark.iter().for_each(|remark| model.notes.push(remark.clone()));
        if input_output.delay > 0 {
            model.notes.push(InputLate { samples: Some(input_output.delay), delay_s: None });
        }
        let choices = model.choices;
        let refit = |y: &[Vec<f64>]| {
            let again = IoData::new(data.inputs().to_vec(), y.to_vec(), data.sample_time_s()).ok()?;
            Some((request.identify)(&again, choices).ok()?.state_space)
        };
        let task = DiscreteTask {
            id: &request.id,
            method: *method,
            order: request.order,
            record,
            hold: input_output.hold,
            data,
            whole,
            bootstrap: settings.bootstrap.as_ref(),
            refit: &refit,
        };
        put_discrete_model(&task, model, simulated, results)
    }
}

/// The order where it is left to a method that does not choose one.
const AUTOMATIC_ORDER: usize = 4;

/// What to do about orders without a model.
fn hint() -> String {
    format!("lower {}, {}, or name other waveforms", flag("orders"), widen_the_window())
}

/// Why an order is tried that the record chose: the horizon of the models that were compared, and the comparison.
type Choice = (Horizon, Note);

/// One model per order.
pub fn run(method: Method, source: Source<'_>, results: &mut Results<'_>) -> anyhow::Result<Outcome> {
    let Some(input_output) = &source.settings.input_output else { return Ok(Outcome::Done) };
    let all = MethodRun::new(method, source, input_output, hint())?;
    let weighting = method.weighting();
    if let (Some(wanted), Some(weighting)) = (&source.settings.stabilisation, weighting) {
        put_subspace_diagram(
            weighting,
            source.settings.max_order,
            (&all.record, &all.data),
            input_output,
            wanted,
            results.out,
        )?;
    }
    let mut orders: Vec<(usize, Option<Choice>)> = Vec::with_capacity(source.settings.orders.len());
    for order in &source.settings.orders {
        let (order, choice) = match order.0 {
            Order::Given(n) => (n, None),
            Order::Automatic => choose_order(
                method,
                weighting,
                source.settings.max_order,
                (&all.data, &all.whole),
                input_output,
                results.out,
            ),
        };
        match orders.iter_mut().find(|(other, _)| *other == order) {
            Some((_, known)) => *known = known.take().or(choice),
            None => orders.push((order, choice)),
        }
    }
    let hankel = source.settings.hankel.as_ref();
    let requests: Vec<ModelRequest<'_>> = orders
        .into_iter()
        .map(|(order, choice)| (order, choice.unzip()))
        .map(|(order, (compared, remark))| ModelRequest {
            id: format!("{method}-{order}"),
            order,
            identify: Box::new(move |data, choices| {
                let input_output = InputOutputSettings {
                    thin: choices.thin.or(input_output.thin),
                    block_rows: choices.block_rows.or(input_output.block_rows),
                    ..input_output.clone()
                };
                let hankel =
                    hankel.map(|hankel| HankelSettings { lags: choices.lags.or(hankel.lags), ..hankel.clone() });
                let subspace = weighting.map(|weighting| (weighting, compared));
                identify(method, subspace, order, data, &input_output, hankel.as_ref())
            }),
            remark,
        })
        .collect();
    all.put_all(&requests, results)
}

/// The lines of an ambient record, and two states for each mode and line where the order is left to the record: there
/// the simulation from the first sample on says nothing about it. A record that such a model simulates is a free
/// motion, and is left alone.
pub fn take_from_ambient(
    settings: &mut Settings,
    ambient: &AmbientModes,
    test: &TestDescription,
    inputs: &Inputs,
    out: &mut Output,
) {
    let (modes, lines) = (ambient.modes.len(), ambient.harmonics.len());
    if let Some(input_output) = &mut settings.input_output {
        input_output.harmonics_rad_per_s = ambient.harmonics.iter().map(|line| line.frequency_rad_per_s).collect();
    }
    let automatic = OrderOption(Order::Automatic);
    let Some(input_output) = settings.input_output.as_ref().filter(|_| settings.orders.contains(&automatic)) else {
        return;
    };
    let order = 2 * (modes + lines);
    let is_ambient = || -> Option<bool> {
        let record = record(Source { settings, test, inputs }, input_output).ok()?;
        let model = subspace::identify_order(Weighting::N4sid, order, &record.data, input_output, None).ok()?;
        let simulated = simulate_accepted(model, &record.data, false).map(|(simulated, _)| simulated);
        let is_weak = |(y, yh): (&Vec<f64>, &Vec<f64>)| {
            fit_measures(y, yh).and_then(|fit| fit.fit_percent).is_none_or(|fit| weak_fit(fit).is_some())
        };
        Some(simulated.map_or(true, |all| record.data.outputs().iter().zip(&all).any(is_weak)))
    };
    if order == 0 || is_ambient() != Some(true) {
        return;
    }
    out.notes().push(OrderOfAmbient { order, modes, lines });
    for known in settings.orders.iter_mut().filter(|known| **known == automatic) {
        *known = OrderOption(Order::Given(order));
    }
}

/// The number of states where it is left to the method, told in a note, and why this one where the record chose it.
fn choose_order(
    method: Method,
    weighting: Option<Weighting>,
    max_order: usize,
    data: (&IoData, &IoData),
    input_output: &InputOutputSettings,
    out: &mut Output,
) -> (usize, Option<Choice>) {
    let (method, order) = (method.to_string(), AUTOMATIC_ORDER);
    let Some(weighting) = weighting else {
        out.notes().push(OrderIsFixed { method, order });
        return (order, None);
    };
    match chosen_order(weighting, max_order, data, input_output) {
        Ok((order, horizon, why)) => {
            out.notes().push(of_model(&method, why.clone()));
            (order, Some((horizon, why)))
        }
        Err(reason) => {
            out.notes().push(NoOrderChosen { method, reason, order });
            (order, None)
        }
    }
}

/// A model of any record; `subspace` for the methods with a weighting.
fn identify(
    method: Method,
    subspace: Option<(Weighting, Option<Horizon>)>,
    order: usize,
    data: &IoData,
    input_output: &InputOutputSettings,
    hankel: Option<&HankelSettings>,
) -> Result<DiscreteModel, IdentifyError> {
    match (method, hankel) {
        (Method::Okid, Some(hankel)) => okid(order, data, hankel),
        (Method::Arx, _) => arx::identify_order(order, data),
        (Method::OutputError, _) => by_output_error(order, data, input_output),
        _ => {
            let (weighting, compared) = subspace.unwrap_or((Weighting::N4sid, None));
            subspace::identify_order(weighting, order, data, input_output, compared)
        }
    }
}

/// Output error of one order.
fn by_output_error(
    order: usize,
    data: &IoData,
    input_output: &InputOutputSettings,
) -> Result<DiscreteModel, IdentifyError> {
    let options = OutputErrorOptions {
        from_rest: input_output.initial == Initial::Zero,
        stop: Stop { max_iterations: input_output.most_iterations(), ..Stop::default() },
        ..OutputErrorOptions::new(order)
    };
    let fit = output_error(data, options)?;
    let mut notes = Notes::new();
    let copies = data.inputs().len().min(data.outputs().len());
    if copies > 1 {
        let (poles, states) = (Some(order), Some(copies * order));
        notes.push(StatesOfPaths { poles, lags: None, outputs: None, states });
    }
    let pole_deviations = fit.pole_deviations;
    // The poles of the model are those of the chain, some several times.
    let deviations = move |poles: &[Complex]| {
        let nearest = |z: &Complex| {
            let nearer = |a: &&(Complex, _), b: &&(Complex, _)| (a.0 - z).norm().total_cmp(&(b.0 - z).norm());
            pole_deviations.iter().min_by(nearer).and_then(|(_, deviations)| *deviations)
        };
        poles.iter().map(nearest).collect()
    };
    Ok(DiscreteModel {
        stop_reason: Some(fit.stop_reason.name_with_bounds(fit.on_bound)),
        deviations: Some(Box::new(deviations)),
        condition: Some(fit.condition).filter(|condition| condition.is_finite()),
        losses: fit.losses,
        notes,
        ..DiscreteModel::new(fit.model, fit.criteria.parameters)
    })
}

remarks! {
    /// Remarks of methods that identify one model a request.
    pub REMARKS;

    /// A method, or one order of it, gave no model.
    CR431 NoModel { method: String, what: String, reason: String }
    bears on (About::Method(method.clone()), Weight::Slight)
    decided "The method refuses the samples or the settings, or what it found does not follow the record."
    means "Nothing is written for it. Models of other orders and methods are not touched by it."
    remedy "do what the sentence says, try a lower order: --orders, or leave the method out: --methods"
    says format!("{what} gave no model: {reason}");

    /// The input acts late.
    CR432 InputLate { samples: Option<usize>, delay_s: Option<f64> }
    bears on (About::IdentifiedModels, Weight::None)
    decided "--delay states it in samples, or the record chose it: --delay auto."
    means "Matrices and coefficients leave the delay out. Simulate with an input that is late by as much: delay_s."
    remedy "nothing; --delay changes it"
    says match samples {
        Some(samples) => format!("the input acts {samples} samples late; the model itself has no delay"),
        None => format!(
            "the input acts {:.6} s late: the coefficients have no delay in them, delay_s and the responses have",
            delay_s.unwrap_or_default()
        ),
    };

    /// The order follows from the modes of a record without an input.
    CR433 OrderOfAmbient { order: usize, modes: usize, lines: usize }
    bears on (About::IdentifiedModels, Weight::None)
    decided "Two states for each mode that orders and both halves of the record share, and for each line of a machine."
    means "The model has room for what the record shows twice, and for nothing else."
    remedy "nothing; --orders takes another number of states"
    says {
        let lines = if *lines > 0 { format!(" and {lines} harmonic lines") } else { String::new() };
        format!("order auto is {order}: two states for each of the {modes} modes{lines} over orders and halves")
    };

    /// The method does not choose an order: a fixed one is used.
    CR434 OrderIsFixed { method: String, order: usize }
    bears on (About::IdentifiedModels, Weight::None)
    decided "Order auto is a choice of era, n4sid, moesp and cva. Other methods take 4."
    means "Nothing says that this order is the right one for the record."
    remedy "name the orders to compare, e.g. --orders 2,4,6; for arx --arx-scan"
    says {
        let instead = if method == "arx" { "; --arx-scan compares structures" } else { "" };
        format!("{method}: order auto is not a choice of this method; {order} is used{instead}")
    };

    /// The record has no model to choose an order by: a fixed one is used.
    CR435 NoOrderChosen { method: String, reason: String, order: usize }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "Models of all orders are to be compared by the BIC of their simulation; the sentence says why there is \
             none."
    means "Nothing says that this order is the right one for the record."
    remedy "widen the window: --from, --to, lower --max-order, or name the orders: --orders"
    says format!("{method}: no order can be chosen ({reason}); {order} is used");

    /// Paths of several inputs and outputs share their poles.
    CR436 StatesOfPaths {
        poles: Option<usize>, lags: Option<usize>, outputs: Option<usize>, states: Option<usize>
    }
    bears on (About::IdentifiedModels, Weight::None)
    decided "A structure has one set of modes, so that all paths have one denominator. arx takes as many lags of all \
             outputs as make the order."
    means "The model may have more states than the order asked for, and the same pole several times."
    remedy "nothing; identify paths that are different systems in runs of their own"
    says match (poles.zip(*states), lags.zip(*outputs)) {
        (Some((poles, states)), _) => format!(
            "all paths share {poles} poles, each with a numerator of its own: the model has {states} states"
        ),
        (None, Some((lags, outputs))) => format!("{lags} lags of {outputs} outputs make {} states", lags * outputs),
        (None, None) => "one denominator for all paths, a numerator for each".to_owned(),
    };
}
