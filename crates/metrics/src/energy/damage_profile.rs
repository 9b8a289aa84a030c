//! Residual crush at stations of equal spacing over the width of the damage, straight between them.

/// Residual crush at two stations or more, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DamageProfile<'a>(&'a [f64]);

impl<'a> DamageProfile<'a> {
    /// From left to right. `None` with fewer than two stations, or with a crush that is negative or not finite.
    pub fn new(crush_m: &'a [f64]) -> Option<Self> {
        (crush_m.len() >= 2 && crush_m.iter().all(|c| c.is_finite() && *c >= 0.0)).then_some(Self(crush_m))
    }

    /// Mean over the width, m: the ends count half.
    pub fn mean_m(&self) -> f64 {
        self.0.windows(2).map(|c| 0.5 * (c[0] + c[1])).sum::<f64>() / (self.0.len() - 1) as f64
    }

    /// Mean of the square over the width, m²: `(p² + pq + q²)/3` over every span.
    pub fn mean_square_m2(&self) -> f64 {
        let spans = self.0.windows(2).map(|c| (c[0] * c[0] + c[0] * c[1] + c[1] * c[1]) / 3.0);
        spans.sum::<f64>() / (self.0.len() - 1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_of_a_wedge() {
        // From 0 to 1: means 1/2 and 1/3.
        let wedge = DamageProfile::new(&[0.0, 0.25, 0.5, 0.75, 1.0]).unwrap();
        assert_eq!(wedge.mean_m(), 0.5);
        assert!((wedge.mean_square_m2() - 1.0 / 3.0).abs() < 1e-15);
        assert!(DamageProfile::new(&[0.3]).is_none() && DamageProfile::new(&[0.3, -0.1]).is_none());
    }
}
