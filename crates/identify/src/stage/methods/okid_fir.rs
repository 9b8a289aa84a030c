//! The methods `okid` and `fir`: Markov parameters from an input and an output, then ERA.

use crumple_signal::Notes;
use crumple_sysid::{
    Era, EraOptions, FirOptions, IdentifyError, IoData, Lags, MarkovParameters, Okid, OkidOptions, OkidRealization,
    Order, fir, simulate_fitted,
};

use crate::stage::options::choices::OkidStates;
use crate::stage::options::settings::HankelSettings;
use crate::stage::records::discrete::{DiscreteModel, RecordChoices};

/// Lags that a criterion looks at, at most.
const HIGHEST_LAGS: usize = 40;

/// OKID of one order.
pub fn okid(order: usize, data: &IoData, settings: &HankelSettings) -> Result<DiscreteModel, IdentifyError> {
    // The criterion sees as many lags as a third of the samples determines.
    let width = data.inputs().len() + data.outputs().len();
    let highest = (data.samples() / (3 * width)).saturating_sub(1).clamp(1, HIGHEST_LAGS);
    let criterion = settings.lag_criterion.into();
    let lags = settings.lags.map_or(Lags::Best { highest, criterion }, Lags::Given);
    let okid = Okid::new(data, OkidOptions::new(lags))?;
    let mut notes = Notes::new();
    notes.info(if okid.scan.is_empty() {
        format!("observer of {} lags, as given", okid.lags)
    } else {
        format!("observer of {} lags, the best of 1 to {} by {}", okid.lags, okid.scan.len(), settings.lag_criterion)
    });
    if okid.lags == okid.scan.len() {
        notes.warning(
            "the criterion chose the largest number of lags it was offered; more may fit better, give \
            --lags",
        );
    }
    let deficient = okid.rank < okid.regressors;
    if deficient {
        notes.info(format!(
            "the regression has rank {} of {}: collinear signals, or no noise; states are chosen from the system alone",
            okid.rank, okid.regressors
        ));
    }
    let jointly = settings.okid_states == OkidStates::Joint && !deficient;
    let options = OkidRealization { jointly, ..OkidRealization::default() };
    let realized = okid.realize(Order::Given(order), options)?;
    let predictor = realized.predictor()?;
    let seen: Vec<Vec<f64>> = data.inputs().iter().chain(data.outputs()).cloned().collect();
    let seen = IoData::new(seen, data.outputs().to_vec(), data.sample_time_s())?;
    let predicted = if predictor.poles()?.iter().all(|z| z.norm() < 1.0) {
        simulate_fitted(&predictor, &seen)?.0
    } else {
        notes.warning(
            "the predictor with the Kalman gain is unstable: the model has too few states for this observer; \
            raise --orders",
        );
        Vec::new()
    };
    Ok(DiscreteModel {
        predicted,
        singular_values: realized.singular_values.iter().map(|(s, _)| *s).collect(),
        notes,
        other_models: vec![("predictor", predictor)],
        choices: RecordChoices { lags: Some(okid.lags), ..RecordChoices::default() },
        ..DiscreteModel::new(realized.model, order * (width + 1) + data.inputs().len() * data.outputs().len())
    })
}

/// ERA of one order on the regularised impulse response.
pub fn impulse_response(
    order: usize,
    data: &IoData,
    settings: &HankelSettings,
    at_rest: bool,
) -> Result<DiscreteModel, IdentifyError> {
    // Without rest the first taps only serve as past.
    let taps = if at_rest { settings.taps.min(data.samples()) } else { settings.taps.min(data.samples() / 3).max(1) };
    let kernel = settings.kernel.into();
    let response = fir(data, FirOptions { taps, kernel, at_rest })?;
    let markov = MarkovParameters::new(response.sequences.iter().map(Vec::as_slice).collect(), data.inputs().len())?;
    let options = EraOptions { shift: settings.shift_form.into(), ..EraOptions::new(data.sample_time_s()) };
    let order = Order::Given(order);
    let model = Era::from_markov(markov, options, &[order])?.realize(order)?;
    let start = if at_rest { "from rest" } else { "the first of them as past only" };
    let mut notes = Notes::new();
    notes.info(format!("impulse response of {taps} samples, kernel {}, {start}", settings.kernel));
    if taps < settings.taps {
        notes.info(format!("the record is too short for {} taps", settings.taps));
    }
    if let Some(chosen) = response.hyperparameters.first().copied().flatten() {
        notes.info(format!(
            "decay {:.4} per sample, correlation of neighbours {:.4}, {:.1} effective parameters",
            chosen.decay, chosen.likeness, chosen.effective_parameters
        ));
    }
    let last = response.sequences.iter().map(|h| h.last().map_or(0.0, |x| x.abs())).fold(0.0, f64::max);
    let largest = response.sequences.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    if last > 0.05 * largest {
        notes.warning(format!("the impulse response has not died out after {taps} samples; take more --taps, or okid"));
    }
    let (m, q) = (data.inputs().len(), data.outputs().len());
    let parameters = model.order() * (m + q + 1) + m * q;
    Ok(DiscreteModel {
        singular_values: model.singular_values.clone(),
        notes,
        ..DiscreteModel::new(model.discrete, parameters)
    })
}
