//! The discrete methods with an input: subspace, ARX, output error, and through Markov parameters OKID and FIR.

use crumple_stage::{Outcome, Output};
use crumple_sysid::{IdentifyError, IoData, Order, Weighting};

use crate::stage::methods::discrete::arx;
use crate::stage::methods::discrete::okid_fir::{impulse_response, okid};
use crate::stage::methods::discrete::output_error;
use crate::stage::methods::discrete::run::{MethodRun, ModelRequest};
use crate::stage::methods::discrete::subspace;
use crate::stage::methods::discrete::subspace::{Horizon, chosen_order, put_subspace_diagram};
use crate::stage::options::hankel::HankelSettings;
use crate::stage::options::input_output::InputOutputSettings;
use crate::stage::records::acceptance::mirror_growing_poles;
use crate::stage::records::discrete_model::DiscreteModel;
use crate::stage::records::results::Results;
use crate::stage::waves::Source;

/// The order where it is left to a method that does not choose one.
const AUTOMATIC_ORDER: usize = 4;

/// What to do about orders without a model.
const HINT: &str = "lower --orders, widen the window (--from, --to), or name other waveforms";

/// Why an order is tried that the record chose: the horizon of the models that were compared, and the comparison in
/// words.
type Choice = (Horizon, String);

/// One model per order.
pub fn run(method: &str, source: Source<'_>, results: &mut Results<'_>) -> anyhow::Result<Outcome> {
    let Some(input_output) = &source.settings.input_output else { return Ok(Outcome::Done) };
    let all = MethodRun::new(method, source, input_output, HINT)?;
    let weighting = Weighting::ALL.into_iter().find(|weighting| weighting.name() == method);
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
            Order::Automatic => {
                choose_order(method, weighting, source.settings.max_order, &all.data, input_output, results.out)
            }
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

/// The number of states where it is left to the method, told in a note, and why this one where the record chose it.
fn choose_order(
    method: &str,
    weighting: Option<Weighting>,
    max_order: usize,
    data: &IoData,
    input_output: &InputOutputSettings,
    out: &mut Output,
) -> (usize, Option<Choice>) {
    let Some(weighting) = weighting else {
        let instead = if method == "arx" { "; --arx-scan compares structures" } else { "" };
        out.notes()
            .info(format!("{method}: order auto is not a choice of this method; {AUTOMATIC_ORDER} is used{instead}"));
        return (AUTOMATIC_ORDER, None);
    };
    match chosen_order(weighting, max_order, data, input_output) {
        Ok((order, horizon, why)) => {
            out.notes().info(format!("{method}: {why}"));
            (order, Some((horizon, why)))
        }
        Err(reason) => {
            out.notes().warning(format!("{method}: no order can be chosen ({reason}); {AUTOMATIC_ORDER} is used"));
            (AUTOMATIC_ORDER, None)
        }
    }
}

/// A model of any record; `subspace` for the methods with a weighting.
fn identify(
    method: &str,
    subspace: Option<(Weighting, Option<Horizon>)>,
    order: usize,
    data: &IoData,
    input_output: &InputOutputSettings,
    hankel: Option<&HankelSettings>,
) -> Result<DiscreteModel, IdentifyError> {
    match (method, hankel) {
        ("okid", Some(hankel)) => okid(order, data, hankel),
        ("fir", Some(hankel)) => {
            mirror_growing_poles(impulse_response(order, data, hankel, input_output.initial == "zero")?, data)
        }
        ("arx", _) => arx::identify_order(order, data),
        ("output-error", _) => output_error::identify_order(order, data, input_output),
        _ => {
            let (weighting, compared) = subspace.unwrap_or((Weighting::N4sid, None));
            subspace::identify_order(weighting, order, data, input_output, compared)
        }
    }
}
