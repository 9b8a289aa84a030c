//! The occupant load criterion.
//!
//! The occupant flies free over 65 mm and is then brought to the speed of the vehicle at a constant deceleration over
//! 235 mm of restraint: that deceleration is the criterion.

use crumple_signal::{Displacement, Signal, Velocity};

use crate::metric::definitions::OLC;
use crate::metric::grid::same_grid;
use crate::{Metric, MetricsError};

/// The two lengths of the occupant load criterion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OlcOptions {
    /// Free flight, m: 65 mm.
    pub free_flight_m: f64,
    /// Travel in the restraint, m: 235 mm (0.0235 in a tool's manual is a misprint).
    pub restraint_m: f64,
}

impl Default for OlcOptions {
    fn default() -> Self {
        Self { free_flight_m: 0.065, restraint_m: 0.235 }
    }
}

/// Occupant load criterion, m/s²; window t1..t2 from time zero.
///
/// With `s(t) = ∫ (v0 - v) dt = v0·t - x`: free flight at v0 until `s(t1)` = 65 mm; then a constant deceleration that
/// ends, after 235 mm more, at the vehicle's own speed: the first root t2 of `G(t) = s - (v0 - v)·(t - t1)/2 - 0.3 m`,
/// and `OLC = (v0 - v(t2))/(t2 - t1)`. s, G and v are linear between samples; t1 and t2 on the grid would err by 0.3 %.
/// Constant deceleration a: `t1 = sqrt(0.13/a)`, `t2 = 0.6/(a·t1)`. Absent where a length is not reached.
/// Euro NCAP TB 027.
pub fn olc(
    velocity: &Signal<Velocity>,
    displacement: &Signal<Displacement>,
    impact_speed_m_per_s: f64,
    time_zero_s: f64,
    options: OlcOptions,
) -> Result<Metric, MetricsError> {
    same_grid(("the velocity", velocity), ("the displacement", displacement))?;
    let (v, x, v0) = (velocity.samples(), displacement.samples(), impact_speed_m_per_s);
    let OlcOptions { free_flight_m, restraint_m } = options;
    let t = |k: usize| velocity.time_s(k) - time_zero_s;
    let s = |k: usize| v0 * t(k) - x[k];

    let zero = velocity.index_at_or_after(time_zero_s);
    let Some(k1) = (zero..v.len()).find(|&k| s(k) >= free_flight_m) else {
        return Ok(Metric::absent(&OLC, &format!("the free flight of {free_flight_m} m is not reached in the record")));
    };
    let (t1, v1) = if k1 > zero {
        let w = (free_flight_m - s(k1 - 1)) / (s(k1) - s(k1 - 1));
        (t(k1 - 1) + w * velocity.dt_s(), v[k1 - 1] + w * (v[k1] - v[k1 - 1]))
    } else {
        (t(k1), v[k1])
    };

    let g = |k: usize| s(k) - (v0 - v[k]) * (t(k) - t1) / 2.0 - free_flight_m - restraint_m;
    let mut before = (t1, v1, -restraint_m);
    for (k, &v_now) in v.iter().enumerate().skip(k1) {
        let now = (t(k), v_now, g(k));
        if now.2 >= 0.0 && now.0 > before.0 {
            let w = -before.2 / (now.2 - before.2);
            let t2 = before.0 + w * (now.0 - before.0);
            let v2 = before.1 + w * (now.1 - before.1);
            return Ok(Metric::with_value(&OLC, (v0 - v2) / (t2 - t1)).over(t1, t2));
        }
        before = now;
    }
    Ok(Metric::absent(&OLC, &format!("the restraint travel of {restraint_m} m is not reached in the record")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn constant(a: f64, v0: f64, n: usize, dt: f64) -> Metric {
        let at = |k: usize| k as f64 * dt;
        let v = Signal::new(0.0, dt, (0..n).map(|k| v0 - a * at(k)).collect()).unwrap();
        let x = Signal::new(0.0, dt, (0..n).map(|k| v0 * at(k) - a * at(k) * at(k) / 2.0).collect()).unwrap();
        olc(&v, &x, v0, 0.0, OlcOptions::default()).unwrap()
    }

    #[test]
    fn a_constant_deceleration_follows_the_formula() {
        for a in [50.0, 200.0, 431.0] {
            let olc = constant(a, 30.0, 4000, 1e-4);
            let t1 = (0.13_f64 / a).sqrt();
            let t2 = 0.6 / (a * t1);
            let window = olc.window.unwrap();
            // s is quadratic, its chord is off by a·T²/8 = 5e-7 m of slopes above 2 m/s.
            assert!((window.from_s - t1).abs() < 2e-7 && (window.to_s - t2).abs() < 1e-6, "{window:?}");
            assert!((olc.value.unwrap() / (a * t2 / (t2 - t1)) - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn a_pulse_that_is_too_short_or_too_soft_says_which_length_is_missing() {
        assert_eq!(
            constant(200.0, 30.0, 200, 1e-4).definition,
            "absent: the free flight of 0.065 m is not reached in the record"
        );
        assert_eq!(
            constant(200.0, 30.0, 400, 1e-4).definition,
            "absent: the restraint travel of 0.235 m is not reached in the record"
        );
    }
}
