use crumple_signal::{Acceleration, Displacement, Signal, Velocity};

use crate::{
    CrashEvents, MetricsError, absorbed_energy, average_square_wave, average_stiffness, centroid_time_by_moment,
    centroid_time_from_crush, equivalent_square_wave, kinetic_energy, loading_work_per_kg, mean_deceleration, peak,
    same_grid,
};

/// One number about a pulse, with what is needed to print it.
#[derive(Debug, Clone, PartialEq)]
pub struct Metric {
    /// Name, e.g. `peak_acceleration`.
    pub name: &'static str,
    /// Value in [`unit`](Self::unit); `None` where the record does not show it.
    pub value: Option<f64>,
    /// SI unit, `1` for a ratio.
    pub unit: &'static str,
    /// How it is computed and after whom; for a missing value, why it is missing.
    pub definition: String,
}

/// A crash as motion: what [`pulse_metrics`] looks at. The three signals share one grid.
#[derive(Debug, Clone, Copy)]
pub struct Pulse<'a> {
    /// Acceleration, m/s².
    pub acceleration: &'a Signal<Acceleration>,
    /// Velocity, m/s.
    pub velocity: &'a Signal<Velocity>,
    /// Displacement, m, zero at time zero.
    pub displacement: &'a Signal<Displacement>,
    /// Events of this motion.
    pub events: &'a CrashEvents,
    /// Impact speed v0, m/s.
    pub impact_speed_m_per_s: f64,
    /// Test mass, kg, if known.
    pub mass_kg: Option<f64>,
    /// Time zero on the axis of the signals, s.
    pub time_zero_s: f64,
}

/// The metrics of a pulse, always the same names in the same order.
pub fn pulse_metrics(pulse: &Pulse<'_>) -> Result<Vec<Metric>, MetricsError> {
    same_grid(("the acceleration", pulse.acceleration), ("the velocity", pulse.velocity))?;
    same_grid(("the velocity", pulse.velocity), ("the displacement", pulse.displacement))?;
    let (v0, mass, crush, rebound) =
        (pulse.impact_speed_m_per_s, pulse.mass_kg, pulse.events.crush, pulse.events.rebound);
    let peak = peak(pulse.acceleration);
    let work = crush.map(|c| loading_work_per_kg(pulse.acceleration, pulse.displacement, &c)).transpose()?;

    let no_crush = format!("the record ends at v = {:.3} m/s", pulse.events.end_velocity_m_per_s);
    let because = |needs_mass: bool| match crush {
        _ if needs_mass && mass.is_none() => "the mass is not known".to_owned(),
        None => no_crush.clone(),
        Some(_) => "not computable from this record".to_owned(),
    };
    let metric = |name, value: Option<f64>, unit, definition: &str| {
        let value = value.filter(|x| x.is_finite());
        let definition = match value {
            Some(_) => definition.to_owned(),
            None => format!("absent: {}", because(matches!(unit, "J" | "N/m"))),
        };
        Metric { name, value, unit, definition }
    };

    Ok(vec![
        metric(
            "peak_acceleration",
            peak.map(|p| p.acceleration_m_per_s2.abs()),
            "m/s^2",
            "largest |a| of a sample from the start of the integration",
        ),
        metric(
            "time_of_peak_acceleration",
            peak.map(|p| p.time_s - pulse.time_zero_s),
            "s",
            "time of the sample with the largest |a|",
        ),
        metric(
            "dynamic_crush",
            crush.map(|c| c.displacement_m),
            "m",
            "C = x(t_m), displacement at the first zero of velocity",
        ),
        metric(
            "time_of_dynamic_crush",
            crush.map(|c| c.time_s),
            "s",
            "t_m, first zero of velocity, linearly interpolated",
        ),
        metric(
            "centroid_time",
            crush.map(|c| centroid_time_from_crush(c.displacement_m, v0)),
            "s",
            "t_c = C/v0, equal to the centroid of the pulse over 0..t_m (Huang, Vehicle Crash Mechanics, 2002)",
        ),
        metric(
            "centroid_time_by_moment",
            crush.and_then(|c| centroid_time_by_moment(pulse.acceleration, pulse.time_zero_s, c.time_s)),
            "s",
            "integral of t*a over integral of a up to t_m, by trapezoid; equals C/v0 but for the error of sampling and rule",
        ),
        metric(
            "centroid_time_ratio",
            crush.map(|c| centroid_time_from_crush(c.displacement_m, v0) / c.time_s),
            "1",
            "t_c/t_m: 0.5 symmetric, 2/pi an undamped spring, lower front-loaded (Huang, 2002)",
        ),
        metric(
            "delta_v",
            pulse.events.delta_v_m_per_s(v0),
            "m/s",
            "v0 - v_s, impact speed minus the lowest velocity after t_m",
        ),
        metric("coefficient_of_restitution", pulse.events.restitution(v0), "1", "e = -v_s/v0 against a rigid barrier"),
        metric(
            "rebound_displacement",
            crush.zip(rebound).map(|(c, r)| c.displacement_m - r.displacement_m),
            "m",
            "d_e = C - x(t_s), displacement recovered until the lowest velocity",
        ),
        metric(
            "equivalent_square_wave",
            crush.map(|c| equivalent_square_wave(v0, c.displacement_m)),
            "m/s^2",
            "ESW = v0^2/(2C), constant deceleration with the same crush (Huang, 2002)",
        ),
        metric(
            "average_square_wave",
            crush.map(|c| average_square_wave(v0, c.time_s)),
            "m/s^2",
            "ASW = v0/t_m, constant deceleration that stops in the same time (Huang, 2002)",
        ),
        metric(
            "mean_deceleration",
            crush.and_then(|c| mean_deceleration(pulse.velocity, pulse.time_zero_s, pulse.time_zero_s + c.time_s)),
            "m/s^2",
            "x-mean over 0..t_m, (v(0) - v(t_m))/t_m from the integrated velocity",
        ),
        metric(
            "average_stiffness",
            crush.zip(mass).map(|(c, m)| average_stiffness(m, v0, c.displacement_m)),
            "N/m",
            "k = m*v0^2/C^2, linear spring of equal energy",
        ),
        metric("impact_energy", mass.map(|m| kinetic_energy(m, v0)), "J", "m*v0^2/2"),
        metric(
            "energy_absorbed",
            rebound.zip(mass).map(|(r, m)| absorbed_energy(m, v0, r.velocity_m_per_s)),
            "J",
            "m*(v0^2 - v_s^2)/2, impact energy less the energy of the rebound",
        ),
        metric(
            "energy_closure",
            work.map(|w| w / (v0 * v0 / 2.0) - 1.0),
            "1",
            "work of the barrier force up to C over the impact energy, minus 1; 0 but for rounding with the trapezoid",
        ),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crash_events;

    fn metrics_of(mass_kg: Option<f64>, v: Vec<f64>, everywhere_m: f64) -> Vec<Metric> {
        let grid = |samples| Signal::<Velocity>::new(0.0, 0.5, samples).unwrap();
        let a = Signal::new(0.0, 0.5, vec![-2.0; v.len()]).unwrap();
        let x = Signal::new(0.0, 0.5, vec![everywhere_m; v.len()]).unwrap();
        let velocity = grid(v);
        let events = crash_events(&velocity, &x, 0.0).unwrap();
        pulse_metrics(&Pulse {
            acceleration: &a,
            velocity: &velocity,
            displacement: &x,
            events: &events,
            impact_speed_m_per_s: 4.0,
            mass_kg,
            time_zero_s: 0.0,
        })
        .unwrap()
    }

    fn find<'a>(metrics: &'a [Metric], name: &str) -> &'a Metric {
        metrics.iter().find(|m| m.name == name).unwrap()
    }

    #[test]
    fn what_the_record_does_not_show_is_absent_with_its_reason() {
        let metrics = metrics_of(Some(900.0), vec![4.0, 3.0, 2.0], 0.0);
        let crush = find(&metrics, "dynamic_crush");
        assert_eq!((crush.value, crush.definition.as_str()), (None, "absent: the record ends at v = 2.000 m/s"));
        assert_eq!(find(&metrics, "peak_acceleration").value, Some(2.0));
    }

    #[test]
    fn without_a_mass_energy_and_stiffness_say_so() {
        let metrics = metrics_of(None, vec![1.0, 0.0, -1.0], 0.0);
        for name in ["average_stiffness", "impact_energy", "energy_absorbed"] {
            assert_eq!(find(&metrics, name).definition, "absent: the mass is not known");
        }
    }

    #[test]
    fn no_value_is_infinite_or_nan_where_the_crush_is_zero() {
        let metrics = metrics_of(Some(900.0), vec![1.0, 0.0, -1.0], -0.25);
        assert_eq!(find(&metrics, "equivalent_square_wave").value, None);
        assert!(metrics.iter().all(|m| m.value.is_none_or(f64::is_finite)));
    }
}
