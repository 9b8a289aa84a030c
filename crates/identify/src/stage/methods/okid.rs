//! The method `okid`: Markov parameters from an input and an output, then ERA.

use crumple_signal::{About, Notes, Weight, remarks};
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
    let tried = okid.scan.len();
    let criterion = (tried > 0).then(|| settings.lag_criterion.to_string());
    notes.push(ObserverLags { lags: okid.lags, tried, criterion });
    if okid.lags == tried {
        notes.push(MostLags { lags: okid.lags });
    }
    if okid.rank < okid.regressors {
        notes.push(RankDeficient { rank: okid.rank, regressors: okid.regressors });
    }
    let realized = okid.realize(Order::Given(order))?;
    let predictor = realized.predictor()?;
    let seen: Vec<Vec<f64>> = data.inputs().iter().chain(data.outputs()).cloned().collect();
    let seen = IoData::new(seen, data.outputs().to_vec(), data.sample_time_s())?;
    let predicted = if predictor.poles()?.iter().all(|z| z.norm() < 1.0) {
        simulate_fitted(&predictor, &seen)?.0
    } else {
        notes.push(UnstablePredictor {});
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

remarks! {
    /// Remarks of okid.
    pub REMARKS;

    /// The number of past samples that the observer of okid sees.
    CR443 ObserverLags { lags: usize, tried: usize, criterion: Option<String> }
    bears on (About::IdentifiedModels, Weight::None)
    decided "--lags states it. Without it, the best of 1 to 40 by --lag-criterion, or as many as a third of the \
             samples determines."
    means "The Markov parameters follow from an observer of so many lags. Too few lags leave noise in the poles."
    remedy "nothing; --lags takes another number"
    says match criterion {
        None => format!("observer of {lags} lags, as given"),
        Some(criterion) => format!("observer of {lags} lags, the best of 1 to {tried} by {criterion}"),
    };

    /// The criterion chose the largest number of lags that was tried.
    CR444 MostLags { lags: usize }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The smallest criterion lies at the last of 1 to 40 lags, or of as many as a third of the samples \
             determines."
    means "The observer may see too little of the past. Damping ratios of slow modes suffer first."
    remedy "give a larger number: --lags, or a longer window: --from, --to"
    says "the criterion chose the largest number of lags it was offered; more may fit better, give --lags";

    /// The regression of okid does not determine all of its coefficients.
    CR445 RankDeficient { rank: usize, regressors: usize }
    bears on (About::IdentifiedModels, Weight::None)
    decided "The rank of the regression is below the number of its regressors."
    means "Signals depend on each other, or there is no noise at all. Of made records the model is exact nevertheless."
    remedy "nothing on a made record; else leave out signals that follow from others, or take fewer lags: --lags"
    says format!("the regression has rank {rank} of {regressors}: collinear signals, or no noise");

    /// The predictor of okid is unstable.
    CR446 UnstablePredictor {}
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "A pole of the model with its Kalman gain has a modulus of 1 or more."
    means "There is no one-step prediction, and no test of its errors. The simulation holds."
    remedy "raise --orders, or take fewer lags: --lags"
    says "the predictor with the Kalman gain is unstable: the model has too few states for this observer; raise \
          --orders";
}
