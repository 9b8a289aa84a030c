//! The rate factor of a structure: what tests at different speeds say of it, and a prior where they do not.

use crumple_lumped::{Model, ModelKind, ParameterKind};

use crate::free::free_parameter::FreeParameter;
use crate::solvers::crush_curves::assumptions::RATE_PRIOR_S_PER_M;

/// Ratio of the fastest to the slowest impact from which a rate factor is fitted. The force at equal crush differs by
/// `r` times the difference of the speeds there: at 56 and 50 km/h by 2 % for `r` of 1 % per m/s, about what a zero
/// level that is off by 1 % of the peak makes of it.
const APART: f64 = 1.1;
/// One unit of its coordinate, s/m: the size that vehicles have.
const UNIT_S_PER_M: f64 = 0.01;
/// The largest that is looked for, s/m: beyond foams and hydraulic dampers.
const LARGEST_S_PER_M: f64 = 0.2;
/// Where its fit starts, s/m: steel structures, and foams or sled bucks.
const STARTS_S_PER_M: [f64; 2] = [RATE_PRIOR_S_PER_M, 0.03];

/// Where the rate factor of a joint fit comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RateFactorSource {
    /// The speeds are far enough apart: it is fitted.
    Fitted,
    /// They are not, and it stays the prior of a single test.
    Prior {
        /// Fastest over slowest impact.
        ratio: f64,
    },
}

/// Whether impacts at these speeds tell the rate factor: the fastest at least a tenth above the slowest.
pub fn rate_factor_source(speeds_m_per_s: &[f64]) -> RateFactorSource {
    let fastest = speeds_m_per_s.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let slowest = speeds_m_per_s.iter().copied().fold(fastest, f64::min);
    let ratio = fastest / slowest;
    // Speeds as read off a record are never exactly those of the order.
    if ratio >= APART { RateFactorSource::Fitted } else { RateFactorSource::Prior { ratio } }
}

impl RateFactorSource {
    /// Values from which it is fitted; `None`: it is not, or the model has none.
    pub(crate) fn starts(self, kind: ModelKind) -> Option<[f64; 2]> {
        let has_one = kind.parameters().iter().any(|p| p.kind == ParameterKind::RateFactor);
        (has_one && self == Self::Fitted).then_some(STARTS_S_PER_M)
    }

    /// In words, for a model that has one.
    pub(crate) fn remark(self, model: &Model) -> Option<String> {
        let rate = rate_of(model)?;
        Some(match self {
            Self::Fitted => format!("rate factor {rate:.4} s/m fitted: the tests are at different speeds"),
            Self::Prior { ratio } => format!(
                "rate factor {rate} s/m is a prior, +- 0.005: the fastest test is {:.1} % faster than the slowest, \
                 and less than {:.0} % does not tell it",
                100.0 * (ratio - 1.0),
                100.0 * (APART - 1.0)
            ),
        })
    }
}

/// The rate factor of a model, s/m; `None`: it has none.
fn rate_of(model: &Model) -> Option<f64> {
    let name = name_of(model.kind())?;
    model.parameters().get(name).copied()
}

fn name_of(kind: ModelKind) -> Option<&'static str> {
    kind.parameters().iter().find(|p| p.kind == ParameterKind::RateFactor).map(|p| p.name)
}

/// The rate factor as a free number that starts here; its coordinate is a share, so that zero is a value like others.
pub(crate) fn free_rate(kind: ModelKind, start_s_per_m: f64) -> Option<FreeParameter> {
    Some(FreeParameter {
        name: name_of(kind)?,
        kind: ParameterKind::RateFactor,
        value: start_s_per_m,
        unit: UNIT_S_PER_M,
        scale: UNIT_S_PER_M,
        logarithmic: false,
        limit: LARGEST_S_PER_M,
        lowest: 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tenth_between_the_speeds_tells_the_rate_factor() {
        assert_eq!(rate_factor_source(&[15.0, 11.0]), RateFactorSource::Fitted);
        assert_eq!(rate_factor_source(&[10.0, 11.0, 10.5]), RateFactorSource::Fitted);
        assert_eq!(rate_factor_source(&[15.0, 15.0]), RateFactorSource::Prior { ratio: 1.0 });
        assert!(matches!(rate_factor_source(&[15.0, 15.3]), RateFactorSource::Prior { .. }));
        assert_eq!(RateFactorSource::Fitted.starts(ModelKind::Kelvin), None);
    }
}
