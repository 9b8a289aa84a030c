//! The minima of a search, fitted as measured: explanations of the record, and pairs of dual double models.

use crumple_lumped::{DoubleSpringMassDamper, Model};
use crumple_signal::Notes;
use rayon::prelude::*;

use crate::fit::as_measured::{dual_of, exchanged, is_own_dual};
use crate::fit::descents::{AS_GOOD, REPORTED};
use crate::solvers::fitting::{FitStart, Fitting};
use crate::{Candidate, FitQuantity, Minimum, RESOLUTION_M};

/// Error of a displacement integrated twice by the trapezoidal rule at 10 kHz, m: that of known records is at most
/// 1.3e-6 m. Minima of the motion itself whose errors differ by less are not told apart.
const DISPLACEMENT_RESOLUTION_M: f64 = 1.3e-6;
/// Two sets whose parameters all differ by less than this share are one.
const SAME: f64 = 1e-3;

/// Where the searches of a fit ended, least error first, and what every candidate has to say.
pub(super) struct Ends<'a> {
    /// The starts of the fit, each with its root mean square error on the motion itself, in the unit of the first wave.
    pub starts: Vec<(FitStart, f64)>,
    /// Where the search leads from the dual of the best double model, if that is none of them.
    pub from_dual: Option<FitStart>,
    /// Notes of every candidate.
    pub remarks: &'a [String],
}

impl Ends<'_> {
    /// Those as good as the best: within 1 %, and `resolution`.
    fn as_good(&self, resolution: f64) -> Vec<&FitStart> {
        let best = self.starts.first().map_or(0.0, |(_, error)| *error);
        let good = self.starts.iter().filter(|(_, error)| *error <= AS_GOOD * best + resolution);
        good.map(|(start, _)| start).collect()
    }
}

/// Every minimum as good as the best, at most three, fitted as measured with the weights of the first.
///
/// For the double model with a sensor on the chassis also the minimum that is found from the dual of the best: the
/// second sensor tells the two apart, and the notes say by how much.
pub(super) fn explanations(mut fitting: Fitting<'_>, ends: &Ends<'_>, notes: &mut Notes) -> Vec<Candidate> {
    let kind = fitting.task.model;
    let mut starts: Vec<FitStart> = ends.as_good(0.0).into_iter().cloned().collect();
    if starts.len() > 1 {
        notes.warning(format!(
            "{kind}: {} parameter sets fit within 1 % as well as the best; the record does not determine the \
             parameters",
            starts.len()
        ));
        starts.truncate(REPORTED);
    }
    let Some(best) = starts.first().and_then(|start| fitting.weighed_minimum(start)) else { return Vec::new() };
    let others: Vec<Option<Minimum>> = starts[1..].par_iter().map(|start| fitting.minimum(start)).collect();
    let mut fits: Vec<(FitStart, Minimum, Vec<String>)> = Vec::new();
    for (start, minimum) in starts.iter().zip(std::iter::once(Some(best.clone())).chain(others)) {
        let Some(minimum) = minimum else { continue };
        if fits.iter().any(|(_, other, _)| near(&minimum.model, &other.model, SAME)) {
            notes.info(format!("{kind}: a further set is left out, as measured it is the same as an earlier one"));
            continue;
        }
        fits.push((start.clone(), minimum, ends.remarks.to_vec()));
    }
    if let Model::DoubleSpringMassDamper(model) = best.model {
        if let Some(misfit) = fitting.observed.misfit(&Model::DoubleSpringMassDamper(model.dual())) {
            let text = format!(
                "the dual model moves the compartment alike, but not the chassis: it misses by {}, this one by {}; the \
                 second sensor decides, and the two are not equivalent",
                fitting.errors(&misfit),
                fitting.errors(&best.misfit_m)
            );
            notes.info(format!("{kind}: {text}"));
            fits[0].2.push(text);
        }
        // Where the dual leads if it is followed: the second best explanation.
        let followed = ends.from_dual.as_ref().and_then(|start| Some((start, fitting.minimum(start)?)));
        let apart = |minimum: &Minimum| fits.iter().all(|(_, other, _)| !near(&minimum.model, &other.model, SAME));
        if let Some((start, followed)) = followed.filter(|(_, followed)| apart(followed)) {
            let text = format!(
                "followed from the dual of the first: weighted error {:.3} times that of the first, not equivalent",
                followed.rmse_m() / best.rmse_m().max(f64::MIN_POSITIVE)
            );
            fits.push((start.clone(), followed, [ends.remarks, &[text]].concat()));
        }
    }
    let numbered = fits.into_iter().zip(1..);
    numbered.map(|((start, minimum, remarks), k)| fitting.candidate(&start, minimum, k, &remarks)).collect()
}

/// The double model with sensors on the compartment alone: every minimum as good as the best, at most three, each with
/// its dual, which fits equally, the softer front spring first.
///
/// The two candidates of a pair are numbered `2 k + 1` and `2 k + 2` and name each other as equivalent. A model that
/// is its own dual is one candidate: front and rear can move against each other there without a change of the record
/// in first order.
pub(super) fn pairs(mut fitting: Fitting<'_>, ends: &Ends<'_>, notes: &mut Notes) -> Vec<Candidate> {
    let kind = fitting.task.model;
    notes.info(format!(
        "{kind}: one compartment accelerometer cannot tell its two dual solutions apart, a second one on the front can"
    ));
    let of_displacement = fitting.observed.waves[0].quantity == FitQuantity::Displacement;
    let starts = ends.as_good(if of_displacement { DISPLACEMENT_RESOLUTION_M } else { 0.0 });
    let starts = &starts[..starts.len().min(REPORTED)];
    let Some(best) = starts.first().and_then(|start| fitting.weighed_minimum(start)) else { return Vec::new() };
    let others: Vec<Option<Minimum>> = starts[1..].par_iter().map(|start| fitting.minimum(start)).collect();
    let all = starts.iter().zip(std::iter::once(Some(best)).chain(others));
    let mut fits: Vec<(&FitStart, Minimum)> = all.filter_map(|(start, minimum)| Some((*start, minimum?))).collect();
    fits.sort_by(|(_, a), (_, b)| a.rmse_m().total_cmp(&b.rmse_m()));
    let least = fits[0].1.rmse_m();
    let mut kept: Vec<(&FitStart, Minimum)> = Vec::new();
    for (start, minimum) in fits {
        let known = kept.iter().any(|(_, other)| same_pair(&minimum.model, &other.model));
        let resolution = match (of_displacement, fitting.observed.is_as_measured()) {
            (false, _) => 0.0,
            (true, true) => RESOLUTION_M,
            (true, false) => DISPLACEMENT_RESOLUTION_M,
        };
        if minimum.rmse_m() <= AS_GOOD * least + resolution && !known {
            kept.push((start, minimum));
        }
    }
    if kept.len() > 1 {
        notes.warning(format!(
            "{kind}: {} pairs of parameter sets fit equally well within the accuracy of the record; it does not \
             determine the parameters",
            kept.len()
        ));
    }
    let mut candidates = Vec::new();
    for (start, minimum) in kept {
        let index = candidates.len() + 1;
        let Model::DoubleSpringMassDamper(model) = minimum.model else { continue };
        if is_own_dual(&start.model) || is_own_dual(&minimum.model) {
            let text = "its own dual, listed once, counts twice: front and rear can move against each other without a \
                change of the record in first order";
            let remarks = [ends.remarks, &[text.to_owned()]].concat();
            candidates.push(fitting.candidate(start, minimum, index, &remarks));
            continue;
        }
        let on_bound = start.on_bound.iter().map(|name| exchanged(name)).collect();
        let start_of_dual = FitStart { on_bound, ..start.clone() };
        let dual = dual_of(&minimum, &model.dual());
        let mut pair: Vec<(&FitStart, Minimum)> = vec![(start, minimum)];
        pair.extend(dual.map(|minimum| (&start_of_dual, minimum)));
        if let [(_, a), (_, b)] = &pair[..]
            && front_spring(&b.model) < front_spring(&a.model)
        {
            pair.reverse();
        }
        let is_pair = pair.len() == 2;
        for (k, (start, minimum)) in pair.into_iter().enumerate() {
            let candidate = fitting.candidate(start, minimum, index + k, ends.remarks);
            candidates.push(Candidate { equivalent_to: is_pair.then_some(index + 1 - k), ..candidate });
        }
    }
    candidates
}

fn front_spring(model: &Model) -> f64 {
    model.parameters().get("k1_n_per_m").copied().unwrap_or(0.0)
}

/// Whether all parameters agree to this share.
fn near(a: &Model, b: &Model, share: f64) -> bool {
    let others = b.parameters();
    a.parameters()
        .iter()
        .all(|(name, value)| (value - others[name]).abs() <= share * value.abs().max(others[name].abs()))
}

/// Whether two double models, or one and the dual of the other, are one.
fn same_pair(a: &Model, b: &Model) -> bool {
    let dual = |model: &DoubleSpringMassDamper| Model::DoubleSpringMassDamper(model.dual());
    near(a, b, SAME) || matches!(a, Model::DoubleSpringMassDamper(a) if near(&dual(a), b, SAME))
}
