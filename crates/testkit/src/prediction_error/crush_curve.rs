//! Forces of the structures of made cars over their deflection: smooth curves, so that no family with knots equals one.

/// A static force over deflection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum CrushCurve {
    /// Columns that fold: a mean force that rises with the deflection, buckling waves on it, a first bend.
    Buckling {
        /// Mean force at the start, N.
        force_n: f64,
        /// Rise of the mean force, N/m.
        rise_n_per_m: f64,
        /// Deflection over which the force builds up, m.
        bend_m: f64,
        /// Height of the waves as a share of the mean.
        wave: f64,
        /// Length of a wave, m.
        length_m: f64,
        /// Phase of the first wave, rad.
        phase: f64,
        /// Deflection from which the structure bottoms out, m; infinite for never.
        bottom_m: f64,
        /// Force there grows by this times the square of what is beyond, N/m².
        bottom_n_per_m2: f64,
    },
    /// A foam: a plateau that hardens without end where the cells close.
    Foam {
        /// Force of the plateau, N.
        plateau_n: f64,
        /// Deflection over which the plateau builds up, m.
        bend_m: f64,
        /// Thickness of the foam, m: `plateau (1 + (d / (thickness - d))²)`, straight on from 90 % of it.
        thickness_m: f64,
    },
}

impl CrushCurve {
    /// The same without waves: what goes on of it where nobody knows in which phase it folds.
    pub fn smooth(mut self) -> Self {
        if let Self::Buckling { wave, .. } = &mut self {
            *wave = 0.0;
        }
        self
    }

    /// Static force, N, at a deflection, m; zero without contact.
    pub fn at(self, d: f64) -> f64 {
        if d <= 0.0 {
            return 0.0;
        }
        match self {
            Self::Buckling { force_n, rise_n_per_m, bend_m, wave, length_m, phase, bottom_m, bottom_n_per_m2 } => {
                let mean = (force_n + rise_n_per_m * d) * (1.0 - (-d / bend_m).exp());
                let beyond = (d - bottom_m).max(0.0);
                mean * (1.0 + wave * (std::f64::consts::TAU * d / length_m + phase).sin())
                    + bottom_n_per_m2 * beyond * beyond
            }
            Self::Foam { plateau_n, bend_m, thickness_m } => {
                let closing = |d: f64| 1.0 + (d / (thickness_m - d)).powi(2);
                let limit = 0.9 * thickness_m;
                // Slope of the hardening at 90 %: 2 d t / (t - d)³.
                let hardening =
                    if d < limit { closing(d) } else { closing(limit) + 1800.0 / thickness_m * (d - limit) };
                plateau_n * hardening * (1.0 - (-d / bend_m).exp())
            }
        }
    }

    /// The steepest slope up to a deflection, N/m, on a grid of a thousandth of it.
    pub fn steepest(self, up_to_m: f64) -> f64 {
        let step = up_to_m / 1000.0;
        (0..1000).map(|i| (self.at((i + 1) as f64 * step) - self.at(i as f64 * step)) / step).fold(0.0, f64::max)
    }
}
