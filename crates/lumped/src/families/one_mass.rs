//! One mass before a barrier: Kelvin, Maxwell, elastoplastic, nonlinear; and the double model.
//!
//! The closed form of the elastoplastic model is one loading and one unloading, each a piece of a cosine: starts of
//! fits and checks of the simulated motion. When a force continues or a barrier moves, the law of [`PlasticSpring`]
//! holds.

use std::f64::consts::{FRAC_PI_2, PI};

use crumple_numerics::lti::{Complex, polynomial_roots};
use nalgebra::Matrix4;

use crate::exact::linear_motion::{Roots, SecondOrder};
use crate::families::chain::{check_values, constants};
use crate::structure::connected_masses::Structure;
use crate::structure::elements::{Damper, PlasticSpring, SeriesSpringDamper, Spring};
use crate::structure::piecewise_linear::PiecewiseLinear;
use crate::{CrushEvents, LumpedError, ModelKind, State};

/// Gives a family its list of values and its check. What is no parameter comes after the bar.
macro_rules! values {
    ($model:ident { $($field:ident),+ $(| $other:ident: $value:expr)? }) => {
        impl $model {
            /// Its parameters, in the order of [`ModelKind::parameters`](crate::ModelKind::parameters).
            pub(crate) fn values(&self) -> Vec<f64> {
                vec![$(self.$field),+]
            }

            /// The model of these parameters; one that is left out is not a number.
            pub(crate) fn from_values(values: &[f64]) -> Self {
                let mut values = values.iter().copied();
                Self { $($field: values.next().unwrap_or(f64::NAN),)+ $($other: $value)? }
            }

            /// Refuses parameters without meaning: masses and knots that are not positive, knots that do not rise,
            /// values that are not finite.
            pub fn check(&self) -> Result<(), LumpedError> {
                self.structure().map(drop)
            }
        }
    };
}

/// One mass on a spring and a damper in parallel: `m x'' = -k x - c x'`.
///
/// The first model of the single-mass paper (section 3.1 there). Any damping: undamped, underdamped, critical,
/// overdamped. With damping the acceleration starts at `-c v0/m`, a jump that a real structure does not show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kelvin {
    /// Mass, kg, positive.
    pub mass_kg: f64,
    /// Spring, N/m.
    pub stiffness_n_per_m: f64,
    /// Damper, N·s/m.
    pub damping_n_s_per_m: f64,
}

values!(Kelvin { mass_kg, stiffness_n_per_m, damping_n_s_per_m });

impl Kelvin {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::Kelvin, &self.values())?;
        constants(&[self.mass_kg], &[self.stiffness_n_per_m], &[self.damping_n_s_per_m])
    }

    /// `x'' + (c/m) x' + (k/m) x = 0`.
    fn equation(&self) -> SecondOrder {
        SecondOrder {
            half_damping: 0.5 * self.damping_n_s_per_m / self.mass_kg,
            stiffness: self.stiffness_n_per_m / self.mass_kg,
        }
    }

    /// Natural frequency `sqrt(k/m)`, rad/s; `None` without a positive stiffness.
    pub fn natural_frequency_rad_per_s(&self) -> Option<f64> {
        (self.stiffness_n_per_m > 0.0).then(|| (self.stiffness_n_per_m / self.mass_kg).sqrt())
    }

    /// Damping ratio `c/(2 sqrt(k m))`; `None` without a positive stiffness.
    pub fn damping_ratio(&self) -> Option<f64> {
        self.natural_frequency_rad_per_s().map(|w| 0.5 * self.damping_n_s_per_m / (self.mass_kg * w))
    }

    /// The exact state at `t_s >= 0`.
    pub fn state(&self, impact_speed_m_per_s: f64, t_s: f64) -> State {
        let equation = self.equation();
        let x = impact_speed_m_per_s * equation.kernel(t_s).1;
        let v = impact_speed_m_per_s * equation.step_rate(t_s);
        State {
            displacement_m: x,
            velocity_m_per_s: v,
            acceleration_m_per_s2: -(equation.stiffness * x + 2.0 * equation.half_damping * v),
        }
    }

    /// Dynamic crush and rebound, closed form: `t_m = acos(ζ)/(ω sqrt(1-ζ²))`, `C = v0/ω·e^(-ζ ω t_m)`, rebound at
    /// `2 t_m` (single-mass paper, equations 2 and 3, continued to ζ >= 1). None without a positive stiffness, or
    /// with so negative a damping that the motion only grows.
    pub fn events(&self, impact_speed_m_per_s: f64) -> CrushEvents {
        let equation = self.equation();
        let (a, b) = (equation.half_damping, equation.stiffness);
        if b <= 0.0 {
            return CrushEvents::default();
        }
        let t = match equation.roots() {
            Roots::Complex { w } => w.atan2(a) / w,
            Roots::Real { .. } if a < 0.0 => return CrushEvents::default(),
            Roots::Real { s: 0.0, .. } => 1.0 / a,
            // ln((a+s)/(a-s))/(2s), written so that neither a - s nor s -> 0 costs digits.
            Roots::Real { s, .. } => ((a - b.sqrt() + s) / b.sqrt()).ln_1p() / s,
        };
        CrushEvents {
            time_of_dynamic_crush_s: Some(t),
            dynamic_crush_m: Some(impact_speed_m_per_s / b.sqrt() * (-a * t).exp()),
            time_of_rebound_s: Some(2.0 * t),
            rebound_velocity_m_per_s: Some(self.state(impact_speed_m_per_s, 2.0 * t).velocity_m_per_s),
        }
    }
}

/// One mass on a spring and a damper in series: `m x'' = -F`, `F' = k x' - (k/c) F`, `F(0) = 0`.
///
/// The velocity solves `v'' + (k/c) v' + (k/m) v = 0` with `v(0) = v0`, `v'(0) = 0`; the mass comes to rest at
/// `m v0/c`. Single-mass paper, section 3.3. With real roots the velocity never reaches zero: no dynamic crush.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Maxwell {
    /// Mass, kg, positive.
    pub mass_kg: f64,
    /// Spring, N/m, positive.
    pub stiffness_n_per_m: f64,
    /// Damper, N·s/m, positive.
    pub damping_n_s_per_m: f64,
}

values!(Maxwell { mass_kg, stiffness_n_per_m, damping_n_s_per_m });

impl Maxwell {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::Maxwell, &self.values())?;
        let Self { stiffness_n_per_m, damping_n_s_per_m, .. } = *self;
        Structure::row(&[self.mass_kg], [vec![SeriesSpringDamper { stiffness_n_per_m, damping_n_s_per_m }.into()]])
    }

    /// `v'' + (k/c) v' + (k/m) v = 0`.
    fn equation(&self) -> SecondOrder {
        SecondOrder {
            half_damping: 0.5 * self.stiffness_n_per_m / self.damping_n_s_per_m,
            stiffness: self.stiffness_n_per_m / self.mass_kg,
        }
    }

    /// The exact state at `t_s >= 0`. The displacement is the difference of two terms of size `m v0/c` or less, so
    /// near contact its absolute error is about `1e-16·(m v0/c)`.
    pub fn state(&self, impact_speed_m_per_s: f64, t_s: f64) -> State {
        let equation = self.equation();
        let a = equation.half_damping;
        let (cosine, sine) = equation.kernel(t_s);
        let v = impact_speed_m_per_s * (cosine + a * sine);
        let acceleration = -impact_speed_m_per_s * equation.stiffness * sine;
        // Integral of the equation of motion: v' + 2a (v - v0) + b x = 0.
        let x = (2.0 * a * (impact_speed_m_per_s - v) - acceleration) / equation.stiffness;
        State { displacement_m: x, velocity_m_per_s: v, acceleration_m_per_s2: acceleration }
    }

    /// Dynamic crush at `(π - atan2(w, a))/w` and rebound at `π/w`, for complex roots `-a ± i w` only.
    pub fn events(&self, impact_speed_m_per_s: f64) -> CrushEvents {
        let equation = self.equation();
        let Roots::Complex { w } = equation.roots() else {
            return CrushEvents::default();
        };
        let t = (PI - w.atan2(equation.half_damping)) / w;
        CrushEvents {
            time_of_dynamic_crush_s: Some(t),
            dynamic_crush_m: Some(self.state(impact_speed_m_per_s, t).displacement_m),
            time_of_rebound_s: Some(PI / w),
            rebound_velocity_m_per_s: Some(self.state(impact_speed_m_per_s, PI / w).velocity_m_per_s),
        }
    }
}

/// One mass on a spring that unloads stiffer than it loads.
///
/// Loads along `k_E` until the velocity is zero at `(t_m, C)`, then moves on `k_P` about the permanent set
/// `C - d_e`, `d_e = C k_E/k_P`: the force is continuous at `C`. Single-mass paper, section 3.2, equations 9 to 15.
/// The paper keeps the mass attached, so it oscillates about the set for ever; with `release` the contact opens
/// when the force is zero and the mass leaves with `-v0 sqrt(k_E/k_P)`. Piecewise closed form, no step error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastoplastic {
    /// Mass, kg, positive.
    pub mass_kg: f64,
    /// Stiffness while loading `k_E`, N/m, positive.
    pub loading_stiffness_n_per_m: f64,
    /// Stiffness after dynamic crush `k_P`, N/m, positive; a structure has `k_P >= k_E`.
    pub unloading_stiffness_n_per_m: f64,
    /// Whether the contact opens at zero force.
    pub release: bool,
}

values!(Elastoplastic { mass_kg, loading_stiffness_n_per_m, unloading_stiffness_n_per_m | release: true });

impl Elastoplastic {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::Elastoplastic, &self.values())?;
        let spring = PlasticSpring {
            loading_stiffness_n_per_m: self.loading_stiffness_n_per_m,
            unloading_stiffness_n_per_m: self.unloading_stiffness_n_per_m,
            release: self.release,
        };
        Structure::row(&[self.mass_kg], [vec![spring.into()]])
    }

    /// Angular frequencies of loading and unloading, `sqrt(k_E/m)` and `sqrt(k_P/m)`, rad/s.
    fn frequencies(&self) -> (f64, f64) {
        (
            (self.loading_stiffness_n_per_m / self.mass_kg).sqrt(),
            (self.unloading_stiffness_n_per_m / self.mass_kg).sqrt(),
        )
    }

    /// Coefficient of restitution `e = sqrt(k_E/k_P)`; the energy returned is `e²` of the energy absorbed.
    pub fn coefficient_of_restitution(&self) -> f64 {
        (self.loading_stiffness_n_per_m / self.unloading_stiffness_n_per_m).sqrt()
    }

    /// Permanent set `C - d_e`, m: where the force is zero after unloading.
    pub fn permanent_set_m(&self, impact_speed_m_per_s: f64) -> f64 {
        let crush = impact_speed_m_per_s / self.frequencies().0;
        crush * (1.0 - self.loading_stiffness_n_per_m / self.unloading_stiffness_n_per_m)
    }

    /// Dynamic crush and rebound, closed form.
    pub fn events(&self, impact_speed_m_per_s: f64) -> CrushEvents {
        let (loading, unloading) = self.frequencies();
        let t_m = FRAC_PI_2 / loading;
        CrushEvents {
            time_of_dynamic_crush_s: Some(t_m),
            dynamic_crush_m: Some(impact_speed_m_per_s / loading),
            time_of_rebound_s: Some(t_m + FRAC_PI_2 / unloading),
            rebound_velocity_m_per_s: Some(-impact_speed_m_per_s * self.coefficient_of_restitution()),
        }
    }
}

/// One mass on a stiffening spring and a damper that weakens with speed: the first nonlinear model of the single-mass
/// paper (section 4).
///
/// `m x'' = -k(|x|) x - c(|v|) v`: a secant stiffness that multiplies the displacement, not a tangent one that is
/// integrated (only this reading reproduces the paper). `k` is linear from `k1` at 0 to `k2` at the crush `C`, `c` from
/// `c1` at rest over `c2` at `v_thresh` to `c3` at the impact speed `v0`; constant beyond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nonlinear1 {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Secant stiffness at contact, N/m.
    pub k1_n_per_m: f64,
    /// Secant stiffness at `crush_m`, N/m.
    pub k2_n_per_m: f64,
    /// Damping at rest, N·s/m.
    pub c1_n_s_per_m: f64,
    /// Damping at `v_thresh_m_per_s`, N·s/m.
    pub c2_n_s_per_m: f64,
    /// Damping at `v0_m_per_s`, N·s/m.
    pub c3_n_s_per_m: f64,
    /// Speed of the knee of the damper, m/s.
    pub v_thresh_m_per_s: f64,
    /// Displacement of the last knot of the spring, m: the dynamic crush of the test it was fitted to.
    pub crush_m: f64,
    /// Speed of the last knot of the damper, m/s: the impact speed of that test.
    pub v0_m_per_s: f64,
}

/// The second nonlinear model of the single-mass paper (section 5): ten parameters.
///
/// As [`Nonlinear1`], with `k` through `(0, k1), (x1, k2), (C, k3)` and `c` through
/// `(0, c1), (v1, c2), (v2, c3), (v0, c4)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nonlinear2 {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Secant stiffness at contact, N/m.
    pub k1_n_per_m: f64,
    /// Secant stiffness at `x1_m`, N/m.
    pub k2_n_per_m: f64,
    /// Secant stiffness at `crush_m`, N/m.
    pub k3_n_per_m: f64,
    /// Displacement of the middle knot, m, below `crush_m`.
    pub x1_m: f64,
    /// Damping at rest, N·s/m.
    pub c1_n_s_per_m: f64,
    /// Damping at `v1_m_per_s`, N·s/m.
    pub c2_n_s_per_m: f64,
    /// Damping at `v2_m_per_s`, N·s/m.
    pub c3_n_s_per_m: f64,
    /// Damping at `v0_m_per_s`, N·s/m.
    pub c4_n_s_per_m: f64,
    /// First knee of the damper, m/s.
    pub v1_m_per_s: f64,
    /// Second knee, m/s, above the first and below `v0_m_per_s`.
    pub v2_m_per_s: f64,
    /// Displacement of the last knot of the spring, m.
    pub crush_m: f64,
    /// Speed of the last knot of the damper, m/s.
    pub v0_m_per_s: f64,
}

values!(Nonlinear1 {
    mass_kg,
    k1_n_per_m,
    k2_n_per_m,
    c1_n_s_per_m,
    c2_n_s_per_m,
    c3_n_s_per_m,
    v_thresh_m_per_s,
    crush_m,
    v0_m_per_s
});
values!(Nonlinear2 {
    mass_kg,
    k1_n_per_m,
    k2_n_per_m,
    k3_n_per_m,
    x1_m,
    c1_n_s_per_m,
    c2_n_s_per_m,
    c3_n_s_per_m,
    c4_n_s_per_m,
    v1_m_per_s,
    v2_m_per_s,
    crush_m,
    v0_m_per_s
});

/// One mass on a spring and a damper through these knots.
fn one_mass(mass_kg: f64, spring: &[(f64, f64)], damper: &[(f64, f64)]) -> Result<Structure, LumpedError> {
    let (spring, damper) = (Spring(PiecewiseLinear::new(spring)?), Damper(PiecewiseLinear::new(damper)?));
    Structure::row(&[mass_kg], [vec![spring.into(), damper.into()]])
}

macro_rules! responses {
    ($model:ty) => {
        impl $model {
            /// Dynamic crush and rebound within two seconds, on the series themselves.
            pub fn events(&self, impact_speed_m_per_s: f64) -> Result<CrushEvents, LumpedError> {
                Ok(self.structure()?.events(impact_speed_m_per_s, 2.0)?[0])
            }
        }
    };
}

responses!(Nonlinear1);
responses!(Nonlinear2);

/// Spring through two knots, damper through three.
impl Nonlinear1 {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::Nonlinear1, &self.values())?;
        let spring = [(0.0, self.k1_n_per_m), (self.crush_m, self.k2_n_per_m)];
        let damper = [
            (0.0, self.c1_n_s_per_m),
            (self.v_thresh_m_per_s, self.c2_n_s_per_m),
            (self.v0_m_per_s, self.c3_n_s_per_m),
        ];
        one_mass(self.mass_kg, &spring, &damper)
    }
}

impl Nonlinear2 {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::Nonlinear2, &self.values())?;
        let spring = [(0.0, self.k1_n_per_m), (self.x1_m, self.k2_n_per_m), (self.crush_m, self.k3_n_per_m)];
        let damper = [
            (0.0, self.c1_n_s_per_m),
            (self.v1_m_per_s, self.c2_n_s_per_m),
            (self.v2_m_per_s, self.c3_n_s_per_m),
            (self.v0_m_per_s, self.c4_n_s_per_m),
        ];
        one_mass(self.mass_kg, &spring, &damper)
    }
}

/// Two masses in a row: barrier - (k1, c1) - chassis m1 - (k2, c2) - passenger compartment m2.
///
/// `m1 x1'' = -k1 x1 - c1 x1' + k2 (x2 - x1) + c2 (x2' - x1')`, `m2 x2'' = -k2 (x2 - x1) - c2 (x2' - x1')`, both
/// masses at `v0` at contact. Index 1 is next to the barrier, as in both two-mass papers.
///
/// **What the compartment cannot tell.** With `mu = (m1 + m2)/m2`, the model [`dual`](Self::dual)
/// `(mu k2, k1/mu, mu c2, c1/mu)` has exactly the same compartment motion; only the chassis moves differently.
/// An accelerometer in the compartment therefore never decides between the two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleSpringMassDamper {
    /// Mass of the chassis, kg, positive.
    pub m1_kg: f64,
    /// Mass of the compartment, kg, positive.
    pub m2_kg: f64,
    /// Spring between barrier and chassis, N/m.
    pub k1_n_per_m: f64,
    /// Spring between chassis and compartment, N/m.
    pub k2_n_per_m: f64,
    /// Damper between barrier and chassis, N·s/m.
    pub c1_n_s_per_m: f64,
    /// Damper between chassis and compartment, N·s/m.
    pub c2_n_s_per_m: f64,
}

values!(DoubleSpringMassDamper { m1_kg, m2_kg, k1_n_per_m, k2_n_per_m, c1_n_s_per_m, c2_n_s_per_m });

impl DoubleSpringMassDamper {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::DoubleSpringMassDamper, &self.values())?;
        let (springs, dampers) = ([self.k1_n_per_m, self.k2_n_per_m], [self.c1_n_s_per_m, self.c2_n_s_per_m]);
        constants(&[self.m1_kg, self.m2_kg], &springs, &dampers)
    }

    /// The other parameter set with the same masses and the same compartment record.
    ///
    /// Why: the compartment's response depends on the characteristic polynomial and on `c1 c2` only, and the map
    /// exchanges `(m2 c1, m2 k1)` with `((m1+m2) c2, (m1+m2) k2)`, in which all of these are symmetric. Applying
    /// it twice returns to the start; positive parameters stay positive.
    pub fn dual(&self) -> Self {
        let mu = (self.m1_kg + self.m2_kg) / self.m2_kg;
        Self {
            k1_n_per_m: mu * self.k2_n_per_m,
            k2_n_per_m: self.k1_n_per_m / mu,
            c1_n_s_per_m: mu * self.c2_n_s_per_m,
            c2_n_s_per_m: self.c1_n_s_per_m / mu,
            ..*self
        }
    }

    /// `A` of `z' = A z`, state `(x1, x2, x1', x2')`, SI.
    pub fn state_matrix(&self) -> Matrix4<f64> {
        let (m1, m2) = (self.m1_kg, self.m2_kg);
        let (k1, k2, c1, c2) = (self.k1_n_per_m, self.k2_n_per_m, self.c1_n_s_per_m, self.c2_n_s_per_m);
        #[rustfmt::skip]
        let a = Matrix4::new(
            0.0,             0.0,      1.0,             0.0,
            0.0,             0.0,      0.0,             1.0,
            -(k1 + k2) / m1, k2 / m1,  -(c1 + c2) / m1, c2 / m1,
            k2 / m2,         -k2 / m2, c2 / m2,         -c2 / m2,
        );
        a
    }

    /// Characteristic polynomial `s^4 + t s^3 + u s^2 + v s + w`, highest power first.
    pub fn characteristic_polynomial(&self) -> [f64; 5] {
        let (m1, m2) = (self.m1_kg, self.m2_kg);
        let (k1, k2, c1, c2) = (self.k1_n_per_m, self.k2_n_per_m, self.c1_n_s_per_m, self.c2_n_s_per_m);
        let product = m1 * m2;
        [
            1.0,
            (m1 * c2 + m2 * (c1 + c2)) / product,
            (m1 * k2 + m2 * (k1 + k2) + c1 * c2) / product,
            (c1 * k2 + c2 * k1) / product,
            k1 * k2 / product,
        ]
    }

    /// The four poles, 1/s, sorted by `|Im|`, then `Re`, the positive imaginary part first. Errors: parameters so
    /// extreme that the roots of the characteristic polynomial are not found.
    pub fn poles(&self) -> Result<Vec<Complex>, LumpedError> {
        Ok(polynomial_roots(&self.characteristic_polynomial())?)
    }

    /// Dynamic crush and rebound of chassis and compartment, by root finding on the exact solution.
    pub fn events(&self, impact_speed_m_per_s: f64) -> Result<Vec<CrushEvents>, LumpedError> {
        self.structure()?.events(impact_speed_m_per_s, f64::INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kelvin(ratio: f64) -> Kelvin {
        let (m, k) = (1000.0, 4e5);
        Kelvin { mass_kg: m, stiffness_n_per_m: k, damping_n_s_per_m: 2.0 * ratio * f64::sqrt(k * m) }
    }

    #[test]
    fn velocity_vanishes_at_the_crush_time_for_every_damping() {
        for ratio in [0.0, 1e-9, 0.2, 0.999_999_9, 1.0, 1.000_000_1, 1.5, 20.0, 1e4] {
            let model = kelvin(ratio);
            let events = model.events(15.0);
            let (t, c) = (events.time_of_dynamic_crush_s.unwrap(), events.dynamic_crush_m.unwrap());
            let state = model.state(15.0, t);
            // The two expressions for C agree to rounding; velocity at t_m is rounding of the deceleration times t_m.
            assert!(
                (state.displacement_m - c).abs() < 4e-15 * (1.0 + ratio) * c,
                "ratio {ratio}: {} {c}",
                state.displacement_m
            );
            assert!(state.velocity_m_per_s.abs() < 2e-13, "ratio {ratio}: {}", state.velocity_m_per_s);
            let rebound = model.state(15.0, events.time_of_rebound_s.unwrap());
            assert!(rebound.acceleration_m_per_s2.abs() < 1e-9, "ratio {ratio}: {}", rebound.acceleration_m_per_s2);
        }
    }

    #[test]
    fn passes_through_critical_damping_without_a_step() {
        let at = |ratio: f64| kelvin(ratio).state(15.0, 0.1);
        // dx/dratio is of order 0.3 m: 2e-9 apart in ratio is 1e-9 m apart at most.
        let (below, on, above) = (at(1.0 - 1e-9), at(1.0), at(1.0 + 1e-9));
        assert!((below.displacement_m - on.displacement_m).abs() < 1e-9);
        assert!((above.displacement_m - on.displacement_m).abs() < 1e-9);
        assert!((below.velocity_m_per_s - above.velocity_m_per_s).abs() < 1e-7);
        assert!(below.displacement_m > on.displacement_m && on.displacement_m > above.displacement_m);
    }

    #[test]
    fn a_mass_without_a_spring_never_stops() {
        let coasting = Kelvin { mass_kg: 1000.0, stiffness_n_per_m: 0.0, damping_n_s_per_m: 5000.0 };
        assert_eq!(coasting.events(10.0), CrushEvents::default());
        // x = m v0/c (1 - e^(-c t/m))
        let state = coasting.state(10.0, 0.2);
        assert!((state.displacement_m - 2.0 * (1.0 - f64::exp(-1.0))).abs() < 1e-15);
        let free = Kelvin { damping_n_s_per_m: 0.0, ..coasting }.state(10.0, 0.2);
        assert_eq!((free.displacement_m, free.velocity_m_per_s), (2.0, 10.0));
    }

    #[test]
    fn creeps_to_its_final_place_without_stopping_when_overdamped() {
        let soft = Maxwell { mass_kg: 900.0, stiffness_n_per_m: 1e6, damping_n_s_per_m: 5e3 };
        assert_eq!(soft.events(10.0), CrushEvents::default());
        let end = soft.state(10.0, 5.0);
        // e^(-5.7 · 5) of 1.8 m is left.
        assert!((end.displacement_m - 900.0 * 10.0 / 5e3).abs() < 1e-11, "{}", end.displacement_m);
    }
}
