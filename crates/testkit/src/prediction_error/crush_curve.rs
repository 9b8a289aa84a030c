//! Forces of the structures of made cars over their deflection: smooth curves, so that no family with knots equals one.

use std::f64::consts::TAU;

/// A static force over deflection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum CrushCurve {
    /// Columns that fold: a mean force with a trend, waves and an initial peak on it, and what stops them.
    Folding(Folding),
    /// A foam: a plateau that hardens without end where the cells close.
    Foam {
        /// Force of the plateau, N.
        plateau_n: f64,
        /// Deflection over which the plateau builds up, m.
        bend_m: f64,
        /// Thickness of the foam, m: `plateau (1 + (d / (thickness - d))²)`, straight on from 90 % of it.
        thickness_m: f64,
    },
    /// This force, N, times a power of the deflection over a length, m.
    Power { force_n: f64, length_m: f64, exponent: f64 },
}

/// A mean force that rises with the deflection, times one and what is on it; where it bottoms out, more beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Folding {
    /// Mean force at the start, N.
    pub force_n: f64,
    /// Rise of the mean force, N/m.
    pub rise_n_per_m: f64,
    /// Deflection over which the force builds up, m.
    pub bend_m: f64,
    /// Initial peak `share (d/length) exp(1 - d/length)` on the mean: share and length, m.
    pub peak: (f64, f64),
    /// Waves on the mean, those of folding and slow ones.
    pub waves: [Wave; 3],
    /// Deflection from which the structure bottoms out, m; infinite for never.
    pub bottom_m: f64,
    /// Force there grows by this times a power of what is beyond, N/m to that power.
    pub bottom: (f64, i32),
}

/// `height sin(2 pi d/length + phase)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wave {
    pub height: f64,
    pub length_m: f64,
    pub phase: f64,
}

impl Wave {
    pub const NONE: Self = Self { height: 0.0, length_m: 1.0, phase: 0.0 };

    fn at(self, d: f64) -> f64 {
        self.height * (TAU * d / self.length_m + self.phase).sin()
    }
}

impl Folding {
    /// A constant force that builds up at once, nothing beyond: to be changed.
    pub const CONSTANT: Self = Self {
        force_n: 1.0,
        rise_n_per_m: 0.0,
        bend_m: 1e-9,
        peak: (0.0, 1.0),
        waves: [Wave::NONE; 3],
        bottom_m: f64::INFINITY,
        bottom: (0.0, 1),
    };

    fn at(&self, d: f64) -> f64 {
        let mean = (self.force_n + self.rise_n_per_m * d) * (1.0 - (-d / self.bend_m).exp());
        let (peak, length_m) = self.peak;
        let waves = self.waves.iter().map(|wave| wave.at(d)).sum::<f64>();
        let beyond = (d - self.bottom_m).max(0.0);
        mean * (1.0 + peak * d / length_m * (1.0 - d / length_m).exp() + waves)
            + self.bottom.0 * beyond.powi(self.bottom.1)
    }
}

impl CrushCurve {
    /// The same without waves: what goes on of it where nobody knows in which phase it folds.
    pub fn smooth(mut self) -> Self {
        if let Self::Folding(folding) = &mut self {
            folding.waves = [Wave::NONE; 3];
        }
        self
    }

    /// Static force, N, at a deflection, m; zero without contact.
    pub fn at(self, d: f64) -> f64 {
        if d <= 0.0 {
            return 0.0;
        }
        match self {
            Self::Folding(folding) => folding.at(d),
            Self::Foam { plateau_n, bend_m, thickness_m } => {
                let closing = |d: f64| 1.0 + (d / (thickness_m - d)).powi(2);
                let limit = 0.9 * thickness_m;
                // Slope of the hardening at 90 %: 2 d t / (t - d)³.
                let hardening =
                    if d < limit { closing(d) } else { closing(limit) + 1800.0 / thickness_m * (d - limit) };
                plateau_n * hardening * (1.0 - (-d / bend_m).exp())
            }
            Self::Power { force_n, length_m, exponent } => force_n * (d / length_m).powf(exponent),
        }
    }

    /// The steepest slope between two deflections, N/m, on a grid of a thousandth of the larger one.
    pub fn steepest(self, from_m: f64, to_m: f64) -> f64 {
        let step = to_m / 1000.0;
        let places = (0..1000).map(|i| f64::from(i) * step).filter(|d| *d >= from_m);
        places.map(|d| (self.at(d + step) - self.at(d)) / step).fold(0.0, f64::max)
    }
}
