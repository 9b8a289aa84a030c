//! The method `okid`: Markov parameters from an input and an output, then ERA.

use crumple_signal::Notes;
use crumple_sysid::{IdentifyError, IoData, Lags, Okid, OkidOptions, Order, simulate_fitted};

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
    if okid.rank < okid.regressors {
        notes.info(format!(
            "the regression has rank {} of {}: collinear signals, or no noise",
            okid.rank, okid.regressors
        ));
    }
    let realized = okid.realize(Order::Given(order))?;
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
