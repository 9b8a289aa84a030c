//! Comparison of models of one output by information criteria and validation.

use crate::InformationCriteria;

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
        .filter_map(|r| Some((r.contender.validation_fit_percent?, &r.contender.id)))
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
        }
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
