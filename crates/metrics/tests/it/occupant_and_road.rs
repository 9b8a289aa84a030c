//! Head, chest and roadside criteria: known pulses, another implementation, and what counts at the edges.

use crumple_metrics::{
    AsiLimits, AsiMethod, FlailSpace, asi, clip_contiguous, clip_cumulative, hic, hic_all_pairs, oiv_ora, thiv_phd,
};
use crumple_signal::{Acceleration, STANDARD_GRAVITY_M_PER_S2 as G, Sampled, Signal};

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
