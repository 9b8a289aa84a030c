//! The choice: which candidate is for prediction, which is the simplest, which follows the record closest.
//!
//! Evidence is Akaike's criterion of misfits as measured, with one number of independent samples for all: for a known
//! level of noise where that before the event explains the least misfit, else corrected for short records. Prior
//! knowledge adds squared terms. Differences below 2 say nothing, above 10 they decide (Burnham & Anderson 2002,
//! section 2.6): no percent of fit overrules them.

use std::cmp::Ordering;

use crate::selection::compared::{ComparedCandidate, EnergyClass, Inadequacy, Prior, SelectionRules};
use crate::selection::rating::{ComparedRecord, Rated, rate_all};

/// Criteria that differ by less are equal: among them the fewest parameters.
const EQUAL: f64 = 2.0;
/// Criteria that differ by more decide.
const DECISIVE: f64 = 10.0;
/// Fits that differ by less, percentage points, are the same, as they are said: no sensor decides between them.
const FIT_STEP: f64 = 0.01;
/// Misfits of the wall's force by models of as many masses that differ by less are alike: half of the force that one
/// mass misses is that of the masses in front, whatever its curve.
const FORCE_RATIO: f64 = 1.4;

/// A name of the choice: a candidate, or none, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Place of the candidate among those given.
    pub candidate: Option<usize>,
    /// Why, in one sentence.
    pub because: String,
}

/// How the evidence for the recommended candidate stands to that for the best of another model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strength {
    /// Criteria differ by 10 at most.
    Weak,
    /// The criterion is lower by more than 10.
    Decisive,
    /// The criterion of the other is lower by more than 10: the recommended one is right at lower speeds.
    Contrary,
}

/// The three names, and all that was counted for them.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateSelection {
    /// For prediction.
    pub recommended: Choice,
    /// The evidence beside the best of another model, and the place of that; `None`: no other qualifies, or none is
    /// recommended.
    pub strength: Option<(Strength, usize)>,
    /// Fewest parameters, all of them determined.
    pub simplest: Choice,
    /// Closest to the record.
    pub closest: Choice,
    /// In the order of the candidates.
    pub rated: Vec<Rated>,
    /// Independent samples that all were compared with; `None`: none is adequate.
    pub samples: Option<f64>,
    /// Priors in use.
    pub priors: Vec<Prior>,
}

/// Chooses among candidates of which none is the dual of another: the same model twice is one.
///
/// *Adequate*: physical, no parameter on a bound of its search, a displacement fit of at least
/// [`SelectionRules::adequate_fit_percent`], and the events of its own test: it stops, with the dynamic crush, the time
/// and the restitution of the test within the limits of the rules. Where none of these is recommended, those that miss
/// only time or restitution take part too. *Recommended*: of the adequate whose numbers the record determines as far
/// as they are felt at other speeds, and whose wall force is within its limit, the lowest criterion with priors; within
/// 2 of it, of models that are not plastic within 10, the fewest parameters; where the lowest of all is plastic, of the
/// plastic ones. One with open numbers that are felt, not more than half of its numbers, qualifies too
/// where its criterion is lower than all of those by more than 10, and the lowest with priors: the record itself speaks
/// against them. Where that is a plastic structure, the plastic one with the fewest parameters that
/// has the record's own crush at lower speeds ([`crate::Evaluation::crush_error_at_lower_speeds`]).
/// *Simplest*: of the adequate with all numbers determined the fewest, then the lowest criterion. *Closest*: of the
/// physical the best displacement fit.
pub fn choose(candidates: &[ComparedCandidate], record: &ComparedRecord, rules: &SelectionRules) -> CandidateSelection {
    let adequate = selection(candidates, record, rules, <[Inadequacy]>::is_empty);
    if adequate.recommended.candidate.is_some() {
        return adequate;
    }
    let with_the_crush = |reasons: &[Inadequacy]| reasons.iter().all(Inadequacy::leaves_the_crush);
    let of_crush = selection(candidates, record, rules, with_the_crush);
    if of_crush.recommended.candidate.is_none() {
        return adequate;
    }
    CandidateSelection { simplest: adequate.simplest, closest: adequate.closest, ..of_crush }
}

/// The choice among candidates whose inadequacies let them take part.
fn selection(
    candidates: &[ComparedCandidate],
    record: &ComparedRecord,
    rules: &SelectionRules,
    takes_part: fn(&[Inadequacy]) -> bool,
) -> CandidateSelection {
    let (rated, samples, is_noise_known) = rate_all(candidates, record, rules, takes_part);
    let all = ComparedCandidates { candidates, rated: &rated, rules, is_noise_known };
    let (recommended, simplest, closest) = (all.recommended(samples), all.simplest(), all.closest());
    let strength = recommended.candidate.and_then(|best| all.strength(best));
    let priors = rules.priors(record.restitution);
    CandidateSelection { recommended, strength, simplest, closest, rated, samples, priors }
}

/// All that the three names are chosen from.
struct ComparedCandidates<'a> {
    candidates: &'a [ComparedCandidate],
    rated: &'a [Rated],
    rules: &'a SelectionRules,
    /// Whether the noise before the event explains the best misfit.
    is_noise_known: bool,
}

impl ComparedCandidates<'_> {
    fn none(because: impl Into<String>) -> Choice {
        Choice { candidate: None, because: because.into() }
    }

    /// Those that take part in the choice.
    fn compared(&self) -> impl Iterator<Item = usize> {
        (0..self.candidates.len()).filter(|k| self.rated[*k].is_compared)
    }

    fn is_plastic(&self, k: usize) -> bool {
        self.candidates[k].class == EnergyClass::Plastic
    }

    /// The criterion with priors above the lowest; `None`: too few samples for its numbers, it has no criterion.
    fn total(&self, k: usize) -> Option<f64> {
        self.rated[k].difference_with_priors
    }

    /// The lowest criterion with priors first, then those without one.
    fn by_total(&self, a: usize, b: usize) -> Ordering {
        match (self.total(a), self.total(b)) {
            (Some(a), Some(b)) => a.total_cmp(&b),
            (a, b) => a.is_none().cmp(&b.is_none()),
        }
    }

    /// How much the criterion with priors of `b` is above that of `a`; `None` where one has none.
    fn gap(&self, a: usize, b: usize) -> Option<f64> {
        Some(self.total(b)? - self.total(a)?)
    }

    /// Why an adequate candidate is not for prediction.
    fn not_for_prediction(&self, k: usize) -> Option<String> {
        if self.rated[k].aicc.is_none() {
            return Some(format!("{} free numbers are too many for this record", self.candidates[k].parameters));
        }
        self.predicts_wrongly(k)
    }

    /// Why an adequate candidate is not for prediction beside others that are, whatever its criterion.
    fn predicts_wrongly(&self, k: usize) -> Option<String> {
        let candidate = &self.candidates[k];
        if !candidate.affects_other_speeds.is_empty() {
            let (open, of) = (candidate.affects_other_speeds.len(), candidate.parameters);
            return Some(format!("{open} of its {of} numbers are not determined and felt at other speeds"));
        }
        self.misses_the_force(k)
    }

    /// Whether a candidate with open numbers that are felt, not more than half of all unless the noise is known, has a
    /// criterion lower than all of `others` by more than [`DECISIVE`], and the lowest with priors too.
    fn decides(&self, k: usize, others: &[usize]) -> bool {
        let candidate = &self.candidates[k];
        let difference = |other: usize| Some(self.rated[other].aicc? - self.rated[k].aicc?);
        (self.is_noise_known || 2 * candidate.affects_other_speeds.len() <= candidate.parameters)
            && others.iter().all(|other| difference(*other).is_some_and(|above| above > DECISIVE))
            && others.iter().all(|other| self.gap(k, *other).is_some_and(|above| above > 0.0))
            && self.misses_the_force(k).is_none()
    }

    fn misses_the_force(&self, k: usize) -> Option<String> {
        let candidate = &self.candidates[k];
        let force = candidate.force_misfit_percent.filter(|force| *force > self.force_limit_percent(candidate.masses));
        force.map(|force| format!("it misses the force on the wall by {force:.0} %"))
    }

    /// Largest misfit of the wall's force, percent, up to which a candidate with so many masses is for prediction: that
    /// of the rules; where the best of the adequate with as many masses is within it, [`FORCE_RATIO`] times that one's.
    /// What masses in front of a compartment push on the wall, no model without them has.
    fn force_limit_percent(&self, masses: usize) -> f64 {
        let alike = self.compared().map(|k| &self.candidates[k]).filter(|candidate| candidate.masses == masses);
        let least = alike.filter_map(|candidate| candidate.force_misfit_percent).fold(f64::INFINITY, f64::min);
        let limit = self.rules.force_limit_percent;
        if least <= limit { limit.max(FORCE_RATIO * least) } else { limit }
    }

    /// The candidate with the lowest criterion with priors of those that do not miss the force on the wall.
    fn lowest(&self) -> Option<usize> {
        let may_decide = |k: &usize| self.rated[*k].aicc.is_some() && self.misses_the_force(*k).is_none();
        self.compared().filter(may_decide).min_by(|a, b| self.by_total(*a, *b))
    }

    /// The candidates that may be recommended: those for prediction, and those that decide over them. Where the
    /// evidence is for a plastic model the plastic ones of these, so that an open knot of a curve does not hand the
    /// choice to a damped model; where there is none, [`plastic_with_fewest_open`](Self::plastic_with_fewest_open).
    fn qualified(&self) -> Vec<usize> {
        let mut qualified: Vec<usize> = self.compared().filter(|k| self.not_for_prediction(*k).is_none()).collect();
        if self.lowest().is_some_and(|k| self.is_plastic(k)) {
            qualified.retain(|k| self.is_plastic(*k));
        }
        if qualified.is_empty() {
            return self.plastic_with_fewest_open();
        }
        let decisive: Vec<usize> =
            self.compared().filter(|k| !qualified.contains(k) && self.decides(*k, &qualified)).collect();
        qualified.extend(decisive);
        qualified
    }

    /// The plastic candidates with a criterion that have the fewest open numbers; where the evidence is for another
    /// class, of those whose criterion is not decisively higher.
    fn plastic_with_fewest_open(&self) -> Vec<usize> {
        let Some(lowest) = self.lowest() else { return Vec::new() };
        let is_near = |k: usize| self.is_plastic(lowest) || self.gap(lowest, k).is_some_and(|above| above <= DECISIVE);
        let may_decide = |k: &usize| is_near(*k) && self.misses_the_force(*k).is_none();
        let plastic = || self.compared().filter(|k| self.is_plastic(*k) && self.rated[*k].aicc.is_some());
        let open = |k: usize| self.candidates[k].affects_other_speeds.len();
        let fewest = plastic().filter(may_decide).map(open).min();
        plastic().filter(may_decide).filter(|k| Some(open(*k)) == fewest).collect()
    }

    fn recommended(&self, samples: Option<f64>) -> Choice {
        let Some(samples) = samples else { return Self::none(self.why_none_is_adequate()) };
        let qualified = self.qualified();
        if qualified.is_empty() {
            let reasons: Vec<String> = self
                .compared()
                .filter_map(|k| Some(format!("{}: {}", self.candidates[k].id, self.not_for_prediction(k)?)))
                .collect();
            return Self::none(format!("no adequate candidate qualifies ({})", reasons.join("; ")));
        }
        let by_evidence = self.simplest_of_the_lowest(&qualified).unwrap_or(qualified[0]);
        let best = self.right_at_lower_speeds(by_evidence);
        let of_others = qualified.iter().copied().filter(|k| *k != best);
        let next = of_others.min_by(|a, b| self.by_total(*a, *b));
        let candidate = &self.candidates[best];
        let mut because = format!(
            "{}, {}{}, {}",
            candidate.class.name(),
            candidate.determined_in_words(),
            match (candidate.unidentified.len(), candidate.affects_other_speeds.len()) {
                (0, _) => String::new(),
                (_, 0) => " and hardly felt at other speeds".to_owned(),
                (_, felt) => format!(" ({felt} felt at other speeds)"),
            },
            match next {
                _ if best != by_evidence => self.beside_the_evidence(best, by_evidence),
                Some(next) => self.beside_the_next(best, next),
                None if self.rated[best].is_adequate() => "the only adequate candidate that qualifies".to_owned(),
                None => "the only candidate with the crush of the test that qualifies".to_owned(),
            }
        );
        let noise = if self.is_noise_known { ", known noise" } else { "" };
        if let Some(missed) = self.rated[best].why_inadequate() {
            because.push_str(&format!("; use only its crush: it {missed}"));
        }
        because.push_str(&format!(" (criterion as measured, with priors; {samples:.0} independent samples{noise})"));
        let passed_over = self
            .compared()
            .filter_map(|k| Some((k, self.gap(k, best).filter(|better| *better > 0.0)?, self.not_for_prediction(k)?)))
            .min_by(|(a, ..), (b, ..)| self.by_total(*a, *b));
        if let Some((k, better, why)) = passed_over {
            let id = &self.candidates[k].id;
            because.push_str(&format!("; {id} stands {better:.1} lower, but {why}"));
        }
        Choice { candidate: Some(best), because }
    }

    /// Of the candidates with nearly the lowest criterion the one with the fewest numbers. Nearly is within 2; of
    /// candidates that are not plastic within 10, for weak evidence prefers the simpler: a ring of the sensor gives
    /// that much. Knots of a curve are chosen by the crush at lower speeds.
    fn simplest_of_the_lowest(&self, qualified: &[usize]) -> Option<usize> {
        let lowest = qualified.iter().copied().min_by(|a, b| self.by_total(*a, *b))?;
        let margin = |k: usize| if self.is_plastic(k) || self.is_plastic(lowest) { EQUAL } else { DECISIVE };
        let is_near = |k: &usize| self.gap(lowest, *k).is_some_and(|above| above <= margin(*k));
        let near = qualified.iter().copied().filter(is_near);
        near.min_by(|a, b| self.by_parameters(*a, *b))
    }

    /// The plastic candidate for prediction where the evidence is for a plastic one: that one, if it has the record's
    /// own crush at lower speeds; else of those that have it, or come nearest to it, the one with the fewest numbers.
    ///
    /// The criterion charges knots of a curve as if they were to be told from noise. But the curve of a plastic
    /// structure is an integral of the record, known to what the sensor is; a knot that is open beside others is no
    /// reason against it.
    fn right_at_lower_speeds(&self, by_evidence: usize) -> usize {
        let error = |k: usize| self.candidates[k].crush_error_at_lower_speeds;
        let limit = self.rules.lower_speed_limit_percent / 100.0;
        let missed = error(by_evidence).filter(|error| self.is_plastic(by_evidence) && *error > limit);
        let Some(missed) = missed else { return by_evidence };
        let may_replace = |k: &usize| self.is_plastic(*k) && self.misses_the_force(*k).is_none();
        let plastic: Vec<(usize, f64)> =
            self.compared().filter(may_replace).filter_map(|k| Some((k, error(k)?))).collect();
        let least = plastic.iter().map(|(_, error)| *error).fold(missed, f64::min);
        // One that misses nearly as much is no reason to leave the evidence.
        if least > limit && least > 0.5 * missed {
            return by_evidence;
        }
        let near = plastic.into_iter().filter(|(_, error)| *error <= limit.max(least)).map(|(k, _)| k);
        near.min_by(|a, b| self.by_parameters(*a, *b)).unwrap_or(by_evidence)
    }

    /// How far both miss the crush at lower speeds that the record itself shows.
    fn beside_the_evidence(&self, best: usize, by_evidence: usize) -> String {
        let percent = |k: usize| 100.0 * self.candidates[k].crush_error_at_lower_speeds.unwrap_or(0.0);
        let id = &self.candidates[by_evidence].id;
        format!(
            "its crush at lower speeds is within {:.1} % of the record's own; {id} has a lower criterion but misses \
             it by {:.1} %",
            percent(best),
            percent(by_evidence)
        )
    }

    /// How the evidence for a recommended candidate stands to that for the best of another model that may be
    /// recommended; where none is for prediction, of all others. `None` where one of the two has no criterion.
    fn strength(&self, best: usize) -> Option<(Strength, usize)> {
        let qualified = self.qualified();
        let are_for_prediction = qualified.iter().any(|k| self.not_for_prediction(*k).is_none());
        let all = if are_for_prediction { qualified } else { self.compared().collect() };
        let of_others = all.into_iter().filter(|k| self.candidates[*k].model != self.candidates[best].model);
        let next = of_others.min_by(|a, b| self.by_total(*a, *b))?;
        let strength = match self.gap(best, next)? {
            gap if gap > DECISIVE => Strength::Decisive,
            gap if gap < -DECISIVE => Strength::Contrary,
            _ => Strength::Weak,
        };
        Some((strength, next))
    }

    /// How the criterion stands to that of the next.
    fn beside_the_next(&self, best: usize, next: usize) -> String {
        let (id, gap) = (&self.candidates[next].id, self.gap(best, next).unwrap_or(0.0));
        if gap.abs() < EQUAL {
            format!("equal to {id} within {EQUAL} and with no more numbers")
        } else if gap < 0.0 {
            format!("fewer parameters than {id}, whose criterion is only {:.1} lower: weak evidence", -gap)
        } else {
            let weight = if gap > DECISIVE { "decisive" } else { "weak" };
            format!("its criterion is {gap:.1} lower than for {id}: {weight} evidence")
        }
    }

    fn simplest(&self) -> Choice {
        let determined: Vec<usize> = self.compared().filter(|k| self.candidates[*k].unidentified.is_empty()).collect();
        let Some(simplest) = determined.iter().copied().min_by(|a, b| self.by_parameters(*a, *b)) else {
            return Self::none(match self.compared().count() {
                0 => self.why_none_is_adequate(),
                n => format!("each of the {n} adequate candidates has a number that the record does not determine"),
            });
        };
        let candidate = &self.candidates[simplest];
        let fit = candidate.fit_percent.unwrap_or(0.0);
        let count = match candidate.parameters {
            _ if candidate.order_of_magnitude > 0 || !candidate.is_assessed => candidate.determined_in_words(),
            1 => "one number, determined".to_owned(),
            n => format!("{n} numbers, all determined"),
        };
        Choice { candidate: Some(simplest), because: format!("{count}, displacement fit as measured {fit:.2} %") }
    }

    fn closest(&self) -> Choice {
        let step = |k: usize| self.candidates[k].fit_percent.map(|fit| (fit / FIT_STEP).round());
        let physical = (0..self.candidates.len()).filter(|k| self.candidates[*k].physical && step(*k).is_some());
        let closest = physical.min_by(|a, b| {
            step(*b).unwrap_or(0.0).total_cmp(&step(*a).unwrap_or(0.0)).then_with(|| self.by_parameters(*a, *b))
        });
        let Some(closest) = closest else { return Self::none("no physical candidate has a displacement to compare") };
        let candidate = &self.candidates[closest];
        let fit = candidate.fit_percent.unwrap_or(0.0);
        let (open, of) = (candidate.unidentified.len() + candidate.on_bound.len(), candidate.parameters);
        let open = if open == 0 { String::new() } else { format!("; {open} of its {of} numbers not determined") };
        let because = format!("best displacement fit of the physical candidates, {fit:.2} % as measured{open}");
        Choice { candidate: Some(closest), because }
    }

    /// Fewest numbers first, then the lowest criterion, then the order given.
    fn by_parameters(&self, a: usize, b: usize) -> Ordering {
        let count = |k: usize| self.candidates[k].parameters;
        count(a).cmp(&count(b)).then_with(|| self.by_total(a, b)).then_with(|| a.cmp(&b))
    }

    fn why_none_is_adequate(&self) -> String {
        if self.candidates.is_empty() {
            return "there is no candidate".to_owned();
        }
        let reason = |k: usize| self.rated[k].why_inadequate().map(|why| format!("{}: {why}", self.candidates[k].id));
        let reasons: Vec<String> = (0..self.candidates.len()).filter_map(reason).collect();
        format!("no candidate is adequate ({})", reasons.join("; "))
    }
}

#[cfg(test)]
mod tests;
