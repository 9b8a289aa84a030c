//! One mass on a spring and a damper, in closed form: the sample's crash and its candidates' responses.

use crumple_signal::Sampled;

pub(super) const DT_S: f64 = 1e-4;
pub(super) const BEFORE: u32 = 200;
pub(super) const AFTER: u32 = 1501;

/// `m x'' = -k x - c x'`, `x(0) = 0`, `x'(0) = v0`, underdamped.
#[derive(Clone, Copy)]
pub(super) struct Kelvin {
    pub(super) mass_kg: f64,
    pub(super) stiffness_n_per_m: f64,
    pub(super) damping_n_s_per_m: f64,
    pub(super) v0: f64,
}

impl Kelvin {
    pub(super) fn poles(self) -> (f64, f64) {
        let sigma = self.damping_n_s_per_m / (2.0 * self.mass_kg);
        (sigma, (self.stiffness_n_per_m / self.mass_kg - sigma * sigma).sqrt())
    }

    /// Displacement, velocity, acceleration at `t` seconds after contact.
    pub(super) fn at(self, t: f64) -> [f64; 3] {
        if t < 0.0 {
            return [self.v0 * t, self.v0, 0.0];
        }
        let (sigma, omega) = self.poles();
        let (sin, cos) = (omega * t).sin_cos();
        let decay = (-sigma * t).exp() * self.v0;
        let x = decay * sin / omega;
        let v = decay * (cos - sigma * sin / omega);
        let a = (-self.stiffness_n_per_m * x - self.damping_n_s_per_m * v) / self.mass_kg;
        [x, v, a]
    }

    pub(super) fn time_of_crush(self) -> f64 {
        let (sigma, omega) = self.poles();
        omega.atan2(sigma) / omega
    }
}

pub(super) const TEST: Kelvin =
    Kelvin { mass_kg: 873.0, stiffness_n_per_m: 330_000.0, damping_n_s_per_m: 2_500.0, v0: 35.0 / 3.6 };

pub(super) fn wave(before: u32, samples: u32, f: impl Fn(f64) -> f64) -> Sampled {
    let t0_s = -f64::from(before) * DT_S;
    Sampled::new(t0_s, DT_S, (0..samples).map(|k| f(t0_s + f64::from(k) * DT_S)).collect()).unwrap()
}

pub(super) fn record_wave(f: impl Fn(f64) -> f64) -> Sampled {
    wave(BEFORE, BEFORE + AFTER, f)
}
