//! Subspace models as a record asks for them: thinned, with a horizon and an order of their own choice.

use crumple_numerics::estimation::statistics::autoregressive_effective_samples;
use rayon::prelude::*;

use crate::data::{IoData, automatic_thinning, thinned};
use crate::error::IdentifyError;
use crate::order::{OrderPoles, subspace_order_scan};
use crate::simulation::fit::simulate_fitted;
use crate::subspace::{Horizons, Subspace, SubspaceModel, SubspaceOptions, Weighting, horizons};
use crate::validation::model_selection::{Contender, best_of_many, left_by_unseen, select, unseen_squares};

/// Block rows of past and future, at least.
pub const SHORTEST_HORIZON: usize = 10;

/// Samples that a thinned record keeps at least, in units of what its factorisation needs.
const KEPT: usize = 2;

/// Errors below this share of the root mean square of an output are rounding: models that are exact compare by their
/// parameters.
const ROUNDING: f64 = 1e-10;

/// What a subspace model is made by; `None`: what the record asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubspaceSettings {
    /// The method.
    pub weighting: Weighting,
    /// Poles are found from every so many samples.
    pub thin: Option<usize>,
    /// Block rows of past and of future.
    pub block_rows: Option<usize>,
}

/// How a record is factorised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Horizon {
    /// The poles are found from every so many samples.
    pub every: usize,
    /// Block rows of past and of future.
    pub block_rows: usize,
}

/// The number of states that a record asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChosenOrder {
    /// The order.
    pub order: usize,
    /// Orders from 1 up to this one were compared.
    pub highest: usize,
    /// The horizon of the models compared.
    pub horizon: Horizon,
    /// Whether only orders were compared that follow unseen samples as well as any.
    pub by_unseen: bool,
}

/// A subspace model of one order, from the horizon that simulates best.
#[derive(Debug, Clone)]
pub struct HorizonModel {
    /// Its horizon.
    pub horizon: Horizon,
    /// Samples that were factorised.
    pub thin_samples: usize,
    /// Horizons of which it is the best, in block rows; that by which the order was chosen is the last where
    /// `of_choice`.
    pub tried: Vec<usize>,
    /// Whether the horizon by which the order was chosen is among them.
    pub of_choice: bool,
    /// Lags of the regression that the horizons follow from.
    pub lags: Option<usize>,
    /// Singular values of the factorisation.
    pub singular_values: Vec<f64>,
    /// Independent directions of the input, of how many.
    pub excitation: (usize, usize),
    /// The model.
    pub model: SubspaceModel,
    /// Squares of the simulation errors over those of the outputs, summed over outputs.
    loss: f64,
}

impl SubspaceSettings {
    fn options(&self, block_rows: usize) -> SubspaceOptions {
        SubspaceOptions { weighting: self.weighting, block_rows, direct: true }
    }

    /// Every how many samples the poles are found from.
    fn thinning(&self, block_rows: usize, data: &IoData) -> usize {
        match (self.thin, self.block_rows) {
            (Some(every), _) => every,
            (None, Some(_)) => 1,
            (None, None) => {
                let needed = Subspace::needed(block_rows, data.inputs().len(), data.outputs().len());
                automatic_thinning(data, KEPT * needed)
            }
        }
    }

    /// Factorises the record, thinned as for its models, with a horizon for all orders up to `max_order`; `work` takes
    /// the factorisation, what was factorised, and the horizon.
    fn with_all_orders<T>(
        &self,
        max_order: usize,
        data: &IoData,
        work: impl FnOnce(&Subspace<'_>, &IoData, Horizon) -> T,
    ) -> Result<T, IdentifyError> {
        let shortest = max_order + 2;
        let every = self.thinning(self.block_rows.unwrap_or(shortest), data);
        let thin = if every > 1 { thinned(data, every)? } else { data.clone() };
        let block_rows =
            self.block_rows.or_else(|| horizons(&thin, shortest).block_rows.last().copied()).unwrap_or(shortest);
        let subspace = Subspace::new(&thin, self.options(block_rows))?;
        Ok(work(&subspace, &thin, Horizon { every, block_rows }))
    }

    /// Poles of all orders up to `max_order` for a stabilisation diagram, from as many samples as the models, with
    /// their sampling interval, s.
    pub fn order_scan(&self, max_order: usize, data: &IoData) -> Result<(Vec<OrderPoles>, f64), IdentifyError> {
        self.with_all_orders(max_order, data, |subspace, thin, _| {
            (subspace_order_scan(subspace, max_order), thin.sample_time_s())
        })
    }

    /// The number of states that the record asks for; `None`: no order has a model.
    ///
    /// The models compared come from one factorisation with a horizon for the highest order, which is returned too: the
    /// model that is made may choose it for its own, so it simulates no worse than the one that was compared. `data` is
    /// what models are identified from, `whole` the record with the samples that they do not see.
    pub fn choose_order(
        &self,
        max_order: usize,
        (data, whole): (&IoData, &IoData),
    ) -> Result<Option<ChosenOrder>, IdentifyError> {
        let (m, q) = (data.inputs().len(), data.outputs().len());
        // What is thinned by itself keeps enough samples.
        let kept = match self.thin {
            Some(every) => thinned(data, every)?.samples(),
            None => data.samples(),
        };
        // A short record has no room for the horizon of high orders.
        let room = |n: &usize| Subspace::needed(n + 2, m, q) <= kept;
        let highest = match self.block_rows {
            Some(given) => max_order.min((given.saturating_sub(1) * q).max(1)),
            None => (1..=max_order).rev().find(room).unwrap_or(1),
        };
        let (order, horizon) = self.with_all_orders(highest, data, |subspace, thin, horizon| {
            (automatic_order(subspace, thin.samples() < data.samples(), (data, whole), highest), horizon)
        })?;
        let by_unseen = whole.samples() > data.samples();
        Ok(order.map(|order| ChosenOrder { order, highest, horizon, by_unseen }))
    }

    /// A model of one order, from the horizon that simulates best: of those that the order and the record ask for, and
    /// of that by which the order was chosen, where it was.
    pub fn identify(
        &self,
        order: usize,
        data: &IoData,
        chosen_by: Option<Horizon>,
    ) -> Result<HorizonModel, IdentifyError> {
        let shortest = (2 * order).max(SHORTEST_HORIZON);
        let every = self.thinning(self.block_rows.unwrap_or(shortest), data);
        let thin = Thinned::new(data, every)?;
        let Horizons { block_rows: candidates, lags } = match self.block_rows {
            Some(given) => Horizons { block_rows: vec![given], lags: None },
            None => horizons(thin.samples(), shortest),
        };
        let other = chosen_by.filter(|other| {
            self.block_rows.is_none() && !(other.every == every && candidates.contains(&other.block_rows))
        });
        let mut results: Vec<Result<HorizonModel, IdentifyError>> =
            candidates.iter().map(|&block_rows| thin.identify(self.options(block_rows), order)).collect();
        if let Some(Horizon { every, block_rows }) = other {
            let options = self.options(block_rows);
            results.push(Thinned::new(data, every).and_then(|thin| thin.identify(options, order)));
        }
        // The first of several that simulate alike; if none leads to a model, why the shortest does not.
        let best = results.into_iter().reduce(|best, next| if loss_of(&next) < loss_of(&best) { next } else { best });
        let best = best.ok_or(IdentifyError::OrderZero)??;
        let tried = candidates.into_iter().chain(other.map(|other| other.block_rows)).collect();
        Ok(HorizonModel { tried, of_choice: other.is_some(), lags, ..best })
    }
}

/// A record and every n-th sample of it.
struct Thinned<'a> {
    whole: &'a IoData,
    every: usize,
    thin: Option<IoData>,
}

impl<'a> Thinned<'a> {
    fn new(whole: &'a IoData, every: usize) -> Result<Self, IdentifyError> {
        let thin = if every > 1 { Some(thinned(whole, every)?) } else { None };
        Ok(Self { whole, every, thin })
    }

    /// What is factorised.
    fn samples(&self) -> &IoData {
        self.thin.as_ref().unwrap_or(self.whole)
    }

    fn identify(&self, options: SubspaceOptions, order: usize) -> Result<HorizonModel, IdentifyError> {
        let data = self.whole;
        let subspace = Subspace::new(self.samples(), options)?;
        let model = if self.thin.is_some() { subspace.realize_on(order, data)? } else { subspace.realize(order)? };
        let (simulated, _) = simulate_fitted(&model.model, data)?;
        let relative = |(y, yh): (&Vec<f64>, &Vec<f64>)| {
            let error: f64 = y.iter().zip(yh).map(|(y, yh)| (y - yh).powi(2)).sum();
            error / y.iter().map(|y| y * y).sum::<f64>().max(f64::MIN_POSITIVE)
        };
        let loss = data.outputs().iter().zip(&simulated).map(relative).sum();
        Ok(HorizonModel {
            horizon: Horizon { every: self.every, block_rows: options.block_rows },
            thin_samples: self.samples().samples(),
            tried: Vec::new(),
            of_choice: false,
            lags: None,
            singular_values: subspace.singular_values().to_vec(),
            excitation: subspace.excitation(),
            model,
            loss,
        })
    }
}

/// Infinite without a model.
fn loss_of(result: &Result<HorizonModel, IdentifyError>) -> f64 {
    result.as_ref().map_or(f64::INFINITY, |model| if model.loss.is_nan() { f64::INFINITY } else { model.loss })
}

/// The order from 1 to `highest` whose model has the smallest BIC of its simulation; `None` where no order has a model.
///
/// The models come from one factorisation, of the record or, if `thin`, of every n-th sample of it; all are simulated
/// on the record. Samples that the whole has beyond it are unseen, and orders that follow them worse than by chance are
/// left out ([`left_by_unseen`]). Criteria count the effective samples of the model with the smallest loss; of several
/// outputs the losses are multiplied. BIC asks for more than AICc where records are long, and finds the true order of
/// many samples.
fn automatic_order(
    subspace: &Subspace<'_>,
    thin: bool,
    (data, whole): (&IoData, &IoData),
    highest: usize,
) -> Option<usize> {
    let orders: Vec<usize> = (1..=highest.min(subspace.highest_order())).collect();
    let unseen = whole.slice(data.samples(), whole.samples()).ok();
    let all: Vec<Contender> =
        orders.par_iter().filter_map(|order| contender(subspace, thin, (data, unseen.as_ref()), *order).ok()).collect();
    let left: Vec<Contender> = left_by_unseen(&all, best_of_many(all.len())).into_iter().cloned().collect();
    match select(&left) {
        Some(selection) => left.iter().find(|c| c.id == selection.best_by_bic).map(|c| c.order),
        None => left.first().map(|c| c.order),
    }
}

fn contender(
    subspace: &Subspace<'_>,
    thin: bool,
    (data, unseen): (&IoData, Option<&IoData>),
    order: usize,
) -> Result<Contender, IdentifyError> {
    let candidate = if thin { subspace.realize_on(order, data)? } else { subspace.realize(order)? };
    let (simulated, _) = simulate_fitted(&candidate.model, data)?;
    let unseen_squares = match unseen {
        Some(unseen) => unseen_squares(unseen.outputs(), &simulate_fitted(&candidate.model, unseen)?.0),
        None => Vec::new(),
    };
    let (m, q) = (data.inputs().len(), data.outputs().len());
    let mut log_loss = 0.0;
    let mut effective = 0.0;
    for (measured, model) in data.outputs().iter().zip(&simulated) {
        let error: Vec<f64> = measured.iter().zip(model).map(|(y, yh)| y - yh).collect();
        let mean_square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64;
        let floor = (ROUNDING * ROUNDING * mean_square(measured)).max(f64::MIN_POSITIVE);
        let loss = mean_square(&error);
        if !loss.is_finite() {
            return Err(IdentifyError::NotConverged("simulation"));
        }
        log_loss += loss.max(floor).ln();
        effective += autoregressive_effective_samples(&error);
    }
    Ok(Contender {
        id: order.to_string(),
        parameters: order * (m + q + 1) + m * q,
        loss: (log_loss / q as f64).exp(),
        effective_samples: effective,
        validation_fit_percent: None,
        order,
        restarted_fit_percent: None,
        unseen_squares,
    })
}
