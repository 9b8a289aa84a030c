//! The kernel of `y'' + 2a y' + b y = 0`, which the single-mass models share.
//!
//! Kelvin solves it for the displacement, with `2a = c/m` and `b = k/m`; Maxwell for the velocity, with `2a = k/c` and
//! `b = k/m`. Critical damping lies inside the range of both, so all forms pass through it without a difference of two
//! large numbers.

/// `y'' + 2·half_damping·y' + stiffness·y = 0`: coefficients in 1/s and 1/s², any sign.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SecondOrder {
    pub half_damping: f64,
    pub stiffness: f64,
}

/// Position of the two roots of the characteristic polynomial.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Roots {
    /// `-a ± i·w`, w > 0, rad/s.
    Complex { w: f64 },
    /// `-a ± s`, s >= 0 (equal: critical damping); `upper = -a + s` without cancellation.
    Real { s: f64, upper: f64 },
}

impl SecondOrder {
    /// Roots, with the discriminant `b - a²` formed as a product, so that it is right to rounding near critical
    /// damping.
    pub fn roots(self) -> Roots {
        let Self { half_damping: a, stiffness: b } = self;
        let discriminant = if b > 0.0 { (b.sqrt() - a.abs()) * (b.sqrt() + a.abs()) } else { b - a * a };
        if discriminant > 0.0 {
            return Roots::Complex { w: discriminant.sqrt() };
        }
        let s = (-discriminant).sqrt();
        // -a + s = -b/(a + s): the first loses all digits for strong damping.
        let upper = if a > 0.0 { -b / (a + s) } else { -a + s };
        Roots::Real { s, upper }
    }

    /// `(e^(-a t) cos w t, e^(-a t) sin(w t)/w)`, continued to hyperbolic functions beyond critical damping.
    ///
    /// The first solves `y(0) = 1, y'(0) = -a`, the second `y(0) = 0, y'(0) = 1`.
    pub fn kernel(self, t: f64) -> (f64, f64) {
        match self.roots() {
            Roots::Complex { w } => {
                let envelope = (-self.half_damping * t).exp();
                (envelope * (w * t).cos(), envelope * (w * t).sin() / w)
            }
            Roots::Real { s, upper } => {
                let envelope = (upper * t).exp();
                let sine = if s * t == 0.0 { t } else { -(-2.0 * s * t).exp_m1() / (2.0 * s) };
                (envelope * 0.5 * (1.0 + (-2.0 * s * t).exp()), envelope * sine)
            }
        }
    }

    /// `y'` for `y(0) = 0, y'(0) = 1`: `cos - a·sin/w` with its envelope, without cancellation for strong damping.
    pub fn step_rate(self, t: f64) -> f64 {
        match self.roots() {
            Roots::Real { s, upper } if s > 0.1 * self.half_damping.abs() => {
                let lower = -self.half_damping - s;
                (upper * t).exp() * (upper - lower * (-2.0 * s * t).exp()) / (2.0 * s)
            }
            _ => {
                let (cosine, sine) = self.kernel(t);
                cosine - self.half_damping * sine
            }
        }
    }
}
