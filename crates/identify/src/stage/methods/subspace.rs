//! The subspace methods: an order, the order that the record asks for, and the stabilisation diagram.

use crumple_signal::{About, Note, Notes, Weight, remarks};
use crumple_stage::Output;
use crumple_sysid::{Horizon, HorizonModel, IdentifyError, IoData, SHORTEST_HORIZON, SubspaceSettings, Weighting};

use crate::stage::options::settings::{InputOutputSettings, Stabilisation};
use crate::stage::records::discrete::{DiscreteModel, PartFailed, RecordChoices};
use crate::stage::records::realization;
use crate::stage::waves::Record;

/// As a record is factorised by the settings of the stage.
fn settings(weighting: Weighting, input_output: &InputOutputSettings) -> SubspaceSettings {
    SubspaceSettings { weighting, thin: input_output.thin, block_rows: input_output.block_rows }
}

/// The number of states that the record asks for, and why.
pub fn chosen_order(
    weighting: Weighting,
    max_order: usize,
    data: (&IoData, &IoData),
    input_output: &InputOutputSettings,
) -> Result<(usize, Horizon, Note), String> {
    let chosen = settings(weighting, input_output).choose_order(max_order, data).map_err(|error| error.to_string())?;
    let chosen = chosen.ok_or("no order has a model")?;
    let why = OrderChosen {
        order: chosen.order,
        highest: chosen.highest,
        unseen_samples: chosen.by_unseen.then(|| data.1.samples() - data.0.samples()),
        block_rows: chosen.horizon.block_rows,
    };
    Ok((chosen.order, chosen.horizon, why.into()))
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
        Err(error) => out.notes().push(PartFailed::diagram(method, &error)),
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
        notes.push(horizon(&found));
    }
    let (excited, full) = found.excitation;
    if excited < full && !rests_for_half(data.inputs()) {
        notes.push(PoorExcitation { excited, full });
    }
    if every > 1 {
        let interval_s = data.sample_time_s() * every as f64;
        notes.push(PolesOfThinned { every, samples: found.thin_samples, interval_s });
    }
    if found.model.reflected_poles > 0 {
        notes.push(PolesMirrored { poles: found.model.reflected_poles });
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
fn horizon(found: &HorizonModel) -> HorizonChosen {
    let mut tried: Vec<String> = found.tried.iter().map(ToString::to_string).collect();
    if let Some(last) = tried.last_mut().filter(|_| found.of_choice) {
        last.push_str(" by which the order was chosen");
    }
    let block_rows = found.horizon.block_rows;
    HorizonChosen { block_rows, tried, shortest: SHORTEST_HORIZON, lags: found.lags }
}

remarks! {
    /// Remarks of subspace methods.
    pub REMARKS;

    /// The order was chosen by the record.
    CR447 OrderChosen { order: usize, highest: usize, unseen_samples: Option<usize>, block_rows: usize }
    bears on (About::IdentifiedModels, Weight::None)
    decided "Models of all orders up to --max-order come from one factorisation. The smallest BIC of the simulation, \
             with the effective number of samples, decides."
    means "A higher order follows the record better, but by no more than its further numbers do by chance."
    remedy "nothing; --orders takes another number of states"
    says {
        let among = unseen_samples.map_or("", |_| ", among those that follow unseen samples as well as any");
        format!(
            "order {order} of 1 to {highest} has the smallest BIC of the simulation, with the effective number of \
             samples{among}, in models of one horizon of {block_rows} block rows"
        )
    };

    /// The horizon of a subspace model: how many block rows of past and of future it is made from.
    CR448 HorizonChosen { block_rows: usize, tried: Vec<String>, shortest: usize, lags: Option<usize> }
    bears on (About::IdentifiedModels, Weight::None)
    decided "Twice the order, 10 at least; and once and twice the lags that a regression on the past needs by BIC, 40 \
             at most (Bauer, Automatica 41, 2005; Peternell, Scherrer & Deistler, Signal Processing 52, 1996). The \
             model that simulates best is taken."
    means "A horizon that is too short loses slow and lightly damped modes."
    remedy "nothing; --block-rows takes another horizon"
    says {
        let why = match tried.len() {
            1 => format!("twice the order, {shortest} at least"),
            _ => format!("of [{}] the one whose model simulates best", tried.join(", ")),
        };
        let lags = lags.map_or_else(String::new, |n| format!("; a regression on the past needs {n} lags by BIC"));
        format!("horizon of {block_rows} block rows: {why}{lags}")
    };

    /// The input excites too little: it follows from its own past.
    CR449 PoorExcitation { excited: usize, full: usize }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "Singular values of past and future inputs below 1e-10 of the largest count as none. Inputs that rest for \
             half of the samples are exempt."
    means "Driven and free motion cannot be told apart. The poles are those of some model that explains the record."
    remedy "use tfest, or --inputs none where nothing drives the system"
    says format!(
        "the input excites {excited} of {full} directions only: it follows from its own past, so driven and free \
         motion cannot be separated and the poles are unreliable; use tfest, or --inputs none for a free motion"
    );

    /// The poles were found from every n-th sample.
    CR450 PolesOfThinned { every: usize, samples: usize, interval_s: f64 }
    bears on (About::IdentifiedModels, Weight::None)
    decided "--thin states it. Without it, as many samples are left out as the bandwidth of the waveforms leaves \
             unneeded."
    means "Modes above the new Nyquist frequency are not found. Input matrix and initial state use all samples."
    remedy "nothing; --thin 1 takes all samples"
    says format!(
        "the poles were found from every {every}th sample after a low-pass filter ({samples} samples of \
         {interval_s:.4e} s), the input matrix and the initial state from all samples: on the whole record the same \
         block rows would span too short a time"
    );

    /// Unstable poles were mirrored into the unit circle.
    CR451 PolesMirrored { poles: usize }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The model would grow by a factor of 1e8 or more over the record: a simulation keeps less than half of its \
             digits then. Poles z outside of the unit circle become 1/conj z."
    means "Their frequency is kept, but they decay as fast as they grew. The record may be of a plant in a loop, or \
           the order is too high."
    remedy "use --methods arx --allow-unstable for the poles as they are, or a lower order: --orders"
    says format!(
        "{poles} unstable poles were mirrored into the unit circle so that the model can be simulated; arx with \
         --allow-unstable gives them as they are"
    );
}
