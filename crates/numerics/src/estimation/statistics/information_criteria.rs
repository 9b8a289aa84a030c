//! Information criteria: how much better a model must fit to deserve its parameters.
//!
//! All of them weigh the mean square `V` of the residuals against the number `p` of free parameters for `N` samples;
//! for correlated residuals `N` is the number of independent ones. Only differences between models of the same data
//! count: 2 is weak evidence, 10 is strong (Burnham & Anderson 2002, section 2.6).

/// Criteria of one model; the smallest wins among models of the same data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InformationCriteria {
    /// Mean square of the residuals, `V`.
    pub loss: f64,
    /// Number of estimated parameters, `p`.
    pub parameters: usize,
    /// Number of samples, `N`: the effective number where residuals are correlated.
    pub samples: f64,
    /// `N ln V + 2 p` (Akaike 1974).
    pub aic: f64,
    /// AIC with the correction for short records, `+ 2 p (p + 1)/(N - p - 1)` (Hurvich & Tsai 1989); infinite when
    /// there are as many parameters as samples.
    pub aicc: f64,
    /// `N ln V + p ln N` (Schwarz 1978).
    pub bic: f64,
    /// Akaike's final prediction error, `V (1 + p/N)/(1 - p/N)`; infinite as above.
    pub fpe: f64,
    /// Minimum description length, `V (1 + p ln N / N)` (Rissanen 1978).
    pub mdl: f64,
}

impl InformationCriteria {
    /// Of a loss of `V > 0`, `samples` and a number of parameters. A loss of zero counts as the smallest number.
    pub fn new(loss: f64, samples: f64, parameters: usize) -> Self {
        let (n, p) = (samples.max(1.0), parameters as f64);
        let log = n * loss.max(f64::MIN_POSITIVE).ln();
        let aic = log + 2.0 * p;
        Self {
            loss,
            parameters,
            samples: n,
            aic,
            aicc: if n > p + 1.0 { aic + 2.0 * p * (p + 1.0) / (n - p - 1.0) } else { f64::INFINITY },
            bic: log + p * n.ln(),
            fpe: if n > p { loss * (1.0 + p / n) / (1.0 - p / n) } else { f64::INFINITY },
            mdl: loss * (1.0 + p * n.ln() / n),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_by_hand() {
        let c = InformationCriteria::new(1.0, 100.0, 3);
        assert_eq!((c.aic, c.bic), (6.0, 3.0 * 100.0_f64.ln()));
        assert!((c.aicc - (6.0 + 24.0 / 96.0)).abs() < 1e-12 && (c.fpe - 1.03 / 0.97).abs() < 1e-12);
        assert!(InformationCriteria::new(1.0, 3.0, 5).aicc.is_infinite());
    }
}
