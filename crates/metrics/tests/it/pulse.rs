//! Metrics of a pulse on grids that begin anywhere: worked by hand, or against another solution of the same equations.

use crumple_metrics::{
    AsiLimits, AsiMethod, CrushStiffness, DamageProfile, DynamicCrush, FlailSpace, Metric, OlcOptions, Pulse, RideDown,
    VpiOptions, asi, clip_contiguous, clip_cumulative, crash_events, hic, hic_all_pairs, maximum_delta_v,
    mean_deceleration, oiv_ora, olc, pulse_metrics, ride_down, sliding_mean, thiv_phd, vpi, wall_stiffness,
};
use crumple_signal::{Acceleration, Displacement, STANDARD_GRAVITY_M_PER_S2 as G, Sampled, Signal, Velocity};

fn find<'a>(metrics: &'a [Metric], name: &str) -> &'a Metric {
    metrics.iter().find(|m| m.name == name).unwrap()
}

/// The metrics of a velocity at 1 kHz from 50 ms before contact on.
fn metrics(v: &[f64], impact_speed_m_per_s: Option<f64>, mass_kg: Option<f64>) -> Vec<Metric> {
    let dt = 1e-3;
    let a: Vec<f64> = (0..v.len()).map(|k| (v[(k + 1).min(v.len() - 1)] - v[k]) / dt).collect();
    let x: Vec<f64> = (0..v.len()).map(|k| dt * v[..=k].iter().sum::<f64>()).collect();
    let velocity = Signal::<Velocity>::new(-0.05, dt, v.to_vec()).unwrap();
    let displacement = Signal::<Displacement>::new(-0.05, dt, x).unwrap();
    let acceleration = Signal::<Acceleration>::new(-0.05, dt, a).unwrap();
    let events = crash_events(&velocity, &displacement).unwrap();
    let (velocity, displacement) = (&velocity, &displacement);
    let pulse =
        Pulse { acceleration: &acceleration, velocity, displacement, events: &events, impact_speed_m_per_s, mass_kg };
    pulse_metrics(&pulse).unwrap()
}

/// Velocity that changes by `change` over 40 samples from contact on, `length` samples in all.
fn ramp(from: f64, change: f64, length: usize) -> Vec<f64> {
    (0..length).map(|k| from + change * k.clamp(50, 90).saturating_sub(50) as f64 / 40.0).collect()
}

#[test]
fn windows_count_from_contact() {
    let metrics = metrics(&ramp(8.0, -10.0, 200), Some(8.0), Some(1000.0));
    let window = |name: &str| find(&metrics, name).window.unwrap();
    for name in ["peak_acceleration", "time_of_peak_acceleration"] {
        let at = window(name);
        assert!((0.0..0.04).contains(&at.from_s) && at.to_s == at.from_s, "{name}: {at:?}");
    }
    assert!(find(&metrics, "time_of_peak_acceleration").value.unwrap() < 0.04);
    // -2 m/s after 40 ms, 0 after 32.
    assert!((find(&metrics, "time_of_dynamic_crush").value.unwrap() - 0.032).abs() < 1e-12);
    let separation = window("delta_v");
    assert!(separation.from_s == 0.0 && (separation.to_s - 0.04).abs() < 1e-12, "{separation:?}");
    assert_eq!(find(&metrics, "delta_v").value.map(|v| (v * 1e9).round()), Some(1e10));
    assert!(!find(&metrics, "delta_v").definition.contains("bound"));
    // 200 samples end 109 ms after the lowest velocity.
    assert!(find(&metrics, "acceleration_after_separation").value.is_some_and(|drift| drift < 1e-9));
    let cut = self::metrics(&ramp(8.0, -10.0, 105), Some(8.0), None);
    assert_eq!(find(&cut, "acceleration_after_separation").value, None, "14 ms are left");
    let separating = self::metrics(&ramp(8.0, -10.0, 90), Some(8.0), None);
    assert!(find(&separating, "delta_v").definition.ends_with("lower bound: still separating at the end"));
}

#[test]
fn what_is_missing_has_its_own_reason_with_or_without_a_mass() {
    let metrics = metrics(&ramp(8.0, -0.1, 200), Some(8.0), None);
    assert_eq!(find(&metrics, "dynamic_crush").definition, "absent: the record ends at v = 7.900 m/s");
    assert_eq!(find(&metrics, "energy_absorbed").definition, "absent: the mass is not known");
    for (speed, reason) in [(Some(0.0), "the motion starts from rest"), (None, "the impact speed is not stated")] {
        let metrics = self::metrics(&ramp(0.0, 9.0, 200), speed, None);
        assert_eq!(find(&metrics, "dynamic_crush").definition, format!("absent: {reason}"));
    }
}

#[test]
fn a_motion_from_rest_has_its_largest_change_with_its_direction() {
    for (change, way) in [(-9.0, "rearward"), (9.0, "forward")] {
        // Some comes back.
        let v: Vec<f64> =
            ramp(0.0, change, 200).iter().enumerate().map(|(k, v)| if k < 150 { *v } else { v / 3.0 }).collect();
        let metrics = metrics(&v, None, None);
        let delta_v = find(&metrics, "delta_v");
        assert!((delta_v.value.unwrap() - 9.0).abs() < 1e-12, "{delta_v:?}");
        assert!((delta_v.window.unwrap().to_s - 0.04).abs() < 1e-12 && delta_v.window.unwrap().from_s == 0.0);
        assert!(delta_v.definition.ends_with(&format!("{way}, the largest change from time zero")), "{delta_v:?}");
    }
    // What moves before contact does not count.
    let mut v = ramp(0.0, -2.0, 200);
    v[..30].fill(7.0);
    assert!((find(&metrics(&v, None, None), "delta_v").value.unwrap() - 2.0).abs() < 1e-12);
}

#[test]
fn free_flight_and_restraint_may_end_within_one_interval() {
    // The occupant's travel is 0, 60 and 800 mm at 0, 50 and 100 ms, the vehicle's velocity 10, 2, -3 m/s: 65 mm
    // at 0.0503378 s with 1.9662162 m/s, where 235 mm lack; at the sample there are 177.196 mm too many. By a program
    // of these lines in another language.
    let v = Signal::new(0.0, 0.05, vec![10.0, 2.0, -3.0]).unwrap();
    let x = Signal::new(0.0, 0.05, vec![0.0, 0.44, 0.2]).unwrap();
    let found = olc(&v, &x, 10.0, OlcOptions::default()).unwrap();
    let window = found.window.unwrap();
    assert!((window.from_s - 0.050_337_837_837_837_844).abs() < 1e-14, "{window:?}");
    assert!((window.to_s - 0.078_651_090_849_886_03).abs() < 1e-14, "{window:?}");
    assert!((found.value.unwrap() / 383.746_405_980_448_6 - 1.0).abs() < 1e-12, "{found:?}");
    let early = olc(&v, &x, 10.0, OlcOptions { free_flight_m: 0.0, restraint_m: 0.1 }).unwrap();
    assert_eq!(early.window.unwrap().from_s, 0.0);
}

/// The belt's equation by Runge and Kutta's rule in `steps` of every interval: largest `ω²·(d - s)` and its moment.
fn belt_by_small_steps(a: &[f64], dt: f64, options: VpiOptions, steps: usize) -> (f64, f64) {
    let omega2 = options.stiffness_n_per_m / options.mass_kg;
    let (mut d, mut rate, mut best) = (0.0, 0.0, (0.0, 0.0));
    let h = dt / steps as f64;
    for k in 0..a.len() - 1 {
        for step in 0..steps {
            let vehicle = |part: f64| a[k] + (a[k + 1] - a[k]) * (step as f64 + part) / steps as f64;
            let slope = |d: f64, part: f64| -vehicle(part) - omega2 * f64::max(0.0, d - options.slack_m);
            let k1 = (rate, slope(d, 0.0));
            let k2 = (rate + h / 2.0 * k1.1, slope(d + h / 2.0 * k1.0, 0.5));
            let k3 = (rate + h / 2.0 * k2.1, slope(d + h / 2.0 * k2.0, 0.5));
            let k4 = (rate + h * k3.1, slope(d + h * k3.0, 1.0));
            d += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
            rate += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
            let load = omega2 * (d - options.slack_m);
            if load > best.0 {
                best = (load, (k as f64 + (step as f64 + 1.0) / steps as f64) * dt);
            }
        }
    }
    best
}

#[test]
fn the_pulse_index_is_that_of_small_steps_whatever_the_pulse() {
    let share = |number: usize, stream: f64| (number as f64 * stream).fract();
    for number in 1..60 {
        let dt = [1e-4, 2e-3, 8e-3][number % 3];
        let n = if number % 3 == 0 { 400 } else { 40 };
        let height = 50.0 + 400.0 * share(number, 0.618_034);
        // Pushes and pulls: the belt is taken up, let go and taken up again.
        let a: Vec<f64> = (0..n)
            .map(|k| height * (share(k / (1 + number % 5) + number, 0.754_878) - 0.55 - 0.2 * share(number, 0.324_718)))
            .collect();
        let options = VpiOptions { slack_m: 0.01 * share(number, 0.569_84), stiffness_n_per_m: 5000.0, mass_kg: 2.0 };
        let found = vpi(&Signal::new(-3.0 * dt, dt, [vec![900.0; 3], a.clone()].concat()).unwrap(), options);
        let steps = 400;
        let (load, at_s) = belt_by_small_steps(&a, dt, options, steps);
        // The largest of 400 moments an interval of a cosine; moments of contact are met to one of them.
        let value = found.value.unwrap_or(0.0);
        assert!((value - load).abs() <= 1e-5 * load.max(1.0), "{number}: {value} {load}");
        if let Some(window) = found.window {
            assert!((window.to_s - at_s).abs() <= 0.01 * dt + 1e-12, "{number}: {window:?} {at_s}");
            assert_eq!(window.from_s, window.to_s, "a moment");
        }
    }
}

#[test]
fn a_belt_without_slack_or_stiffness() {
    let a = |sign: f64| Signal::new(0.0, 1e-3, vec![sign * 100.0; 100]).unwrap();
    let options = VpiOptions { slack_m: 0.0, ..VpiOptions::default() };
    // A step on a spring: twice the step, after half a period.
    let found = vpi(&a(-1.0), options);
    let half_period = std::f64::consts::PI / 50.0;
    assert!((found.value.unwrap() - 200.0).abs() < 1e-9, "{found:?}");
    // The load is level at its largest: its moment is met to the root of the rounding.
    assert!((found.window.unwrap().to_s - half_period).abs() < 1e-7, "{found:?} {half_period}");
    assert_eq!(vpi(&a(1.0), options).value, None, "pushed away from the belt");
    assert_eq!(vpi(&a(0.0), options).value, None);
    for (slack_m, stiffness_n_per_m, mass_kg) in
        [(-0.01, 2500.0, 1.0), (0.03, 0.0, 1.0), (0.03, -1.0, 1.0), (f64::NAN, 2500.0, 1.0), (0.03, 2500.0, 0.0)]
    {
        let refused = vpi(&a(-1.0), VpiOptions { slack_m, stiffness_n_per_m, mass_kg });
        assert!(refused.definition.starts_with("absent: mass and stiffness"), "{refused:?}");
    }
    // Stretches at the end, but less than before: no bound. A last sample at the largest load is one.
    let ringing = vpi(&Signal::new(0.0, 1e-3, vec![-100.0; 300]).unwrap(), options);
    assert!(!ringing.definition.contains("bound"), "{ringing:?}");
    assert!(vpi(&Signal::new(0.0, 1e-3, vec![-100.0; 50]).unwrap(), options).definition.contains("lower bound"));
}

#[test]
fn the_table_of_a_recorder_counts_from_contact_to_300_ms() {
    let of = |t0_s: f64, v: &[f64]| maximum_delta_v(&Sampled::new(t0_s, 0.01, v.to_vec()).unwrap());
    // Rows at -20, -10, 0 ms, ...; contact has 3 m/s.
    let [change, time] = of(-0.02, &[9.0, 1.0, 3.0, -4.0, -6.0, -5.0]);
    assert_eq!((change.value, time.value.map(|t| (t * 1e9).round())), (Some(-9.0), Some(2e7)));
    // Half a hundredth of a row after a row: that row is before contact. Half a hundredth beyond 300 ms: not counted.
    assert_eq!(of(-0.02 - 5e-5, &[9.0, 1.0, 3.0, -4.0, -6.0, -5.0])[0].value, Some(-2.0));
    let late: Vec<f64> = (0..60).map(|k| if k == 31 { 50.0 } else { 0.0 }).collect();
    assert_eq!(of(-0.01 + 5e-5, &late)[0].value, Some(0.0));
    assert_eq!(of(-0.01, &late)[0].value, Some(50.0));
    // A table without a zero in it has a step too, one of zeros alone has none. Steps of 1 km/h are 0.5 km/h on either
    // side, beside 1.9 % of the change: sqrt((1.645 · 0.019 · 41/3.6)² + (0.5/3.6)²) = 0.382067 m/s.
    let width = |metric: &Metric| metric.interval.map(|i| ((i.high - i.low) * 1e6).round());
    assert_eq!(width(&of(0.01, &[-1.0 / 3.6, -41.0 / 3.6, -40.0 / 3.6])[0]), Some(764_133.0));
    assert_eq!(width(&of(0.0, &[0.0; 5])[0]), None);
}

#[test]
fn the_mean_deceleration_is_a_change_over_its_time() {
    let v = Signal::new(0.0, 0.5, vec![10.0, 8.0, 2.0]).unwrap();
    assert_eq!(mean_deceleration(&v, 0.25, 0.75), Some(8.0));
}

#[test]
fn a_sliding_mean_is_the_first_of_equals_and_needs_a_window() {
    let a = Signal::new(0.5, 0.25, vec![-4.0; 9]).unwrap();
    for window_s in [0.5, 0.75, 0.625] {
        let window = sliding_mean(&a, window_s, 1.0).window.unwrap();
        assert_eq!((window.from_s, window.to_s), (1.0, 1.0 + window_s));
    }
    assert_eq!(sliding_mean(&a, 0.0, 0.5).definition, "absent: the record is shorter than the window of 0 s");
    // A part of an interval: the last window ends on the last sample.
    assert!(sliding_mean(&a, 1.875, 0.5).value.is_some() && sliding_mean(&a, 2.125, 0.5).value.is_none());
}

#[test]
fn an_occupant_that_still_decelerates_leaves_the_rest_of_the_trapezoid() {
    let (a, b) = ([-2.0, -4.0, -4.0, 0.0], [0.0, -2.0, -2.0, -6.0]);
    let signal = |a: &[f64]| Signal::<Acceleration>::new(0.25, 0.5, a.to_vec()).unwrap();
    let found: RideDown = ride_down(&signal(&a), &signal(&b), 8.0).unwrap();
    // T²/4·(a_o(end)² - a_o(0)²)/v0² = 0.0625·36/64.
    assert!((found.residual().unwrap().abs() - 0.0625 * 36.0 / 64.0).abs() < 1e-14, "{found:?}");
    // The vehicle's velocity 8, 6.5, 4.5, 3.5, the occupant's 8, 7.5, 6.5, 4.5: travel 0.25, 1, 1.75.
    assert_eq!((found.largest_travel.value, found.largest_travel.window.unwrap().to_s), (Some(1.75), 1.75));
    let tied = ride_down(&signal(&a), &signal(&a), 8.0).unwrap().largest_travel;
    assert_eq!((tied.value, tied.window.unwrap().from_s), (Some(0.0), 0.25));
}

#[test]
fn stiffness_of_damage_needs_positive_numbers() {
    let made = |mass, width, b0, b1| CrushStiffness::from_impact_line(mass, width, b0, b1).is_some();
    assert!(made(1500.0, 1.6, 2.0, 20.0) && made(1500.0, 1.6, 0.0, 20.0));
    for (mass, width, b0, b1) in [
        (0.0, 1.6, 2.0, 20.0),
        (-1.0, 1.6, 2.0, 20.0),
        (f64::INFINITY, 1.6, 2.0, 20.0),
        (1500.0, 0.0, 2.0, 20.0),
        (1500.0, f64::NAN, 2.0, 20.0),
        (1500.0, 1.6, -0.1, 20.0),
        (1500.0, 1.6, f64::NAN, 20.0),
        (1500.0, 1.6, 2.0, 0.0),
        (1500.0, 1.6, 2.0, f64::INFINITY),
        (1e300, 1.6, 2.0, 1e10),
    ] {
        assert!(!made(mass, width, b0, b1), "{mass} {width} {b0} {b1}");
    }
    let stiffness = CrushStiffness::from_impact_line(1500.0, 1.6, 2.0, 20.0).unwrap();
    for width in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(stiffness.energy(width, &[0.4; 6], 0.0).value, None, "{width}");
    }
    assert!(DamageProfile::new(&[0.1, f64::INFINITY]).is_none());
}

#[test]
fn the_initial_stiffness_is_the_slope_of_a_line_with_an_offset_too() {
    // From 25 mm on, where the first sample may lie.
    let x: Vec<f64> = (0..=80).map(|i| 0.025 + 0.005 * f64::from(i)).collect();
    let force: Vec<f64> = x.iter().map(|x| 3e4 + 8e5 * x).collect();
    let found = wall_stiffness(&x, &force).unwrap();
    assert!((found.initial_n_per_m / 8e5 - 1.0).abs() < 1e-10, "{found:?}");
    // ∫F dx from 25 to 400 mm.
    assert!((found.work_j / (3e4 * 0.375 + 4e5 * (0.16 - 0.000_625)) - 1.0).abs() < 1e-12);
}

#[test]
fn the_work_up_to_the_crush_ends_at_the_crush_or_with_the_record() {
    // v = 4 - 4t, a = -4: W = 8 J/kg at t = 1; crush.index is the first sample at or after it.
    let n = 6;
    let t = |k: usize| 0.4 * k as f64;
    let a = Signal::new(0.0, 0.4, (0..n).map(|k| -3.0 - k as f64).collect()).unwrap();
    let x = Signal::new(0.0, 0.4, (0..n).map(|k| 4.0 * t(k) - 2.0 * t(k) * t(k)).collect()).unwrap();
    let v = Signal::new(0.0, 0.4, (0..n).map(|k| 4.0 - 4.0 * t(k)).collect()).unwrap();
    let closure = |index: usize| {
        let crush = DynamicCrush { time_s: 1.0, displacement_m: 2.0, index };
        let mut events = crash_events(&v, &x).unwrap();
        events.crush = Some(crush);
        let pulse = Pulse {
            acceleration: &a,
            velocity: &v,
            displacement: &x,
            events: &events,
            impact_speed_m_per_s: Some(4.0),
            mass_kg: None,
        };
        8.0 * (1.0 + find(&pulse_metrics(&pulse).unwrap(), "energy_closure").value.unwrap())
    };
    // x: 0, 1.28, 1.92, 1.92, 1.28, 0; trapezoids with a of -3.5, -4.5; the rest with that of samples 2 and 3, -5.5.
    assert!((closure(3) - (1.28 * 3.5 + 0.64 * 4.5 + 0.08 * 5.5)).abs() < 1e-12);
    // An event of another motion past the end: all intervals but the last, and the way to the crush with its samples.
    let all = 1.28 * 3.5 + 0.64 * 4.5 + 0.0 - 0.64 * 6.5 + (2.0 - 1.28) * 7.5;
    assert!((closure(99) - all).abs() < 1e-12, "{} {all}", closure(99));
}

fn signal(t0_s: f64, dt_s: f64, samples: impl IntoIterator<Item = f64>) -> Signal<Acceleration> {
    Signal::new(t0_s, dt_s, samples.into_iter().collect()).unwrap()
}

#[test]
fn the_criterion_of_a_constant_is_its_longest_window_and_named_by_it() {
    let a = signal(0.5, 1e-3, vec![50.0 * G; 200]);
    for (window_s, id) in [(0.015, "hic15-fmvss208"), (0.036, "hic36-fmvss208"), (0.02, "hic")] {
        let found = hic(&a, window_s);
        assert!((found.value.unwrap() / (window_s * 50.0_f64.powf(2.5)) - 1.0).abs() < 1e-12);
        assert!(found.id.starts_with(id) && (id != "hic" || found.id.len() < 14), "{}", found.id);
    }
    // Two samples are a record; its only window is shorter than the one allowed.
    for found in [hic(&signal(0.0, 1e-3, [G, G]), 0.015), hic_all_pairs(&signal(0.0, 1e-3, [G, G]), 0.015)] {
        assert!((found.value.unwrap() - 1e-3).abs() < 1e-15, "{found:?}");
    }
    for window_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(hic(&a, window_s).definition, "absent: the window is not a positive time");
    }
}

#[test]
fn a_clip_is_in_the_unit_of_its_signal() {
    let triangle = [0.0, 2.0, 4.0, 2.0, 0.0, 0.0, 2.0, 4.0, 2.0, 0.0, 0.0];
    for factor in [1e-6, 1.0, 1e6] {
        let a = signal(0.0, 1.0, triangle.map(|a| factor * a));
        let (one, all) = (clip_contiguous(&a, 1.0), clip_cumulative(&a, 1.0));
        // One peak is 4 - L wide, both together twice that.
        assert!((one.value.unwrap() / factor - 3.0).abs() < 1e-13 && (all.value.unwrap() / factor - 3.5).abs() < 1e-13);
    }
    // A stay that touches its level in the middle is one.
    let touching = clip_contiguous(&signal(0.0, 1.0, [0.0, 4.0, 2.0, 4.0, 0.0]), 3.0);
    assert!((touching.value.unwrap() - 2.0).abs() < 1e-14);
    for duration_s in [0.0, -1.0, f64::NAN, 99.0] {
        assert_eq!(clip_contiguous(&signal(0.0, 1.0, triangle), duration_s).value, None, "{duration_s}");
    }
}

#[test]
fn both_readings_of_13_hz_leave_what_they_say() {
    // 4 s of 13 Hz and of 50 ms of rest on both axes.
    let wave =
        signal(0.0, 1e-3, (0..4000).map(|k| 12.0 * G * (2.0 * std::f64::consts::PI * 0.013 * f64::from(k)).sin()));
    let still = signal(0.0, 1e-3, vec![0.0; 4000]);
    let index = |method| asi([&wave, &still, &still], AsiLimits::default(), method).unwrap().value.unwrap();
    // Samples meet the crest to 1 - cos(π·0.013); a filter of tangents is exact at its design frequency. The ends of
    // the record are point reflections of a sine, which goes on.
    assert!((index(AsiMethod::ButterworthPerPass) - 0.5).abs() < 2e-3);
    assert!((index(AsiMethod::ButterworthBothPasses) - 0.5_f64.sqrt()).abs() < 2e-3);
}

#[test]
fn the_index_of_1998_is_the_first_of_the_largest_means_with_its_50_ms() {
    let still = |dt_s: f64, n: usize| signal(1.0, dt_s, vec![0.0; n]);
    // 80 m/s² for 0.25 s: sums of 0.0125 s are whole, all means equal.
    let (dt_s, n) = (0.0125, 21);
    let push = signal(1.0, dt_s, vec![80.0; n]);
    let found = asi([&push, &still(dt_s, n), &still(dt_s, n)], AsiLimits::default(), AsiMethod::MovingAverage).unwrap();
    let window = found.window.unwrap();
    assert!((found.value.unwrap() - 80.0 / (12.0 * G)).abs() < 1e-12, "{found:?}");
    assert!((window.from_s - 1.0).abs() < 1e-12 && (window.to_s - 1.05).abs() < 1e-12, "{window:?}");
    // Intervals of which 50 ms are no multiple; a push of 20 ms counts 20/50.
    let (dt_s, n) = (3e-4, 400);
    let push = signal(1.0, dt_s, (0..n).map(|k| if (100..167).contains(&k) { 80.0 } else { 0.0 }));
    let found = asi([&still(dt_s, n), &push, &still(dt_s, n)], AsiLimits::default(), AsiMethod::MovingAverage).unwrap();
    // 66 whole intervals and two halves.
    assert!((found.value.unwrap() - 80.0 * 67.0 * dt_s / 0.05 / (9.0 * G)).abs() < 1e-12, "{found:?}");
    // A record too short for a filter of 13 Hz of its rate, or shorter than 50 ms, still has a mean.
    let short = signal(0.0, 1e-3, [9.0; 3]);
    assert!(asi([&short, &short, &short], AsiLimits::default(), AsiMethod::MovingAverage).unwrap().value.is_some());
    assert!(asi([&short, &short, &short], AsiLimits::default(), AsiMethod::default()).unwrap().value.is_none());
}

#[test]
fn the_occupant_meets_the_side_that_it_is_thrown_to() {
    // A constant a aside: 0.3 m after sqrt(0.6/a) with sqrt(0.6·a).
    for sign in [1.0, -1.0] {
        let a = 60.0;
        let (ax, ay) = (signal(0.5, 1e-4, vec![0.0; 3000]), signal(0.5, 1e-4, vec![sign * a; 3000]));
        let [x, y, _, ridedown] = oiv_ora(&ax, &ay, FlailSpace::default()).unwrap();
        let window = y.window.unwrap();
        // Linear interpolation of a parabola over 0.1 ms.
        assert!((y.value.unwrap() + sign * (0.6 * a).sqrt()).abs() < 1e-5 && x.value == Some(0.0), "{y:?}");
        assert!((window.to_s - 0.5 - (0.6 / a).sqrt()).abs() < 1e-7 && window.from_s == 0.5);
        assert!((ridedown.value.unwrap() - a).abs() < 1e-9);
        let yaw = Sampled::new(0.5, 1e-4, vec![0.0; 3000]).unwrap();
        let (thiv, _) = thiv_phd(&ax, &ay, &yaw, FlailSpace::default()).unwrap();
        assert!((thiv.value.unwrap() - (0.6 * a).sqrt()).abs() < 1e-5);
    }
}

#[test]
fn the_ridedown_window_is_the_largest_and_of_equals_the_first() {
    for (dt_s, n) in [(1e-3, 301), (3e-4, 1001)] {
        let still = signal(0.0, dt_s, vec![0.0; n]);
        let end_s = (n - 1) as f64 * dt_s;
        // A deceleration that grows to the end: the last 10 ms that begin on a sample.
        let growing = signal(0.0, dt_s, (0..n).map(|k| -300.0 * k as f64 * dt_s / 0.3));
        let [_, _, x, _] = oiv_ora(&growing, &still, FlailSpace::default()).unwrap();
        let window = x.window.unwrap();
        let last = end_s - 0.01 - ((end_s - 0.01) / dt_s + 1e-6).fract() * dt_s;
        assert!(
            (window.from_s - last).abs() < 2e-6 && (window.to_s - window.from_s - 0.01).abs() < 1e-12,
            "{window:?} {last}"
        );
        // The end of a window between samples is read from a chord of the parabola: 1000·T²/8 over 10 ms.
        assert!((x.value.unwrap() - 1000.0 * (window.from_s + 0.005)).abs() < 1e5 * dt_s * dt_s / 8.0 + 1e-9, "{x:?}");
    }
    // 1 m/s an interval: every mean is equal, the first begins on the sample at or after the impact.
    let (dt_s, n) = (0.0025, 60);
    let (push, still) = (signal(0.0, dt_s, vec![-400.0; n]), signal(0.0, dt_s, vec![0.0; n]));
    let [velocity, _, ridedown, _] = oiv_ora(&push, &still, FlailSpace::default()).unwrap();
    let (hit_s, from_s) = (velocity.window.unwrap().to_s, ridedown.window.unwrap().from_s);
    assert!(from_s >= hit_s - 1e-8 && from_s < hit_s + dt_s, "{hit_s} {from_s}");
    assert_eq!(ridedown.value, Some(400.0));
}
