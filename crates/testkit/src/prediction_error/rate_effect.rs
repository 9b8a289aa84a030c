//! How the force of a structure that is being crushed grows with the rate.

/// A force over the static one, by the rate of the crush.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum RateEffect {
    /// In proportion to the rate, s/m.
    Linear(f64),
    /// `1 + (e/D)^(1/q)` of mild steel, `D` 6844/s and `q` 3.91 (Cowper & Symonds 1957), at strains that grow by this
    /// much a metre of crush: `e` of columns is `0.25 w / width` (Abramowicz & Jones, Int. J. Impact Eng. 2(2), 1984).
    CowperSymonds(f64),
    /// By this share for each factor of e in the rate over 0.5 m/s.
    Logarithmic(f64),
}

impl RateEffect {
    /// The force at rate `w`, m/s, over the static one.
    pub fn factor(self, w: f64) -> f64 {
        match self {
            Self::Linear(s_per_m) => 1.0 + s_per_m * w.max(0.0),
            Self::CowperSymonds(per_m) => 1.0 + (per_m * w.max(0.0) / 6844.0).powf(1.0 / 3.91),
            Self::Logarithmic(share) => 1.0 + share * (w / 0.5).max(1.0).ln(),
        }
    }
}
