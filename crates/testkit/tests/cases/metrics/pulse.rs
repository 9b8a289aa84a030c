//! Motion and indices of one pulse.

use crumple_metrics::{
    CrashEvents, CrushStiffness, Metric, OlcOptions, Pulse, VpiOptions, crash_events, energy_equivalent_speed,
    pulse_metrics,
};
use crumple_signal::{
    Acceleration, Displacement, IntegrationRule, STANDARD_GRAVITY_M_PER_S2, Signal, Velocity, integrate_twice,
};
use crumple_testkit::reference_signals::{list, number};

use crate::metrics::check::Check;

/// A motion from the first sample of an acceleration.
pub struct Motion {
    pub acceleration: Signal<Acceleration>,
    pub velocity: Signal<Velocity>,
    pub displacement: Signal<Displacement>,
    pub events: CrashEvents,
    pub v0: f64,
}

impl Motion {
    pub fn new(acceleration: Signal<Acceleration>, v0: f64) -> Self {
        let (t0, dt) = (acceleration.t0_s(), acceleration.dt_s());
        let (v, x) = integrate_twice(acceleration.samples(), dt, IntegrationRule::Trapezoid, v0, 0.0);
        let velocity = Signal::new(t0, dt, v).unwrap();
        let displacement = Signal::new(t0, dt, x).unwrap();
        let events = crash_events(&velocity, &displacement, 0.0).unwrap();
        Self { acceleration, velocity, displacement, events, v0 }
    }

    pub fn metrics(&self, mass_kg: Option<f64>) -> Metrics {
        let metrics = pulse_metrics(&Pulse {
            acceleration: &self.acceleration,
            velocity: &self.velocity,
            displacement: &self.displacement,
            events: &self.events,
            impact_speed_m_per_s: Some(self.v0),
            mass_kg,
            time_zero_s: 0.0,
        });
        Metrics(metrics.unwrap())
    }

    pub fn olc(&self, options: OlcOptions) -> Metric {
        crumple_metrics::olc(&self.velocity, &self.displacement, self.v0, 0.0, options).unwrap()
    }
}

/// The metrics of a pulse by name.
pub struct Metrics(Vec<Metric>);

impl Metrics {
    pub fn get(&self, name: &str) -> &Metric {
        self.0.iter().find(|metric| metric.name == name).unwrap()
    }
}

pub fn kinematics(check: &mut Check<'_>) {
    let acceleration = if check.has_param("amp_g") {
        // A half-sine in closed form, at 10 kHz.
        let (amplitude, duration_s) = (check.param("amp_g") * STANDARD_GRAVITY_M_PER_S2, check.param("dur_s"));
        let at = |k: i32| f64::from(k) * 1e-4 / duration_s;
        let pulse = |u: f64| if u <= 1.0 { -amplitude * (std::f64::consts::PI * u).sin() } else { 0.0 };
        let n = (1.5e4 * duration_s).ceil() as i32;
        Signal::new(0.0, 1e-4, (0..=n).map(|k| pulse(at(k))).collect()).unwrap()
    } else {
        check.acceleration(0)
    };
    let motion = Motion::new(acceleration, check.param("v0_ms"));
    let mass_kg = check.has_param("mass_kg").then(|| check.param("mass_kg"));
    let metrics = motion.metrics(mass_kg);
    let (crush, rebound) = (motion.events.crush, motion.events.rebound);
    for (path, name) in [
        ("t_m_s", "time_of_dynamic_crush"),
        ("dynamic_crush_m", "dynamic_crush"),
        ("delta_v_ms", "delta_v"),
        ("restitution", "coefficient_of_restitution"),
        ("rebound_displacement_m", "rebound_displacement"),
        ("t_peak_s", "time_of_peak_acceleration"),
        ("centroid_time_s", "centroid_time"),
        ("tc_over_tm", "centroid_time_ratio"),
        ("k_avg_N_per_m", "average_stiffness"),
        ("energy_J", "impact_energy"),
        ("energy_lost_J", "energy_absorbed"),
    ] {
        check.metric(path, metrics.get(name), 1.0);
    }
    for (path, name) in
        [("peak_decel_g", "peak_acceleration"), ("esw_g", "equivalent_square_wave"), ("asw_g", "average_square_wave")]
    {
        check.metric_g(path, metrics.get(name));
    }
    check.close_or_null("v_min_ms", rebound.map(|r| r.velocity_m_per_s));
    check.close_or_null("t_v_min_s", rebound.map(|r| r.time_s));
    check.close_or_null("x_at_v_min_m", rebound.map(|r| r.displacement_m));
    check.close("v_end_ms", motion.events.end_velocity_m_per_s);
    check.close("x_end_m", motion.displacement.samples()[motion.displacement.len() - 1]);

    if crush.is_some() {
        // No reference values for these; each has a second definition. The moment closes to O(T²): 1e-4 is twenty times
        // what 10 kHz leaves. The work closes identically, to 1e3 roundings.
        let gap = metrics.get("centroid_time_by_moment").value.unwrap() / metrics.get("centroid_time").value.unwrap();
        if (gap - 1.0).abs() > 1e-4 {
            check.fail(format!("centroid by moment is {gap} of C/v0"));
        }
        let closure = metrics.get("energy_closure").value.unwrap();
        if closure.abs() > 1e-11 {
            check.fail(format!("energy closes to {closure}"));
        }
    }
}

pub fn sliding_mean(check: &mut Check<'_>) {
    let (acceleration, window_s) = (check.acceleration(0), check.param("window_s"));
    let found = crumple_metrics::sliding_mean(&acceleration, window_s, f64::NEG_INFINITY);
    check.metric_g("peak_decel_g", &found);
    // Another start with the same mean: the largest of the record cut there to one window.
    let (value, limit) = (found.value.unwrap_or(0.0), check.general_limit(found.value.unwrap_or(0.0)));
    check.window("t_start_s", "", &found, |from_s, _| {
        let from = acceleration.index_at_or_after(from_s);
        let to = acceleration.index_at_or_after(from_s + window_s) + 1;
        let there = crumple_metrics::sliding_mean(&acceleration.slice(from, to).into(), window_s, f64::NEG_INFINITY);
        there.value.is_some_and(|there| (there - value).abs() <= limit)
    });
}

pub fn olc(check: &mut Check<'_>) {
    let default = OlcOptions::default();
    let options = OlcOptions {
        free_flight_m: check.param_or("free_m", default.free_flight_m),
        restraint_m: check.param_or("restraint_m", default.restraint_m),
    };
    let motion = if check.has_param("constant_decel_ms2") {
        // Fast enough that the vehicle still moves at t2.
        let v0 = check.param_or("v0_ms", check.param("constant_decel_ms2"));
        Motion::new(check.constant_deceleration(), v0)
    } else {
        Motion::new(check.acceleration(0), check.param("v0_ms"))
    };
    let found = motion.olc(options);
    check.metric("olc_ms2", &found, 1.0);
    check.metric_g("olc_g", &found);
    check.window("t1_s", "t2_s", &found, |_, _| false);
    check.close_or_null("v2_ms", found.window.and_then(|w| motion.velocity.at(w.to_s)));
}

pub fn vpi(check: &mut Check<'_>) {
    let default = VpiOptions::default();
    let options = VpiOptions {
        slack_m: check.param_or("slack_m", default.slack_m),
        stiffness_n_per_m: check.param_or("stiffness_N_per_m", default.stiffness_n_per_m),
        mass_kg: check.param_or("mass_kg", default.mass_kg),
    };
    let acceleration =
        if check.has_param("constant_decel_ms2") { check.constant_deceleration() } else { check.acceleration(0) };
    let found = crumple_metrics::vpi(&acceleration, acceleration.t0_s(), options);
    check.metric("vpi_ms2", &found, 1.0);
    check.metric_g("vpi_g", &found);
    check.close_or_null("t_s", found.window.map(|w| w.to_s));
}

pub fn ride_down(check: &mut Check<'_>) {
    let found =
        crumple_metrics::ride_down(&check.acceleration(0), &check.acceleration(1), check.param("v0_ms")).unwrap();
    check.metric("ride_down_efficiency", &found.efficiency, 1.0);
    check.metric("restraint_energy_ratio", &found.restraint, 1.0);
    check.metric("max_relative_displacement_m", &found.largest_travel, 1.0);
    check.close_or_null("residual", found.residual());
}

pub fn crush_energy(check: &mut Check<'_>) {
    let (mass_kg, width_m) = (check.param("mass_kg"), check.param("width_m"));
    let stiffness =
        CrushStiffness::from_impact_line(mass_kg, width_m, check.param("b0_ms"), check.param("b1_per_s")).unwrap();
    let crush: Vec<f64> = list(&check.case["params"]["crush_m"]).iter().map(number).collect();
    let angle = check.param_or("angle_deg", 0.0).to_radians();
    let energy = stiffness.energy(width_m, &crush, angle);
    check.close("A_N_per_m", stiffness.a_n_per_m);
    check.close("B_N_per_m2", stiffness.b_n_per_m2);
    check.close("G_N", stiffness.g_n);
    check.metric("energy_J", &energy, 1.0);
    check.close_or_null("ees_ms", energy.value.map(|energy| energy_equivalent_speed(mass_kg, energy)));
}
