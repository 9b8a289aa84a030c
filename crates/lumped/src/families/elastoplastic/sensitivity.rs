//! Derivatives of the elastoplastic motion: its closed form, differentiated.
//!
//! The motion depends on mass and stiffnesses through two frequencies only, `w = sqrt(k_E/m)` of loading and
//! `q = sqrt(k_P/m)` of unloading. Its derivatives by them are written out for loading, unloading and free flight, and
//! the chain rule gives those by the parameters: `dw/dm = -w/(2 m)`, `dw/dk_E = w/(2 k_E)`, `dq/dm = -q/(2 m)`,
//! `dq/dk_P = q/(2 k_P)`. The instant of dynamic crush `t_m = pi/(2 w)` moves with `w`, which the derivatives of the
//! unloading contain. Right to rounding; at `t_m` itself the acceleration has a kink and the side of loading is given.

use std::f64::consts::FRAC_PI_2;

use crate::{Elastoplastic, Instants, Motion, Sensitivity, State};

/// Motion and derivatives by mass, loading and unloading stiffness (places 0, 1, 2).
pub(crate) fn elastoplastic(model: &Elastoplastic, v0: f64, at: &Instants, parameters: &[usize]) -> Sensitivity {
    let (m, loading, unloading) = (model.mass_kg, model.loading_stiffness_n_per_m, model.unloading_stiffness_n_per_m);
    let (w, q) = ((loading / m).sqrt(), (unloading / m).sqrt());
    let mut motion = Motion::with_capacity(at.samples);
    let mut derivatives = vec![vec![Motion::with_capacity(at.samples)]; parameters.len()];
    for k in 0..at.samples {
        let t = at.first_s + k as f64 * at.dt_s;
        motion.push(model.state(v0, t));
        let (by_w, by_q) = by_frequencies(model.release, v0, w, q, t);
        for (place, derivative) in parameters.iter().zip(&mut derivatives) {
            // w and q are roots of stiffness over mass.
            let (dw, dq) = match place {
                0 => (-0.5 * w / m, -0.5 * q / m),
                1 => (0.5 * w / loading, 0.0),
                _ => (0.0, 0.5 * q / unloading),
            };
            let sum = |of: fn(&State) -> f64| dw * of(&by_w) + dq * of(&by_q);
            derivative[0].push(State {
                displacement_m: sum(|s| s.displacement_m),
                velocity_m_per_s: sum(|s| s.velocity_m_per_s),
                acceleration_m_per_s2: sum(|s| s.acceleration_m_per_s2),
            });
        }
    }
    Sensitivity { motions: vec![motion], derivatives }
}

/// Derivatives of the state by the frequencies of loading and unloading.
///
/// Per rad/s. `t` after contact, s; with `release` the flight after the contact opens at zero force.
fn by_frequencies(release: bool, v0: f64, w: f64, q: f64, t: f64) -> (State, State) {
    let state = |x, v, a| State { displacement_m: x, velocity_m_per_s: v, acceleration_m_per_s2: a };
    let t_m = FRAC_PI_2 / w;
    if t <= t_m {
        let (sine, cosine) = (w * t).sin_cos();
        let by_w = state(v0 * (t * cosine - sine / w) / w, -v0 * t * sine, -v0 * (sine + w * t * cosine));
        return (by_w, state(0.0, 0.0, 0.0));
    }
    // x = set + depth cos(q tau), tau = t - t_m.
    let tau = t - t_m;
    let tau_w = t_m / w;
    let depth = v0 * w / (q * q);
    let (depth_w, depth_q) = (v0 / (q * q), -2.0 * depth / q);
    let (set_w, set_q) = (-v0 / (w * w) - depth_w, -depth_q);
    let opens = FRAC_PI_2 / q;
    if release && tau >= opens {
        let speed = -depth * q;
        let (speed_w, speed_q) = (-v0 / q, v0 * w / (q * q));
        let since = tau - opens;
        return (
            state(set_w + speed_w * since + speed * tau_w, speed_w, 0.0),
            state(set_q + speed_q * since + speed * opens / q, speed_q, 0.0),
        );
    }
    let (sine, cosine) = (q * tau).sin_cos();
    let by_w = state(
        set_w + depth_w * cosine - depth * q * sine * tau_w,
        -q * (depth_w * sine + depth * q * cosine * tau_w),
        q * q * (depth * q * sine * tau_w - depth_w * cosine),
    );
    let by_q = state(
        set_q + depth_q * cosine - depth * tau * sine,
        -depth_q * q * sine - depth * sine - depth * q * tau * cosine,
        -depth_q * q * q * cosine - 2.0 * depth * q * cosine + depth * q * q * tau * sine,
    );
    (by_w, by_q)
}
