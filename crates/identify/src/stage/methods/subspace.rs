//! The subspace methods: an order, the order that the record asks for, and the stabilisation diagram.

use crumple_signal::Notes;
use crumple_stage::Output;
use crumple_sysid::{Horizon, HorizonModel, IdentifyError, IoData, SHORTEST_HORIZON, SubspaceSettings, Weighting};

use crate::stage::options::settings::{InputOutputSettings, Stabilisation};
use crate::stage::records::discrete::{DiscreteModel, RecordChoices};
use crate::stage::records::realization;
use crate::stage::waves::Record;

/// As a record is factorised by the settings of the stage.
fn settings(weighting: Weighting, input_output: &InputOutputSettings) -> SubspaceSettings {
    SubspaceSettings { weighting, thin: input_output.thin, block_rows: input_output.block_rows }
}

/// The number of states that the record asks for, and why in words.
pub fn chosen_order(
    weighting: Weighting,
    max_order: usize,
    data: (&IoData, &IoData),
    input_output: &InputOutputSettings,
) -> Result<(usize, Horizon, String), String> {
    let chosen = settings(weighting, input_output).choose_order(max_order, data).map_err(|error| error.to_string())?;
    let chosen = chosen.ok_or("no order has a model")?;
    let among = if chosen.by_unseen { ", among those that follow unseen samples as well as any" } else { "" };
    let why = format!(
        "order {} of 1 to {} has the smallest BIC of the simulation, with the effective number of samples{among}, in \
         models of one horizon of {} block rows",
        chosen.order, chosen.highest, chosen.horizon.block_rows
    );
    Ok((chosen.order, chosen.horizon, why))
}

/// The stabilisation diagram of a subspace method.
pub fn put_subspace_diagram(
    weighting: Weighting,
    max_order: usize,
    (record, data): (&Record, &IoData),
    input_output: &InputOutputSettings,
    wanted: &Stabilisation,
    out: &mut Output,
) -> anyhow::Result<()> {
    let method = weighting.name();
    match settings(weighting, input_output).order_scan(max_order, data) {
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

/// A subspace model of one order, with what was chosen for it in words.
pub fn identify_order(
    weighting: Weighting,
    order: usize,
    data: &IoData,
    input_output: &InputOutputSettings,
    chosen_by: Option<Horizon>,
) -> Result<DiscreteModel, IdentifyError> {
    let (m, q) = (data.inputs().len(), data.outputs().len());
    let found = settings(weighting, input_output).identify(order, data, chosen_by)?;
    let Horizon { every, block_rows } = found.horizon;
    let mut notes = Notes::new();
    if input_output.block_rows.is_none() {
        notes.info(horizon_in_words(&found));
    }
    let (excited, full) = found.excitation;
    if excited < full && !rests_for_half(data.inputs()) {
        notes.warning(format!(
            "the input excites {excited} of {full} directions only: it follows from its own past, so driven and free \
             motion cannot be separated and the poles are unreliable; use tfest, or --inputs none for a free motion"
        ));
    }
    if every > 1 {
        notes.info(format!(
            "the poles were found from every {every}th sample after a low-pass filter ({} samples of {:.4e} s), the \
             input matrix and the initial state from all samples: on the whole record the same block rows would span \
             too short a time",
            found.thin_samples,
            data.sample_time_s() * every as f64
        ));
    }
    if found.model.reflected_poles > 0 {
        notes.warning(format!(
            "{} unstable poles were mirrored into the unit circle so that the model can be simulated; arx with \
             --allow-unstable gives them as they are",
            found.model.reflected_poles
        ));
    }
    let choices = RecordChoices { thin: Some(every), lags: None, block_rows: Some(block_rows) };
    Ok(DiscreteModel {
        singular_values: found.singular_values,
        notes,
        choices,
        ..DiscreteModel::new(found.model.model, order * (m + q + 1) + m * q)
    })
}

/// Of which horizons a model has the one that simulates best.
fn horizon_in_words(found: &HorizonModel) -> String {
    let mut tried: Vec<String> = found.tried.iter().map(ToString::to_string).collect();
    if let Some(last) = tried.last_mut().filter(|_| found.of_choice) {
        last.push_str(" by which the order was chosen");
    }
    let why = match tried.len() {
        1 => format!("twice the order, {SHORTEST_HORIZON} at least"),
        _ => format!("of [{}] the one whose model simulates best", tried.join(", ")),
    };
    let lags =
        found.lags.map_or_else(String::new, |lags| format!("; a regression on the past needs {lags} lags by BIC"));
    format!("horizon of {} block rows: {why}{lags}", found.horizon.block_rows)
}
