//! Information criterion of the displacement error, with what the samples are worth.

use crumple_lumped::{Model, ModelKind, Parameter, ParameterKind};
use crumple_numerics::estimation::statistics::InformationCriteria;

/// The criterion of one candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Information {
    /// `Ne ln V + 2p + 2p(p+1)/(Ne - p - 1)`, `V` the mean square error in m²; `None` for `Ne <= p + 1` or no error at
    /// all.
    pub aicc: Option<f64>,
    /// Independent samples.
    pub effective_samples: f64,
    /// Parameters.
    pub parameters: u32,
}

/// The criterion for a mean square error, at the number of independent samples that all candidates share: with a number
/// each, the criterion would reward the smoother error. Hurvich & Tsai, Biometrika 76(2), 1989.
///
/// The smallest value wins, and only differences between candidates of one test count: 2 is weak, 10 strong support
/// (Burnham & Anderson 2002, section 2.6). `mean_square_m2` is that of the displacement error over the window.
pub fn information(mean_square_m2: f64, effective_samples: f64, parameters: u32) -> Information {
    let criteria = InformationCriteria::new(mean_square_m2, effective_samples, parameters as usize);
    let aicc = (mean_square_m2 > 0.0).then_some(criteria.aicc).filter(|value| value.is_finite());
    Information { aicc, effective_samples, parameters }
}

/// Springs, dampers and knots of a model: what its fit was free to choose. Masses and the ends of curves are given.
pub fn parameters_of(kind: ModelKind) -> u32 {
    kind.parameters().iter().filter(|parameter| is_fitted(parameter)).count() as u32
}

/// The same of a model, of which a crushed structure has the knots that it has.
pub fn numbers_of(model: &Model) -> u32 {
    let given = model.parameters();
    let parameters = model.kind().parameters().iter();
    parameters.filter(|parameter| is_fitted(parameter) && given.contains_key(parameter.name)).count() as u32
}

fn is_fitted(parameter: &Parameter) -> bool {
    parameter.kind != ParameterKind::Mass && !parameter.of_the_test
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_criterion_is_that_of_the_formula() {
        // 100 ln 1e-6 + 4 + 12/97, by hand.
        let criterion = information(1e-6, 100.0, 2);
        assert!((criterion.aicc.unwrap() - (-1_381.551_055_796_427_5 + 4.0 + 12.0 / 97.0)).abs() < 1e-9);
        assert_eq!(information(1e-6, 10.9, 10).aicc, None);
        assert_eq!((parameters_of(ModelKind::Kelvin), parameters_of(ModelKind::Nonlinear2)), (2, 10));
    }
}
