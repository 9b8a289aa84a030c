//! Crash metrics, whichever crate computes them. An expected number that nothing computes is a failure.

use std::f64::consts::PI;

use crumple_metrics::{
    AsiLimits, AsiMethod, CLIP_3MS_S, CoraOptions, CrashEvents, CrushStiffness, FlailSpace, Grade, Iso18571Options,
    Metric, OlcOptions, Pulse, VpiOptions, clip_contiguous, clip_cumulative, crash_events, energy_equivalent_speed,
    hic_all_pairs, hic_d_of, pulse_metrics,
};
use crumple_signal::{
    Acceleration, Displacement, IntegrationRule, STANDARD_GRAVITY_M_PER_S2, Sampled, Signal, Velocity, integrate_twice,
};
use crumple_testkit::reference_signals::{Case, Reference, list, number, text};
use serde_json::{Value, json};

use crate::metrics::check::Check;

mod check;
mod filters;

pub fn check(file: Value) -> crate::Check {
    let reference = Reference::of(file);
    Box::new(move |case| run(&reference, case))
}

fn run(reference: &Reference, case: &Case) -> Vec<String> {
    let mut check = Check::new(reference, case);
    match text(&case["metric"]) {
        "cfc.coefficients" => filters::coefficients(&mut check),
        "cfc.two_pass_response" => filters::two_pass_response(&mut check),
        "cfc.filter" => filters::filter(&mut check),
        "ingest.zero_and_time_zero" => filters::zero_and_time_zero(&mut check),
        "crash.kinematics" => kinematics(&mut check),
        "pulse.sliding_mean" => sliding_mean(&mut check),
        "pulse.olc" => olc(&mut check),
        "pulse.vpi" => vpi(&mut check),
        "pulse.ride_down" => ride_down(&mut check),
        "reconstruction.crush_energy" => crush_energy(&mut check),
        "head.hic" => hic(&mut check),
        "head.hicd" => hic_d(&mut check),
        "head.clip" => clip(&mut check),
        "road.asi" => asi(&mut check),
        "road.thiv_phd" => thiv_phd(&mut check),
        "rating.iso18571" => iso18571(&mut check),
        "rating.cora" => cora(&mut check),
        "rating.residuals" => residuals(&mut check),
        "model.kelvin_identification" => filters::kelvin(&mut check),
        "model.maxwell_from_roots" => filters::maxwell(&mut check),
        "model.elastoplastic" => filters::elastoplastic(&mut check),
        "model.two_msd_from_denominator" => filters::double(&mut check),
        "model.modal_from_eigenvalue" => filters::mode_of_model(&mut check),
        "record.end_to_end" => filters::end_to_end(&mut check),
        unknown => check.fail(format!("unknown metric {unknown}")),
    }
    check.finish()
}

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
        let events = crash_events(&velocity, &displacement).unwrap();
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
        });
        Metrics(metrics.unwrap())
    }

    pub fn olc(&self, options: OlcOptions) -> Metric {
        crumple_metrics::olc(&self.velocity, &self.displacement, self.v0, options).unwrap()
    }
}

/// The metrics of a pulse by name.
pub struct Metrics(Vec<Metric>);

impl Metrics {
    pub fn get(&self, name: &str) -> &Metric {
        self.0.iter().find(|metric| metric.name == name).unwrap()
    }
}

fn kinematics(check: &mut Check<'_>) {
    let acceleration = if check.has_param("amp_g") {
        // A half-sine in closed form, at 10 kHz.
        let (amplitude, duration_s) = (check.param("amp_g") * STANDARD_GRAVITY_M_PER_S2, check.param("dur_s"));
        let at = |k: i32| f64::from(k) * 1e-4 / duration_s;
        let pulse = |u: f64| if u <= 1.0 { -amplitude * (PI * u).sin() } else { 0.0 };
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

fn sliding_mean(check: &mut Check<'_>) {
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
    // Its t = 0 is the first sample.
    let acceleration = Signal::new(0.0, acceleration.dt_s(), acceleration.samples().to_vec()).unwrap();
    let found = crumple_metrics::vpi(&acceleration, options);
    check.metric("vpi_ms2", &found, 1.0);
    check.metric_g("vpi_g", &found);
    check.close_or_null("t_s", found.window.map(|w| w.to_s));
}

fn ride_down(check: &mut Check<'_>) {
    let found =
        crumple_metrics::ride_down(&check.acceleration(0), &check.acceleration(1), check.param("v0_ms")).unwrap();
    check.metric("ride_down_efficiency", &found.efficiency, 1.0);
    check.metric("restraint_energy_ratio", &found.restraint, 1.0);
    check.metric("max_relative_displacement_m", &found.largest_travel, 1.0);
    check.close_or_null("residual", found.residual());
}

fn crush_energy(check: &mut Check<'_>) {
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

/// The signal of the case, or the one that its parameter writes out: `sin(20 pi t), t=0..0.05 s step 0.1 ms`, in g.
fn resultant(check: &Check<'_>) -> Signal<Acceleration> {
    let Some(formula) = check.case["params"]["signal"].as_str() else { return check.acceleration(0) };
    let numbers: Vec<f64> = formula
        .replace("..", " ")
        .split(|c: char| !(c.is_ascii_digit() || c == '.'))
        .filter_map(|word| word.parse().ok())
        .collect();
    assert!(formula.starts_with("sin(") && numbers.len() == 4, "{formula}");
    let (factor, end_s, dt_s) = (numbers[0], numbers[2], numbers[3] / 1e3);
    let n = (end_s / dt_s).round() as i32;
    let at = |k: i32| (factor * PI * f64::from(k) * dt_s).sin() * STANDARD_GRAVITY_M_PER_S2;
    Signal::new(0.0, dt_s, (0..=n).map(at).collect()).unwrap()
}

fn hic(check: &mut Check<'_>) {
    let (resultant, window_s) = (resultant(check), check.param("window_s"));
    let found = crumple_metrics::hic(&resultant, window_s);
    check.metric("hic", &found, 1.0);
    if check.expects("hic_exact_continuous") {
        check.metric("hic_exact_continuous", &crumple_metrics::hic(&check.fine_acceleration(0), window_s), 1.0);
    }
    let (value, limit) = (found.value.unwrap_or(0.0), check.general_limit(found.value.unwrap_or(0.0)));
    check.window("t1_s", "t2_s", &found, |from_s, to_s| {
        let part = resultant.slice(resultant.index_at_or_after(from_s), resultant.index_at_or_after(to_s) + 1);
        hic_all_pairs(&part.into(), window_s).value.is_some_and(|there| (there - value).abs() <= limit)
    });
    let all = hic_all_pairs(&resultant, window_s).value;
    let gap = found.value.zip(all).map_or(0.0, |(found, all)| (found - all).abs() / all.abs().max(f64::MIN_POSITIVE));
    if found.value.is_some() != all.is_some() || gap > 1e-12 {
        check.fail(format!("{:?} by pruning, {all:?} by all pairs", found.value));
    }
}

fn hic_d(check: &mut Check<'_>) {
    if check.has_param("hic") {
        check.close("hicd", hic_d_of(check.param("hic")));
        return;
    }
    let found = crumple_metrics::hic_d(&resultant(check));
    check.metric("hicd", &found, 1.0);
    check.window("t1_s", "t2_s", &found, |_, _| false);
}

fn clip(check: &mut Check<'_>) {
    let (resultant, duration_s) = (resultant(check), check.param_or("duration_s", CLIP_3MS_S));
    let contiguous = clip_contiguous(&resultant, duration_s);
    check.metric_g("contiguous", &contiguous);
    if check.expects("exact_continuous") {
        check.metric_g("exact_continuous", &clip_contiguous(&check.fine_acceleration(0), duration_s));
    }
    check.metric_g("cumulative", &clip_cumulative(&resultant, duration_s));
    check.window("t1_s", "t2_s", &contiguous, |_, _| false);
}

fn asi(check: &mut Check<'_>) {
    let signals = [0, 1, 2].map(|k| check.acceleration(k));
    let limits: Vec<f64> =
        list(&check.case["params"]["limits_g"]).iter().map(|g| number(g) * STANDARD_GRAVITY_M_PER_S2).collect();
    let limits = AsiLimits { limits_m_per_s2: limits.try_into().unwrap() };
    let [x, y, z] = &signals;
    let of = |method| crumple_metrics::asi([x, y, z], limits, method).unwrap();
    let mean = of(AsiMethod::MovingAverage);
    check.metric("moving_average_50ms", &mean, 1.0);
    check.close_or_null("moving_average_t_start_s", mean.window.map(|w| w.from_s));
    let filtered = of(AsiMethod::ButterworthPerPass);
    check.metric("butterworth_13hz", &filtered, 1.0);
    check.close_or_null("butterworth_t_s", filtered.window.map(|w| w.from_s));
    let both = of(AsiMethod::ButterworthBothPasses);
    check.metric("butterworth_13hz_both_passes", &both, 1.0);
}

fn thiv_phd(check: &mut Check<'_>) {
    let default = FlailSpace::default();
    let space = FlailSpace {
        ahead_m: check.param_or("dx_m", default.ahead_m),
        aside_m: check.param_or("dy_m", default.aside_m),
        head_x_m: check.param_or("x0_m", default.head_x_m),
    };
    let (ax, ay, yaw) = if check.has_param("constant_decel_ms2") {
        let ax = check.constant_deceleration();
        let zeros = Sampled::new(0.0, ax.dt_s(), vec![0.0; ax.len()]).unwrap();
        (ax, zeros.clone().into(), zeros)
    } else {
        (check.acceleration(0), check.acceleration(1), check.si(2))
    };
    let (thiv, phd) = crumple_metrics::thiv_phd(&ax, &ay, &yaw, space).unwrap();
    check.close_or_null("T", thiv.window.map(|w| w.to_s));
    check.metric("thiv_ms", &thiv, 1.0);
    check.metric("thiv_kmh", &thiv, 1.0 / 3.6);
    check.metric_g("phd_g", &phd);
}

fn iso18571(check: &mut Check<'_>) {
    let d = Iso18571Options::default();
    let weights = check.case["params"].get("weights").map(|w| list(w).iter().map(number).collect::<Vec<f64>>());
    let options = Iso18571Options {
        inner_corridor: check.param_or("a0", d.inner_corridor),
        outer_corridor: check.param_or("b0", d.outer_corridor),
        corridor_power: check.param_or("k_z", d.corridor_power),
        largest_shift: check.param_or("eps_p", d.largest_shift),
        phase_power: check.param_or("k_p", d.phase_power),
        largest_magnitude_error: check.param_or("eps_m", d.largest_magnitude_error),
        magnitude_power: check.param_or("k_m", d.magnitude_power),
        warping_window: check.param_or("dtw_window", d.warping_window),
        largest_slope_error: check.param_or("eps_s", d.largest_slope_error),
        slope_power: check.param_or("k_s", d.slope_power),
        weights: weights.map_or(d.weights, |w| w.try_into().unwrap()),
    };
    let found = crumple_metrics::iso18571(&check.signal(0), &check.signal(1), &options).unwrap();
    check.close("corridor", found.corridor);
    check.close("phase", found.phase);
    check.close_or_null("magnitude", found.magnitude);
    check.close_or_null("slope", found.slope);
    check.close_or_null("overall", found.overall);
    check.close_or_null("rho", found.correlation);
    check.close_or_null("e_mag", found.magnitude_error);
    check.close_or_null("e_slope", found.slope_error);
    check.equal("shift_samples_comparison_late", json!(found.shift_samples));
    check.equal("grade", json!(found.grade.map(Grade::name)));
}

fn cora(check: &mut Check<'_>) {
    let d = CoraOptions::default();
    let options = CoraOptions {
        a_0: check.param_or("a0", d.a_0),
        b_0: check.param_or("b0", d.b_0),
        k: check.param_or("k", d.k),
        d_min: check.param_or("d_min", d.d_min),
        d_max: check.param_or("d_max", d.d_max),
        int_min: check.param_or("int_min", d.int_min),
        k_v: check.param_or("k_v", d.k_v),
        k_g: check.param_or("k_g", d.k_g),
        k_p: check.param_or("k_p", d.k_p),
        g_v: check.param_or("g_v", d.g_v),
        g_g: check.param_or("g_g", d.g_g),
        g_p: check.param_or("g_p", d.g_p),
        g_1: check.param_or("g_1", d.g_1),
        g_2: check.param_or("g_2", d.g_2),
        interval: d.interval,
    };
    let found = crumple_metrics::cora(&check.signal(0), &check.signal(1), &options).unwrap();
    check.close("corridor", found.corridor);
    check.close("progression", found.progression);
    check.close("size", found.size);
    check.close("phase", found.phase);
    check.close("cross", found.cross_correlation);
    check.close("total", found.total);
    check.close("K", found.correlation);
    check.equal("shift_samples_comparison_late", json!(found.shift_samples));
}

fn residuals(check: &mut Check<'_>) {
    let by_name = |key: &str, k: usize| match check.case["params"].get(key) {
        Some(name) => check.reference.signal(text(name)),
        None => check.signal(k),
    };
    let (measured, computed) = (by_name("measured", 0), by_name("computed", 1));
    let found = crumple_metrics::residuals(&measured, &computed).unwrap();
    check.close("rmse", found.rmse);
    for (path, value) in [
        ("sprague_geers_m", found.sprague_geers_magnitude),
        ("sprague_geers_p", found.sprague_geers_phase),
        ("sprague_geers_c", found.sprague_geers_comprehensive),
        ("fit_percent", found.fit_percent),
        ("nrmse", found.nrmse),
        ("r2", found.r2),
        ("vaf_percent", found.vaf_percent),
        ("theil_u", found.theil_u1),
        ("theil_u1", found.theil_u1),
        ("theil_u2", found.theil_u2),
        ("anova_mean", found.anova_mean),
        ("anova_std", found.anova_standard_deviation),
    ] {
        check.close_or_null(path, value);
    }
}
