//! Ride-down: the share of an occupant's energy that the vehicle's crush takes.

use crumple_signal::{Acceleration, Signal};

use crate::metric::definitions::{OCCUPANT_TRAVEL, RESTRAINT, RIDE_DOWN};
use crate::metric::grid::same_grid;
use crate::sums;
use crate::{Metric, MetricsError};

/// Where the occupant's energy goes.
#[derive(Debug, Clone, PartialEq)]
pub struct RideDown {
    /// Share that the vehicle's crush takes.
    pub efficiency: Metric,
    /// Share that the restraint takes.
    pub restraint: Metric,
    /// Largest travel of the occupant in the vehicle, m; the window is its moment.
    pub largest_travel: Metric,
    /// Share that is left at the end, `(v_o/v0)²`.
    pub left: f64,
}

impl RideDown {
    /// The three shares less 1: rounding for an occupant at rest in its seat at both ends.
    pub fn residual(&self) -> Option<f64> {
        Some(self.efficiency.value? + self.restraint.value? + self.left - 1.0)
    }
}

/// Ride-down of an occupant with deceleration `occupant` in a vehicle with `vehicle`, both from time zero at
/// `impact_speed_m_per_s`, over the whole of both signals.
///
/// `μ = (2/v0²)·∫(-a_o)·v dt`, restraint `(2/v0²)·∫(-a_o)(v_o - v) dt`, products and velocities by the trapezoid in
/// time. Error O(T²). Both and the energy left sum to 1 up to `T²/4·(a_o(end)² - a_o(0)²)/v0²`: the rest telescopes.
/// Errors: grids that differ, a speed that is not positive.
pub fn ride_down(
    vehicle: &Signal<Acceleration>,
    occupant: &Signal<Acceleration>,
    impact_speed_m_per_s: f64,
) -> Result<RideDown, MetricsError> {
    same_grid(("the vehicle's acceleration", vehicle), ("the occupant's acceleration", occupant))?;
    let v0 = impact_speed_m_per_s;
    if !(v0.is_finite() && v0 > 0.0) {
        return Err(MetricsError::ImpactSpeed(v0));
    }
    let dt = vehicle.dt_s();
    let v = sums::cumulative_from(v0, vehicle.samples(), dt);
    let a_o = occupant.samples();
    let v_o = sums::cumulative_from(v0, a_o, dt);
    let (mut crush, mut belt, mut travel) = (0.0, 0.0, 0.0);
    let mut largest = (0.0, 0);
    for k in 1..v.len() {
        crush -= dt * (a_o[k - 1] * v[k - 1] + a_o[k] * v[k]) / 2.0;
        belt -= dt * (a_o[k - 1] * (v_o[k - 1] - v[k - 1]) + a_o[k] * (v_o[k] - v[k])) / 2.0;
        travel += dt * ((v_o[k - 1] - v[k - 1]) + (v_o[k] - v[k])) / 2.0;
        if travel > largest.0 {
            largest = (travel, k);
        }
    }
    let share = 2.0 / (v0 * v0);
    let (from_s, to_s, at_s) = (vehicle.t0_s(), vehicle.end_s(), vehicle.time_s(largest.1));
    Ok(RideDown {
        efficiency: Metric::with_value(&RIDE_DOWN, share * crush).over(from_s, to_s),
        restraint: Metric::with_value(&RESTRAINT, share * belt).over(from_s, to_s),
        largest_travel: Metric::with_value(&OCCUPANT_TRAVEL, largest.0).over(at_s, at_s),
        left: (v_o[v_o.len() - 1] / v0).powi(2),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_occupant_tied_to_the_vehicle_rides_down_with_it() {
        let a = Signal::new(0.0, 0.5, vec![-1.0; 9]).unwrap();
        let shares = ride_down(&a, &a, 4.0).unwrap();
        assert_eq!((shares.efficiency.value, shares.restraint.value, shares.left), (Some(1.0), Some(0.0), 0.0));
        assert_eq!(shares.residual(), Some(0.0));
        assert_eq!(ride_down(&a, &a, 0.0).unwrap_err().to_string(), "impact speed 0 m/s is not a positive number");
    }
}
