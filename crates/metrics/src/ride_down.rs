use crumple_signal::{Acceleration, Signal};

use crate::cumulative;
use crate::definitions::{OCCUPANT_TRAVEL, RESTRAINT, RIDE_DOWN};
use crate::{Metric, MetricsError, same_grid};

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
    /// The three shares less 1: rounding, whatever the pulses are.
    pub fn residual(&self) -> Option<f64> {
        Some(self.efficiency.value? + self.restraint.value? + self.left - 1.0)
    }
}

/// Ride-down of an occupant with deceleration `occupant` in a vehicle with `vehicle`, both from time zero at
/// `impact_speed_m_per_s`, over the whole of both signals.
///
/// `μ = (2/v0²)·∫(-a_o)·v dt`, restraint `(2/v0²)·∫(-a_o)(v_o - v) dt`, by the trapezoid in the occupant's velocity,
/// `Σ -Δv_o·v̄`, so that both and the energy left close identically. Error O(T²). Errors: grids that differ, a speed
/// that is not positive.
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
    let v = cumulative::from(v0, vehicle.samples(), dt);
    let v_o = cumulative::from(v0, occupant.samples(), dt);
    let (mut crush, mut belt, mut travel) = (0.0, 0.0, 0.0);
    let mut largest = (0.0, 0);
    for k in 1..v.len() {
        let given = v_o[k - 1] - v_o[k];
        let (mean, mean_o) = ((v[k - 1] + v[k]) / 2.0, (v_o[k - 1] + v_o[k]) / 2.0);
        crush += given * mean;
        belt += given * (mean_o - mean);
        travel += dt * (mean_o - mean);
        if travel > largest.0 {
            largest = (travel, k);
        }
    }
    let share = 2.0 / (v0 * v0);
    let (from_s, to_s, at_s) = (vehicle.t0_s(), vehicle.end_s(), vehicle.time_s(largest.1));
    Ok(RideDown {
        efficiency: Metric::found(&RIDE_DOWN, share * crush).over(from_s, to_s),
        restraint: Metric::found(&RESTRAINT, share * belt).over(from_s, to_s),
        largest_travel: Metric::found(&OCCUPANT_TRAVEL, largest.0).over(at_s, at_s),
        left: (v_o[v_o.len() - 1] / v0).powi(2),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_occupant_tied_to_the_vehicle_rides_down_with_it() {
        let a = Signal::new(0.0, 0.5, vec![-1.0; 9]).unwrap();
        let found = ride_down(&a, &a, 4.0).unwrap();
        assert_eq!((found.efficiency.value, found.restraint.value, found.left), (Some(1.0), Some(0.0), 0.0));
        assert_eq!(found.residual(), Some(0.0));
        assert_eq!(ride_down(&a, &a, 0.0).unwrap_err().to_string(), "impact speed 0 m/s is not a positive number");
    }
}
