//! Polynomials of degree two in what an element feels.
//!
//! On one branch of its law every element of this crate has a force of this shape, and the instants at which it changes
//! its branch are zeros of such polynomials. So the simulators know forms and nothing of the elements.

/// What an element feels: its compression `u` (m), the rate `w` of it (m/s) and its inner state `z` (m, zero for
/// elements without one).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Strain {
    /// Compression, m: displacement of the rear node minus that of the front node.
    pub u: f64,
    /// Rate of it, m/s.
    pub w: f64,
    /// Inner state, m.
    pub z: f64,
}

/// `constant + u U + w W + z Z + uu U² + ww W² + uw U W` of the strain `U, W, Z`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Form {
    /// Without any strain.
    pub constant: f64,
    /// By the compression.
    pub u: f64,
    /// By its rate.
    pub w: f64,
    /// By the inner state.
    pub z: f64,
    /// By the square of the compression.
    pub uu: f64,
    /// By the square of its rate.
    pub ww: f64,
    /// By the product of both.
    pub uw: f64,
}

impl Form {
    /// Nothing, whatever the strain.
    pub const ZERO: Self = Self { constant: 0.0, u: 0.0, w: 0.0, z: 0.0, uu: 0.0, ww: 0.0, uw: 0.0 };

    /// Its value.
    #[inline(always)]
    pub fn at(&self, s: Strain) -> f64 {
        (self.u + self.uu * s.u + self.uw * s.w) * s.u + (self.w + self.ww * s.w) * s.w + self.z * s.z + self.constant
    }

    /// Its derivatives by compression and rate.
    #[inline(always)]
    pub fn slopes(&self, s: Strain) -> [f64; 2] {
        [self.u + 2.0 * self.uu * s.u + self.uw * s.w, self.w + 2.0 * self.ww * s.w + self.uw * s.u]
    }

    /// `self + factor other`.
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        Self {
            constant: self.constant + factor * other.constant,
            u: self.u + factor * other.u,
            w: self.w + factor * other.w,
            z: self.z + factor * other.z,
            uu: self.uu + factor * other.uu,
            ww: self.ww + factor * other.ww,
            uw: self.uw + factor * other.uw,
        }
    }
}
