//! Comparison of models of one output by information criteria and validation.

use crumple_numerics::estimation::statistics::standard_deviation;

use crate::{InformationCriteria, autoregressive_effective_samples};

/// Differences of AICc up to this do not tell models apart (Burnham & Anderson, *Model Selection and Multimodel
/// Inference*, 2002, ch. 2.6).
const NEAR_EQUAL: f64 = 2.0;

/// A model that is compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Contender {
    /// Its name.
    pub id: String,
    /// Number of its parameters.
    pub parameters: usize,
    /// Mean square error of its simulated output.
    pub loss: f64,
    /// Number of independent samples that its residuals are worth.
    pub effective_samples: f64,
    /// Fit of samples it was not identified from, percent.
    pub validation_fit_percent: Option<f64>,
    /// Number of its states.
    pub order: usize,
    /// The same fit with the start fitted, mean over the outputs.
    pub restarted_fit_percent: Option<f64>,
    /// Squares of the errors at every sample that it has not seen, [`unseen_squares`]; empty: none were kept.
    pub unseen_squares: Vec<f64>,
}

/// Squares of the errors at every sample, each output's divided by its variance, summed over the outputs.
pub fn unseen_squares(measured: &[Vec<f64>], simulated: &[Vec<f64>]) -> Vec<f64> {
    let samples = measured.first().map_or(0, Vec::len);
    let mut sum = vec![0.0; samples];
    for (y, yh) in measured.iter().zip(simulated) {
        let variance = standard_deviation(y).unwrap_or(0.0).powi(2).max(f64::MIN_POSITIVE);
        sum.iter_mut().zip(y.iter().zip(yh)).for_each(|(sum, (y, yh))| *sum += (y - yh).powi(2) / variance);
    }
    sum
}

/// Models that unseen samples leave in the comparison: all without such samples, else those whose mean square error on
/// them is larger than the smallest by so many standard errors of the difference at most.
///
/// One is the rule of Breiman, Friedman, Olshen & Stone, *Classification and Regression Trees*, 1984, ch. 3.4.3, for a
/// few models. The best of many is best by chance ([`best_of_many`]). The error is that of the difference of two models
/// at the same samples (Diebold & Mariano, J. Business & Economic Statistics 13, 1995), whose independent samples its
/// autocorrelation counts.
pub fn left_by_unseen(contenders: &[Contender], standard_errors: f64) -> Vec<&Contender> {
    let mean = |squares: &[f64]| squares.iter().sum::<f64>() / squares.len() as f64;
    let judged = contenders.iter().filter(|contender| !contender.unseen_squares.is_empty());
    let Some(best) = judged.min_by(|a, b| mean(&a.unseen_squares).total_cmp(&mean(&b.unseen_squares))) else {
        return contenders.iter().collect();
    };
    let is_as_good = |contender: &&Contender| {
        let differences: Vec<f64> =
            contender.unseen_squares.iter().zip(&best.unseen_squares).map(|(a, b)| a - b).collect();
        let more = mean(&differences);
        let about: Vec<f64> = differences.iter().map(|d| d - more).collect();
        let independent = autoregressive_effective_samples(&about).max(1.0);
        let error = standard_deviation(&about).unwrap_or(0.0) / independent.sqrt();
        !differences.is_empty() && more <= standard_errors * error
    };
    let excluded = contenders.iter().filter(|c| !c.unseen_squares.is_empty() && !is_as_good(c));
    // None stays that is worse than one that goes.
    let bound = excluded.map(|contender| mean(&contender.unseen_squares)).fold(f64::INFINITY, f64::min);
    contenders.iter().filter(|c| is_as_good(c) && mean(&c.unseen_squares) <= bound).collect()
}

/// Standard errors by which the best of so many models is best by chance, at 95 % (Bonferroni, with the bound
/// `exp(-z²/2)/2` of the tail of a normal distribution): a model confidence set (Hansen, Lunde & Nason, Econometrica
/// 79, 2011).
pub fn best_of_many(models: usize) -> f64 {
    (2.0 * (10.0 * models as f64).ln()).sqrt()
}

/// A contender and how far it is behind.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranked {
    /// The model.
    pub contender: Contender,
    /// AICc less the smallest; `None` with as many parameters as independent samples.
    pub aicc_difference: Option<f64>,
    /// BIC less the smallest.
    pub bic_difference: f64,
}

/// The outcome of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// Number of independent samples used for all.
    pub effective_samples: f64,
    /// The models, best first: by AICc, those without one after the others by BIC.
    pub ranked: Vec<Ranked>,
    /// Id with the smallest BIC.
    pub best_by_bic: String,
    /// Id with the best fit of unseen samples.
    pub best_by_validation: Option<String>,
    /// Ids whose AICc is within 2 of the smallest, the best first.
    pub near_equal: Vec<String>,
}

/// Compares models of the same samples of the same output; `None` for fewer than two.
///
/// Criteria of different models must count the same number of samples, or they are not comparable: that of the model
/// with the smallest loss is taken for all, whose residual is nearest to the noise. Models that fit to rounding are
/// alike by their loss; then the number of parameters should decide, and the reader.
pub fn select(contenders: &[Contender]) -> Option<Selection> {
    if contenders.len() < 2 {
        return None;
    }
    let closest = contenders.iter().min_by(|a, b| a.loss.total_cmp(&b.loss))?;
    let effective_samples = closest.effective_samples;
    let criteria: Vec<InformationCriteria> =
        contenders.iter().map(|c| InformationCriteria::new(c.loss, effective_samples, c.parameters)).collect();
    let least =
        |values: &dyn Fn(&InformationCriteria) -> f64| criteria.iter().map(values).fold(f64::INFINITY, f64::min);
    let (aicc, bic) = (least(&|c| c.aicc), least(&|c| c.bic));
    let mut ranked: Vec<Ranked> = contenders
        .iter()
        .zip(&criteria)
        .map(|(contender, c)| Ranked {
            contender: contender.clone(),
            aicc_difference: Some(c.aicc - aicc).filter(|x| x.is_finite()),
            bic_difference: c.bic - bic,
        })
        .collect();
    ranked.sort_by(|a, b| {
        let key = |r: &Ranked| r.aicc_difference.unwrap_or(f64::INFINITY);
        key(a).total_cmp(&key(b)).then(a.bic_difference.total_cmp(&b.bic_difference))
    });
    let best_by_bic = ranked.iter().min_by(|a, b| a.bic_difference.total_cmp(&b.bic_difference))?.contender.id.clone();
    let best_by_validation = ranked
        .iter()
        .filter_map(|r| {
            let Contender { restarted_fit_percent: restarted, validation_fit_percent: run_on, id, .. } = &r.contender;
            Some((restarted.or(*run_on)?, id))
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, id)| id.clone());
    let near_equal = ranked
        .iter()
        .filter(|r| r.aicc_difference.is_some_and(|d| d < NEAR_EQUAL))
        .map(|r| r.contender.id.clone())
        .collect();
    Some(Selection { effective_samples, ranked, best_by_bic, best_by_validation, near_equal })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    fn contender(id: &str, parameters: usize, loss: f64) -> Contender {
        Contender {
            id: id.to_owned(),
            parameters,
            loss,
            effective_samples: 100.0,
            validation_fit_percent: None,
            order: 1,
            restarted_fit_percent: None,
            unseen_squares: Vec::new(),
        }
    }

    #[test]
    fn unseen_samples_leave_what_is_within_one_standard_error() {
        let with = |id: &str, squares: Vec<f64>| Contender { unseen_squares: squares, ..contender(id, 3, 1.0) };
        let wave = |mean: f64, swing: f64| -> Vec<f64> {
            (0..400).map(|k| mean + swing * if k % 4 < 2 { 1.0 } else { -1.0 }).collect()
        };
        let all = [with("best", wave(1.0, 0.0)), with("as-good", wave(1.01, 0.5)), with("worse", wave(1.2, 0.1))];
        let left: Vec<&str> = left_by_unseen(&all, 1.0).into_iter().map(|contender| contender.id.as_str()).collect();
        assert_eq!(left, ["best", "as-good"]);
        // One without unseen samples is not compared with those that have some; without any all stay.
        let mixed = [with("best", wave(1.0, 0.0)), contender("blind", 3, 1.0)];
        assert_eq!(left_by_unseen(&mixed, 1.0).len(), 1);
        assert_eq!(left_by_unseen(&mixed[1..], 1.0).len(), 1);
        let squares = unseen_squares(&[vec![1.0, -1.0, 1.0, -1.0]], &[vec![0.0, 0.0, 1.0, -1.0]]);
        assert!(squares[2..] == [0.0, 0.0] && squares[0] == squares[1] && squares[0] > 0.7, "{squares:?}");
    }

    #[test]
    fn a_parameter_must_pay_for_itself_and_equals_are_named() {
        // 100 ln(1.01) = 1.0 for two more parameters: not worth it, and not told apart by AICc.
        let estimated = select(&[contender("a", 5, 1.0), contender("b", 3, 1.01), contender("c", 3, 2.0)]).unwrap();
        assert_eq!(estimated.ranked[0].contender.id, "b");
        assert_eq!(estimated.best_by_bic, "b");
        let behind = estimated.ranked[2].aicc_difference.unwrap();
        assert!((behind - 100.0 * (2.0_f64 / 1.01).ln()).abs() < 1e-9, "{behind}");
        // AICc of a: 4 + 60/94 - 24/96 - 0.995 = 3.39 behind.
        assert_eq!(estimated.near_equal, ["b"]);
        let near = select(&[contender("a", 4, 1.0), contender("b", 3, 1.01)]).unwrap();
        assert_eq!(near.near_equal, ["b", "a"]);
    }

    #[test]
    fn too_many_parameters_have_no_aicc_and_unseen_samples_have_a_vote() {
        let unseen = |id: &str, fit: f64| Contender { validation_fit_percent: Some(fit), ..contender(id, 3, 1.0) };
        let estimated = select(&[contender("big", 100, 0.5), unseen("x", 80.0), unseen("y", 90.0)]).unwrap();
        assert_eq!(estimated.ranked[2].aicc_difference, None);
        assert_eq!(estimated.best_by_validation.as_deref(), Some("y"));
        assert_eq!(select(&[contender("a", 1, 1.0)]), None);
    }
}
