//! The choice: which candidate is for prediction, which is the simplest, which follows the record closest.
//!
//! Evidence is Akaike's criterion of misfits as measured, with one number of independent samples for all: for a known
//! level of noise where that before the event explains the least misfit, else corrected for short records. Prior
//! knowledge adds squared terms. Differences below 2 say nothing, above 10 they decide (Burnham & Anderson 2002,
//! section 2.6): no percent of fit overrules them.

use std::cmp::Ordering;

use crate::selection::compared_candidate::{ComparedCandidate, EnergyClass};
use crate::selection::inadequacy::Inadequacy;
use crate::selection::prior::{Prior, SelectionRules};
use crate::selection::rating::{ComparedRecord, Rated, rate_all};

/// Criteria that differ by less are equal: among them the fewest parameters.
const EQUAL: f64 = 2.0;
/// Criteria that differ by more decide.
const DECISIVE: f64 = 10.0;
/// Fits that differ by less, percentage points, are the same: rounding does not decide.
const FIT_STEP: f64 = 1e-6;
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
/// has the record's own crush at lower speeds ([`crush_error_at_lower_speeds`](crate::crush_error_at_lower_speeds)).
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

    /// The criterion with priors above the lowest; infinite without one.
    fn total(&self, k: usize) -> f64 {
        self.rated[k].difference_with_priors.unwrap_or(f64::INFINITY)
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
        if !candidate.open_and_felt.is_empty() {
            let (open, of) = (candidate.open_and_felt.len(), candidate.parameters);
            return Some(format!("{open} of its {of} numbers are not determined and felt at other speeds"));
        }
        self.misses_the_force(k)
    }

    /// Whether a candidate with open numbers that are felt, not more than half of all unless the noise is known, has a
    /// criterion lower than all of `others` by more than [`DECISIVE`], and the lowest with priors too.
    fn decides(&self, k: usize, others: &[usize]) -> bool {
        let candidate = &self.candidates[k];
        let criterion = |k: usize| self.rated[k].aicc.unwrap_or(f64::INFINITY);
        (self.is_noise_known || 2 * candidate.open_and_felt.len() <= candidate.parameters)
            && others.iter().all(|other| criterion(k) + DECISIVE < criterion(*other))
            && others.iter().all(|other| self.total(k) < self.total(*other))
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
        self.compared().filter(may_decide).min_by(|a, b| self.total(*a).total_cmp(&self.total(*b)))
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
        let limit = if self.is_plastic(lowest) { f64::INFINITY } else { self.total(lowest) + DECISIVE };
        let may_decide = |k: &usize| self.total(*k) <= limit && self.misses_the_force(*k).is_none();
        let plastic = || self.compared().filter(|k| self.is_plastic(*k) && self.rated[*k].aicc.is_some());
        let open = |k: usize| self.candidates[k].open_and_felt.len();
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
        let next = of_others.min_by(|a, b| self.total(*a).total_cmp(&self.total(*b)));
        let candidate = &self.candidates[best];
        let mut because = format!(
            "{}, {}{}, {}",
            candidate.class.name(),
            candidate.determined_in_words(),
            match (candidate.open.len(), candidate.open_and_felt.len()) {
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
            because.push_str(&format!("; use its crush, not its rebound or time: it {missed}"));
        }
        because.push_str(&format!(" (evidence as measured with priors, {samples:.0} independent samples{noise})"));
        let passed_over = self
            .compared()
            .filter(|k| self.total(*k) < self.total(best))
            .filter_map(|k| Some((k, self.not_for_prediction(k)?)))
            .min_by(|(a, _), (b, _)| self.total(*a).total_cmp(&self.total(*b)));
        if let Some((k, why)) = passed_over {
            let (id, better) = (&self.candidates[k].id, self.total(best) - self.total(k));
            because.push_str(&format!("; {id} stands {better:.1} lower, but {why}"));
        }
        Choice { candidate: Some(best), because }
    }

    /// Of the candidates with nearly the lowest criterion the one with the fewest numbers. Nearly is within 2; of
    /// candidates that are not plastic within 10, for weak evidence prefers the simpler: a ring of the sensor gives
    /// that much. Knots of a curve are chosen by the crush at lower speeds.
    fn simplest_of_the_lowest(&self, qualified: &[usize]) -> Option<usize> {
        let lowest = qualified.iter().copied().min_by(|a, b| self.total(*a).total_cmp(&self.total(*b)))?;
        let margin = |k: usize| if self.is_plastic(k) || self.is_plastic(lowest) { EQUAL } else { DECISIVE };
        let near = qualified.iter().copied().filter(|k| self.total(*k) <= self.total(lowest) + margin(*k));
        near.min_by(|a, b| self.by_parameters(*a, *b))
    }

    /// The plastic candidate for prediction where the evidence is for a plastic one: that one, if it has the record's
    /// own crush at lower speeds; else of those that have it, or come nearest to it, the one with the fewest numbers.
    ///
    /// The criterion charges knots of a curve as if they were to be told from noise. But the curve of a plastic
    /// structure is an integral of the record, known to what the sensor is.
    fn right_at_lower_speeds(&self, by_evidence: usize) -> usize {
        let error = |k: usize| self.candidates[k].crush_error_at_lower_speeds.unwrap_or(f64::INFINITY);
        let limit = self.rules.lower_speed_limit_percent / 100.0;
        if !self.is_plastic(by_evidence) || error(by_evidence) <= limit {
            return by_evidence;
        }
        let plastic: Vec<usize> =
            self.compared().filter(|k| self.is_plastic(*k) && self.predicts_wrongly(*k).is_none()).collect();
        let least = plastic.iter().map(|k| error(*k)).fold(f64::INFINITY, f64::min);
        // One that misses nearly as much is no reason to leave the evidence.
        if least > limit && least > 0.5 * error(by_evidence) {
            return by_evidence;
        }
        let near = plastic.into_iter().filter(|k| error(*k) <= limit.max(least) && error(*k).is_finite());
        near.min_by(|a, b| self.by_parameters(*a, *b)).unwrap_or(by_evidence)
    }

    /// How far both miss the crush at lower speeds that the record itself shows.
    fn beside_the_evidence(&self, best: usize, by_evidence: usize) -> String {
        let percent = |k: usize| 100.0 * self.candidates[k].crush_error_at_lower_speeds.unwrap_or(f64::INFINITY);
        let id = &self.candidates[by_evidence].id;
        format!(
            "within {:.1} % of the crush at lower speeds that the energy over crush of the record shows, which {id}, \
             lower by its criterion, misses by {:.1} %",
            percent(best),
            percent(by_evidence)
        )
    }

    /// How the evidence for a recommended candidate stands to that for the best of another model that may be
    /// recommended; where none is for prediction, to the lowest of all.
    fn strength(&self, best: usize) -> Option<(Strength, usize)> {
        let qualified = self.qualified();
        let are_for_prediction = qualified.iter().any(|k| self.not_for_prediction(*k).is_none());
        let all = qualified.into_iter().chain(self.lowest().filter(|_| !are_for_prediction));
        let of_others = all.filter(|k| self.candidates[*k].model != self.candidates[best].model);
        let next = of_others.min_by(|a, b| self.total(*a).total_cmp(&self.total(*b)))?;
        let strength = match self.total(next) - self.total(best) {
            gap if gap > DECISIVE => Strength::Decisive,
            gap if gap < -DECISIVE => Strength::Contrary,
            _ => Strength::Weak,
        };
        Some((strength, next))
    }

    /// How the criterion stands to that of the next.
    fn beside_the_next(&self, best: usize, next: usize) -> String {
        let (id, gap) = (&self.candidates[next].id, self.total(next) - self.total(best));
        if gap.abs() < EQUAL {
            format!("equal to {id} within {EQUAL} and with no more numbers")
        } else if gap < 0.0 {
            format!("fewer numbers than {id}, whose criterion is {:.1} lower, which is weak", -gap)
        } else {
            let weight = if gap > DECISIVE { "decisive" } else { "weak" };
            format!("its criterion {gap:.1} below that of {id}, which is {weight}")
        }
    }

    fn simplest(&self) -> Choice {
        let determined: Vec<usize> = self.compared().filter(|k| self.candidates[*k].open.is_empty()).collect();
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
        let (open, of) = (candidate.open.len() + candidate.on_bound.len(), candidate.parameters);
        let open = if open == 0 { String::new() } else { format!("; {open} of its {of} numbers not determined") };
        let because = format!("displacement fit as measured {fit:.2} %, the best of a physical candidate{open}");
        Choice { candidate: Some(closest), because }
    }

    /// Fewest numbers first, then the lowest criterion, then the order given.
    fn by_parameters(&self, a: usize, b: usize) -> Ordering {
        let count = |k: usize| self.candidates[k].parameters;
        count(a).cmp(&count(b)).then_with(|| self.total(a).total_cmp(&self.total(b))).then_with(|| a.cmp(&b))
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
mod tests {
    use super::*;
    use crate::selection::compared_candidate::OwnTestErrors;
    use crate::selection::inadequacy::TestEvent;

    /// A misfit of noise of this size that is told apart from sample to sample.
    fn candidate(id: &str, class: EnergyClass, parameters: usize, misfit: f64) -> ComparedCandidate {
        let signs = [1.0, -1.0, -1.0, 1.0, 1.0, 1.0, -1.0, 1.0, -1.0, -1.0];
        let misfit: Vec<f64> = (0..40).map(|k| misfit * signs[k % 10]).collect();
        ComparedCandidate {
            id: id.to_owned(),
            model: id.to_owned(),
            class,
            masses: 1,
            parameters,
            is_assessed: true,
            open: Vec::new(),
            order_of_magnitude: 0,
            open_and_felt: Vec::new(),
            on_bound: Vec::new(),
            physical: true,
            slow_misfit: Some(misfit.clone()),
            fit_percent: Some(99.0 - misfit[0]),
            misfit: Some(misfit),
            restitution: Some(0.15),
            force_misfit_percent: None,
            own_test: OwnTestErrors { crush: Some(0.01), time: Some(0.01), restitution: Some(0.01) },
            crush_error_at_lower_speeds: (class == EnergyClass::Plastic).then_some(0.0),
        }
    }

    const RECORD: ComparedRecord =
        ComparedRecord { rms: 100.0, most_samples: 20.0, noise: None, restitution: Some(0.15) };

    fn ids(candidates: &[ComparedCandidate], rules: &SelectionRules) -> [Option<String>; 3] {
        let selection = choose(candidates, &RECORD, rules);
        [selection.recommended, selection.simplest, selection.closest]
            .map(|choice| choice.candidate.map(|k| candidates[k].id.clone()))
    }

    fn some(names: [&str; 3]) -> [Option<String>; 3] {
        names.map(|name| Some(name.to_owned()))
    }

    #[test]
    fn noise_that_is_known_gives_many_numbers_a_criterion() {
        let plastic = candidate("plastic", EnergyClass::Plastic, 2, 2.0);
        let many = candidate("many", EnergyClass::Damped, 12, 0.9);
        let record = |noise: Option<f64>| ComparedRecord { noise, ..RECORD };
        let choice = |noise| choose(&[plastic.clone(), many.clone()], &record(noise), &SelectionRules::default());
        // By misfits alone 12 numbers and their level are charged 87 for 20 samples, and gain 32.
        assert_eq!(choice(None).recommended.candidate, Some(0));
        // Of noise 1: 20 (4 - 0.81) = 64 are gained for 20 more, beyond the prior of 10; noise 0.4 does not explain it.
        let known = choice(Some(1.0));
        assert_eq!((known.recommended.candidate, known.samples), (Some(1), Some(20.0)));
        assert!((known.rated[1].aicc.unwrap() - (20.0 * 0.82 / 1.01 + 24.0)).abs() < 1e-9, "{:?}", known.rated);
        assert!(known.recommended.because.contains("known noise"), "{}", known.recommended.because);
        let unexplained = choice(Some(0.4)).recommended;
        assert_eq!((unexplained.candidate, unexplained.because.contains("known noise")), (Some(0), false));
    }

    #[test]
    fn a_damped_model_must_win_by_more_than_the_prior() {
        // 20 ln((2/1.5)^2) = 11.5, less 2 for a number more and 2.2 for the correction: the prior of 10 holds.
        let plastic = candidate("plastic", EnergyClass::Plastic, 2, 2.0);
        let near = candidate("damped", EnergyClass::Damped, 3, 1.5);
        let rules = SelectionRules::default();
        assert_eq!(ids(&[plastic.clone(), near.clone()], &rules), some(["plastic", "plastic", "damped"]));
        let without = SelectionRules { plastic_prior: 0.0, ..rules };
        assert_eq!(ids(&[plastic.clone(), near], &without), some(["damped", "plastic", "damped"]));
        // 20 ln 16 = 55.
        let far = candidate("damped", EnergyClass::Damped, 3, 0.5);
        let strength = |all: &[ComparedCandidate]| choose(all, &RECORD, &rules).strength;
        assert_eq!(strength(&[plastic.clone(), far.clone()]), Some((Strength::Decisive, 0)));
        let same = candidate("same", EnergyClass::Plastic, 2, 2.0);
        assert_eq!(strength(&[plastic.clone(), same]), Some((Strength::Weak, 1)));
        assert_eq!(strength(std::slice::from_ref(&far)), None);
        assert_eq!(ids(&[plastic, far], &rules), some(["damped", "plastic", "damped"]));
    }

    #[test]
    fn weak_evidence_prefers_the_simpler_of_models_that_are_not_plastic() {
        // 20 ln(1/0.75^2) = 11.5, less 4 for two numbers more and the correction for 20 samples.
        let two = candidate("two", EnergyClass::Damped, 2, 1.0);
        let four = candidate("four", EnergyClass::Damped, 4, 0.72);
        let rules = SelectionRules::default();
        let selection = choose(&[two.clone(), four.clone()], &RECORD, &rules);
        assert_eq!((selection.recommended.candidate, selection.strength), (Some(0), Some((Strength::Weak, 1))));
        assert!(selection.recommended.because.contains("fewer numbers than four, whose criterion is"));
        let decisive = candidate("four", EnergyClass::Damped, 4, 0.5);
        assert_eq!(ids(&[two, decisive], &rules)[0].as_deref(), Some("four"));
        let plastic = [("two", 2, 1.0), ("four", 4, 0.72)].map(|(id, n, e)| candidate(id, EnergyClass::Plastic, n, e));
        assert_eq!(ids(&plastic, &rules)[0].as_deref(), Some("four"));
    }

    #[test]
    fn a_tenth_of_a_point_of_fit_does_not_overrule_a_difference_above_10() {
        let mut small = candidate("small", EnergyClass::Damped, 2, 1.0);
        let true_one = candidate("true", EnergyClass::Damped, 4, 0.5);
        small.fit_percent = Some(99.95);
        assert_eq!(ids(&[small, true_one], &SelectionRules::default()), some(["true", "small", "small"]));
    }

    #[test]
    fn what_the_record_leaves_open_is_not_for_prediction() {
        let rules = SelectionRules::default();
        // 20 ln(1/0.75^2) = 11.5, less 2 for a number more and 1.2 for the correction: lower by 8.3.
        let mut open = candidate("open", EnergyClass::Plastic, 3, 0.75);
        open.open = vec!["k3".to_owned()];
        let determined = candidate("determined", EnergyClass::Plastic, 2, 1.0);
        // Not felt at other speeds, it stands in the way of the simplest alone.
        let unfelt = [open.clone(), determined.clone()];
        assert_eq!(ids(&unfelt, &rules), some(["open", "determined", "open"]));
        open.open_and_felt.clone_from(&open.open);
        let both = [open.clone(), determined];
        assert_eq!(ids(&both, &rules), some(["determined", "determined", "open"]));
        let selection = choose(&both, &RECORD, &rules);
        assert!(selection.recommended.because.contains("but 1 of its 3 numbers are not determined and felt"));
        // Alone, a curve with an open number is recommended and says so; a damped model is not.
        let [recommended, simplest, closest] = ids(&[open.clone()], &rules);
        assert_eq!((recommended.as_deref(), simplest, closest.as_deref()), (Some("open"), None, Some("open")));
        open.class = EnergyClass::Damped;
        assert_eq!(ids(&[open], &rules)[0], None);
    }

    #[test]
    fn a_decisive_record_is_for_a_model_with_open_numbers_unless_most_of_them_are() {
        let rules = SelectionRules::default();
        // 20 ln 16 = 55 above one without open numbers.
        let determined = candidate("determined", EnergyClass::Plastic, 2, 2.0);
        let open = |names: &[&str]| {
            let open: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
            let close = candidate("open", EnergyClass::Damped, 4, 0.5);
            ComparedCandidate { open_and_felt: open.clone(), open, ..close }
        };
        let half = [open(&["c2", "c3"]), determined.clone()];
        assert_eq!(ids(&half, &rules), some(["open", "determined", "open"]));
        let because = choose(&half, &RECORD, &rules).recommended.because;
        assert!(because.starts_with("damped, 2 of 4 numbers determined, 2 open (2 felt at other speeds)"), "{because}");
        let most = [open(&["c1", "c2", "c3"]), determined.clone()];
        assert_eq!(ids(&most, &rules), some(["determined", "determined", "open"]));
        // 20 ln(1.25^2) = 8.9: not decisive.
        let near = ComparedCandidate { misfit: candidate("", EnergyClass::Damped, 4, 1.6).misfit, ..open(&["c2"]) };
        assert_eq!(ids(&[near, determined.clone()], &rules)[0].as_deref(), Some("determined"));
        let misses_the_wall = ComparedCandidate { force_misfit_percent: Some(60.0), ..open(&["c2"]) };
        assert_eq!(ids(&[misses_the_wall, determined], &rules), some(["determined", "determined", "open"]));
    }

    #[test]
    fn a_misfit_that_is_all_zero_level_leaves_a_choice_among_the_fewest_numbers() {
        let level = |mut candidate: ComparedCandidate, level: f64| {
            candidate.misfit = Some(vec![level; 40]);
            candidate
        };
        let two = level(candidate("two", EnergyClass::Plastic, 2, 1.0), 1.0);
        let worse = level(candidate("worse", EnergyClass::Plastic, 2, 1.0), 2.0);
        let three = level(candidate("three", EnergyClass::Plastic, 3, 0.9), 0.9);
        let all = [worse, three, two];
        assert_eq!(ids(&all, &SelectionRules::default())[0].as_deref(), Some("two"));
        assert_eq!(choose(&all, &RECORD, &SelectionRules::default()).samples, Some(5.0));
    }

    #[test]
    fn what_is_not_adequate_has_no_say() {
        let good = candidate("good", EnergyClass::Plastic, 2, 1.0);
        let mut bound = candidate("bound", EnergyClass::Plastic, 2, 0.1);
        bound.on_bound = vec!["k".to_owned()];
        let mut active = candidate("active", EnergyClass::Plastic, 2, 0.1);
        active.physical = false;
        let mut poor = candidate("poor", EnergyClass::Plastic, 1, 3.0);
        poor.fit_percent = Some(60.0);
        let all = [good, bound, active, poor];
        assert_eq!(ids(&all, &SelectionRules::default()), some(["good", "good", "bound"]));
        let selection = choose(&all, &RECORD, &SelectionRules::default());
        let why: Vec<Option<String>> = selection.rated.iter().map(Rated::why_inadequate).collect();
        let expected = [
            None,
            Some("on a bound of its search: k"),
            Some("a spring or damper is negative"),
            Some("displacement fit of 60.0 % below 90 %"),
        ];
        assert_eq!(why, expected.map(|why| why.map(str::to_owned)));
        let none = choose(&all[3..], &RECORD, &SelectionRules::default());
        assert_eq!((none.recommended.candidate, none.samples), (None, None));
        assert!(choose(&[], &RECORD, &SelectionRules::default()).closest.candidate.is_none());
    }

    #[test]
    fn too_many_numbers_and_a_missed_wall_are_refused() {
        let many = candidate("many", EnergyClass::Plastic, 18, 0.01);
        let mut wall = candidate("wall", EnergyClass::Plastic, 2, 0.5);
        wall.force_misfit_percent = Some(42.0);
        let good = candidate("good", EnergyClass::Plastic, 2, 0.9);
        let names = ids(&[many, wall, good], &SelectionRules::default());
        assert_eq!(names[0].as_deref(), Some("good"));
    }

    #[test]
    fn a_wall_is_missed_in_proportion_to_the_best_of_as_many_masses() {
        let missing = |id: &str, masses: usize, misfit: f64, force: f64| ComparedCandidate {
            masses,
            force_misfit_percent: Some(force),
            ..candidate(id, EnergyClass::Plastic, 2, misfit)
        };
        let recommended = |candidates: &[ComparedCandidate]| ids(candidates, &SelectionRules::default())[0].clone();
        // 1.4 times 32 % is 44.8 %: one mass that misses 44 % is as good as one can be, 46 % is not.
        let one = missing("coarse", 1, 0.9, 32.0);
        assert_eq!(recommended(&[one.clone(), missing("near", 1, 0.5, 44.0)]).as_deref(), Some("near"));
        assert_eq!(recommended(&[one.clone(), missing("off", 1, 0.5, 46.0)]).as_deref(), Some("coarse"));
        // Two masses have masses in front: they are measured by their own.
        assert_eq!(recommended(&[one, missing("two", 2, 0.5, 44.0)]).as_deref(), Some("coarse"));
        // Where none is within the limit none is recommended.
        assert_eq!(recommended(&[missing("a", 1, 0.9, 60.0), missing("b", 1, 0.5, 61.0)]), None);
    }

    #[test]
    fn an_adequate_model_repeats_its_own_test() {
        let near = candidate("near", EnergyClass::Plastic, 2, 0.9);
        let own = near.own_test;
        let off =
            |own_test: OwnTestErrors| ComparedCandidate { own_test, ..candidate("off", EnergyClass::Damped, 2, 0.1) };
        let first_reason = |off: &ComparedCandidate| {
            let selection = choose(&[near.clone(), off.clone()], &RECORD, &SelectionRules::default());
            assert_eq!(selection.recommended.candidate, Some(0));
            selection.rated[1].inadequate[0].clone()
        };
        let missed = |event, error, limit| Inadequacy::Misses { event, error, limit };
        let crush = off(OwnTestErrors { crush: Some(-0.04), ..own });
        assert_eq!(first_reason(&crush), missed(TestEvent::Crush, -0.04, 0.035));
        assert_eq!(first_reason(&crush).to_string(), "misses the dynamic crush of its own test by -4.0 %, limit 3.5 %");
        let time = off(OwnTestErrors { time: Some(0.06), ..own });
        assert_eq!(first_reason(&time), missed(TestEvent::Time, 0.06, 0.05));
        let rebound = off(OwnTestErrors { restitution: Some(0.27), ..own });
        assert_eq!(first_reason(&rebound), missed(TestEvent::Restitution, 0.27, 0.1));
        assert_eq!(first_reason(&off(OwnTestErrors::default())), Inadequacy::NeverStops);
        // A record that ends before the rebound has no restitution to miss.
        let unknown = off(OwnTestErrors { restitution: None, ..own });
        assert_eq!(ids(&[near.clone(), unknown], &SelectionRules::default())[0].as_deref(), Some("off"));
    }

    #[test]
    fn where_none_is_adequate_one_that_misses_the_rebound_alone_is_good_for_its_crush() {
        let own = candidate("", EnergyClass::Damped, 2, 1.0).own_test;
        let off = |id: &str, own_test: OwnTestErrors| ComparedCandidate {
            own_test,
            ..candidate(id, EnergyClass::Damped, 2, 0.5)
        };
        let crush = off("crush", OwnTestErrors { crush: Some(0.05), ..own });
        let rebound = off("rebound", OwnTestErrors { restitution: Some(0.3), ..own });
        let all = [crush, rebound];
        assert_eq!(ids(&all, &SelectionRules::default())[0].as_deref(), Some("rebound"));
        let selection = choose(&all, &RECORD, &SelectionRules::default());
        assert_eq!(selection.rated[1].missed_events(), ["coefficient_of_restitution"]);
        assert!(!selection.rated[1].is_adequate());
        // No adequate one is named where there is none.
        assert!(
            selection.simplest.candidate.is_none() && selection.simplest.because.contains("no candidate is adequate")
        );
        assert!(selection.recommended.because.contains("the only candidate with the crush of the test that qualifies"));
        assert!(selection.recommended.because.contains("misses the restitution of its own test by +0.30"));
        assert_eq!(ids(&all[..1], &SelectionRules::default())[0], None);
        // So it is where an adequate one has open numbers that are felt.
        let names = vec!["a".to_owned(), "b".to_owned()];
        let open = ComparedCandidate {
            open: names.clone(),
            open_and_felt: names,
            ..candidate("open", EnergyClass::Damped, 2, 0.9)
        };
        assert_eq!(ids(&[open, all[1].clone()], &SelectionRules::default())[0].as_deref(), Some("rebound"));
    }

    #[test]
    fn an_open_knot_does_not_hand_the_choice_to_a_damped_model() {
        let damped = candidate("damped", EnergyClass::Damped, 2, 1.0);
        let open = |id: &str, parameters: usize, misfit: f64, open: &[&str]| {
            let names: Vec<String> = open.iter().map(|name| (*name).to_owned()).collect();
            let curve = candidate(id, EnergyClass::Plastic, parameters, misfit);
            ComparedCandidate { open: names.clone(), open_and_felt: names, ..curve }
        };
        let rules = SelectionRules::default();
        // Most of its numbers are open, so the curve does not decide over the damped model; with fewer knots it is not.
        let (three, two) = (open("three", 3, 0.9, &["a", "b"]), open("two", 2, 1.1, &[]));
        assert_eq!(ids(&[damped.clone(), three.clone(), two], &rules)[0].as_deref(), Some("two"));
        let fewer = open("fewer", 3, 1.0, &["a"]);
        assert_eq!(ids(&[damped.clone(), three.clone(), fewer], &rules)[0].as_deref(), Some("fewer"));
        // Where the evidence is for the damped model it stays.
        let close = ComparedCandidate { misfit: candidate("", EnergyClass::Damped, 2, 0.2).misfit, ..damped };
        assert_eq!(ids(&[close.clone(), three.clone()], &rules)[0].as_deref(), Some("damped"));
        // So it does where it has open numbers itself: a curve that is decisively worse is no way out.
        let undecided = ComparedCandidate { open_and_felt: vec!["c".to_owned(), "k".to_owned()], ..close };
        assert_eq!(ids(&[undecided.clone(), three.clone()], &rules)[0], None);
        // 20 ln(1/0.9^2) = 4.2 less the prior of 10 and the charge of a number more.
        let near = ComparedCandidate { misfit: candidate("", EnergyClass::Damped, 2, 0.9).misfit, ..undecided };
        let weak = choose(&[near, three], &RECORD, &rules);
        assert_eq!((weak.recommended.candidate, weak.strength), (Some(1), Some((Strength::Weak, 0))));
    }

    #[test]
    fn of_plastic_models_the_record_has_the_last_word_on_lower_speeds() {
        let error = |id: &str, parameters: usize, misfit: f64, error: f64| {
            let plastic = candidate(id, EnergyClass::Plastic, parameters, misfit);
            ComparedCandidate { crush_error_at_lower_speeds: Some(error), ..plastic }
        };
        // The criterion is for the line; 18 numbers have none, and the curve of 18 is the nearest to the record.
        let (line, curve) = (error("line", 2, 1.0, 0.06), error("curve", 5, 1.0, 0.008));
        let (coarse, fine) = (error("coarse", 4, 1.0, 0.03), error("fine", 18, 0.9, 0.002));
        let rules = SelectionRules::default();
        let all = [line.clone(), coarse.clone(), curve, fine.clone()];
        assert_eq!(ids(&all, &rules)[0].as_deref(), Some("curve"));
        let because = choose(&all, &RECORD, &rules).recommended.because;
        assert!(
            because.contains("within 0.8 %") && because.contains("which line, lower by its criterion, misses by 6.0 %")
        );
        // 20 ln 9 = 44: the line follows the pulse closer.
        let rough = ComparedCandidate { misfit: candidate("", EnergyClass::Plastic, 5, 3.0).misfit, ..all[2].clone() };
        assert_eq!(choose(&[line.clone(), rough], &RECORD, &rules).strength, Some((Strength::Contrary, 0)));
        assert_eq!(ids(&[line.clone(), fine], &rules)[0].as_deref(), Some("fine"));
        assert_eq!(ids(&[line.clone(), coarse], &rules)[0].as_deref(), Some("coarse"));
        assert_eq!(ids(&[line.clone(), error("hardly", 4, 1.0, 0.04)], &rules)[0].as_deref(), Some("line"));
        let wide = SelectionRules { lower_speed_limit_percent: 10.0, ..rules };
        assert_eq!(ids(&all, &wide)[0].as_deref(), Some("line"));
        // A damped model that wins is not asked.
        let damped = candidate("damped", EnergyClass::Damped, 2, 0.1);
        assert_eq!(ids(&[line, damped], &rules)[0].as_deref(), Some("damped"));
    }

    #[test]
    fn a_restitution_unlike_that_of_the_test_costs() {
        let mut bouncy = candidate("bouncy", EnergyClass::Plastic, 2, 1.0);
        bouncy.restitution = Some(0.6);
        let plain = candidate("plain", EnergyClass::Plastic, 2, 1.0);
        let selection = choose(&[bouncy, plain], &RECORD, &SelectionRules::default());
        // (ln 4/0.35)^2.
        assert!((selection.rated[0].terms[1].1 - (4.0_f64.ln() / 0.35).powi(2)).abs() < 1e-12);
        assert_eq!(selection.recommended.candidate, Some(1));
        let wide = SelectionRules { restitution_deviation: 0.0, plastic_prior: 0.0, ..SelectionRules::default() };
        assert!(wide.terms(&candidate("a", EnergyClass::Elastic, 1, 1.0), None).is_empty());
        assert!(wide.priors(None).is_empty());
    }
}
