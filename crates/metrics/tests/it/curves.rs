//! Agreement of channels and residuals: worked by hand.

use crumple_metrics::{
    ChannelMotion, CoraInterval, CoraOptions, Interval, Iso18571Options, Metric, Pulse, agreement, cora, crash_events,
    fit_percent, iso18571, over_channels, pulse_metrics, residuals,
};
use crumple_signal::{
    Cfc, CfcMode, Coefficients, IntegrationRule, STANDARD_GRAVITY_M_PER_S2, Sampled, Signal, filter_both_ways,
    integrate_twice, pre_event,
};
use crumple_testkit::reference_signals::two_columns;

fn signal(t0_s: f64, dt_s: f64, samples: &[f64]) -> Sampled {
    Sampled::new(t0_s, dt_s, samples.to_vec()).unwrap()
}

#[test]
fn the_gap_of_two_crushes_is_a_share_of_their_mean() {
    let a = Signal::new(0.0, 0.5, vec![0.0, -2.0, 0.0]).unwrap();
    let v = Signal::new(0.0, 0.5, vec![4.0, 3.5, 3.0]).unwrap();
    let motion = |c| ChannelMotion { acceleration: &a, velocity: &v, dynamic_crush_m: Some(c) };
    let gaps = agreement(motion(0.75), motion(0.25), 0.5).unwrap();
    assert_eq!((gaps.crush_gap_m, gaps.crush_gap_ratio), (Some(0.5), Some(1.0)));
    assert_eq!(agreement(motion(3.0), motion(1.0), 0.5).unwrap().crush_gap_ratio, Some(1.0));
    assert_eq!(agreement(motion(1.0), motion(0.0), 0.5).unwrap().crush_gap_ratio, Some(2.0));
}

#[test]
fn residuals_of_curves_with_an_offset_are_those_worked_by_hand() {
    // m - mean = -3, -1, 0, 4; e = m - c = 1, -1, 2, 0 around 0.5.
    let (m, c) = ([1.0, 3.0, 4.0, 8.0], [0.0, 4.0, 2.0, 8.0]);
    let r = residuals(&signal(0.5, 0.25, &m), &signal(0.5, 0.25, &c)).unwrap();
    let ratio: f64 = 6.0 / 26.0;
    assert!((r.nrmse.unwrap() - ratio.sqrt()).abs() < 1e-15 && (r.r2.unwrap() - (1.0 - ratio)).abs() < 1e-15);
    // var e = 6 - 4·0.25, var m = 26.
    assert!((r.vaf_percent.unwrap() - 100.0 * (1.0 - 5.0 / 26.0)).abs() < 1e-12);
    assert!((r.rmse - 1.5_f64.sqrt()).abs() < 1e-15);
    // Trapezoids of m², c² and m·c: 57.5, 52, 52.
    assert!((r.sprague_geers_magnitude.unwrap() - ((52.0 / 57.5_f64).sqrt() - 1.0)).abs() < 1e-15);
    let cosine = 52.0 / (57.5 * 52.0_f64).sqrt();
    assert!((r.sprague_geers_phase.unwrap() - cosine.acos() / std::f64::consts::PI).abs() < 1e-14);
    assert!((r.anova_mean.unwrap() - 0.5 / 8.0).abs() < 1e-16);
    assert!((r.anova_standard_deviation.unwrap() - (5.0 / 3.0_f64).sqrt() / 8.0).abs() < 1e-15);
    assert_eq!(r.interval_s, (0.5, 1.25));
}

#[test]
fn residuals_are_free_of_the_unit_and_a_constant_has_no_fit() {
    let (m, c) = ([1.0, 3.0, 4.0, 8.0], [0.0, 4.0, 2.0, 8.0]);
    let of = |factor: f64| {
        let scaled = |x: &[f64]| signal(0.0, 0.5, &x.iter().map(|x| factor * x).collect::<Vec<f64>>());
        residuals(&scaled(&m), &scaled(&c)).unwrap()
    };
    let plain = of(1.0);
    for exponent in [-900, -500, 500, 900] {
        // Powers of two change no digit; squares of such samples leave the range of numbers.
        let factor = 2.0_f64.powi(exponent);
        let r = of(factor);
        assert_eq!((r.nrmse, r.vaf_percent, r.theil_u1), (plain.nrmse, plain.vaf_percent, plain.theil_u1));
        assert_eq!((r.rmse / factor, r.sprague_geers_phase), (plain.rmse, plain.sprague_geers_phase));
    }
    // The mean of seven tenths is no tenth to the last bit.
    assert_eq!(fit_percent(&[0.1; 7], &[0.2; 7]), None);
    let constant = residuals(&signal(0.0, 0.5, &[0.1; 7]), &signal(0.0, 0.5, &[0.2; 7])).unwrap();
    assert_eq!((constant.nrmse, constant.vaf_percent), (None, None));
}

#[test]
fn the_rated_interval_of_cora_is_cut_at_its_thresholds_and_lengthened() {
    let mut t = vec![0.0; 1000];
    t[200] = 2.9;
    t[300] = 3.0;
    t[400] = -100.0;
    t[700] = 7.5;
    t[800] = 7.4;
    let of = |extension: f64| {
        let interval = CoraInterval::Automatic { start: 0.03, end: 0.075, extension };
        let t = signal(0.0, 1.0, &t);
        cora(&t, &t, &CoraOptions { interval, ..CoraOptions::default() }).unwrap().interval_s
    };
    // 400 intervals; 1 % of them are 4, and 90 % end at the record's.
    assert_eq!((of(0.0), of(0.01), of(0.9)), ((300.0, 700.0), (296.0, 704.0), (0.0, 999.0)));
    assert_eq!((of(-1.0), of(1e300)), ((300.0, 700.0), (0.0, 999.0)));
}

#[test]
fn the_shift_of_cora_keeps_the_overlap_and_scores_by_the_length() {
    // A pulse that comes 20 of 100 samples late may still be found, 21 may not.
    let at =
        |from: usize| -> Vec<f64> { (0..100).map(|k| if (from..from + 8).contains(&k) { 1.0 } else { 0.0 }).collect() };
    for (late, found) in [(20, Some(20)), (21, None), (5, Some(5))] {
        let rating =
            cora(&signal(0.0, 1.0, &at(40)), &signal(0.0, 1.0, &at(40 + late)), &CoraOptions::default()).unwrap();
        assert_eq!(rating.shift_samples, found.unwrap_or(20), "{late}");
        if late == 5 {
            // 5 of 99 intervals between 1 % and 12 %.
            assert!((rating.phase - (0.12 - 5.0 / 99.0) / 0.11).abs() < 1e-12 && rating.size == 1.0);
        }
    }
    // One sample cannot be shifted.
    assert_eq!(cora(&signal(0.0, 1.0, &[2.0]), &signal(0.0, 1.0, &[1.0]), &CoraOptions::default()).unwrap().size, 0.25);
}

#[test]
fn corridors_of_no_width_between_them_score_one_or_zero() {
    let options = CoraOptions { a_0: 0.25, b_0: 0.25, ..CoraOptions::default() };
    let rating = cora(&signal(0.0, 1.0, &[4.0; 4]), &signal(0.0, 1.0, &[4.0, 5.0, 5.5, 3.0]), &options).unwrap();
    assert_eq!(rating.corridor, 0.75);
}

#[test]
fn nine_samples_have_a_slope_and_eight_have_none() {
    let ramp: Vec<f64> = (0..9).map(f64::from).collect();
    let rated = |n: usize| {
        iso18571(&signal(0.0, 1.0, &ramp[..n]), &signal(0.0, 1.0, &ramp[..n]), &Iso18571Options::default()).unwrap()
    };
    assert_eq!((rated(9).slope_error, rated(8).slope_error), (Some(0.0), None));
}

#[test]
fn an_interval_of_replicates_is_finite() {
    let spread = |extreme: f64| Interval::of_replicates([vec![1.0; 8], vec![extreme; 4]].concat());
    assert!(spread(2.0).is_some() && spread(f64::INFINITY).is_none() && spread(f64::NEG_INFINITY).is_none());
}

fn metrics(record: &Sampled) -> Vec<Metric> {
    let bias = pre_event(record).unwrap().zero_level;
    let coefficients = Coefficients::new(Cfc::Cfc60, CfcMode::Iso6487, record.dt_s());
    let filtered = filter_both_ways(record.samples(), bias, &coefficients).unwrap();
    let zero = record.index_at_or_after(0.0);
    let a = Signal::new(0.0, record.dt_s(), filtered[zero..].to_vec()).unwrap();
    let v0 = 57.09 / 3.6;
    let (v, x) = integrate_twice(a.samples(), a.dt_s(), IntegrationRule::Trapezoid, v0, 0.0);
    let (v, x) = (Signal::new(0.0, a.dt_s(), v).unwrap(), Signal::new(0.0, a.dt_s(), x).unwrap());
    let events = crash_events(&v, &x).unwrap();
    pulse_metrics(&Pulse {
        acceleration: &a,
        velocity: &v,
        displacement: &x,
        events: &events,
        impact_speed_m_per_s: Some(v0),
        mass_kg: Some(1719.0),
    })
    .unwrap()
}

#[test]
fn crush_olc_and_vpi_spread_as_published() {
    let mut channels = Vec::new();
    for channel in ["093", "094", "099", "100"] {
        let Some(path) = crumple_testkit::shared(&format!("data/nhtsa-v10146-camry-frontal/v10146.{channel}")) else {
            return;
        };
        channels.push(metrics(&two_columns(&path, '\t')));
    }
    let spread = |name: &str, unit: f64| {
        let of_name: Vec<&Metric> =
            channels.iter().map(|metrics| metrics.iter().find(|m| m.name == name).unwrap()).collect();
        let interval = over_channels(of_name[0], &of_name[1..]).unwrap().interval.unwrap();
        println!("{name}: {} to {}", interval.low / unit, interval.high / unit);
        (interval.low / unit, interval.high / unit)
    };
    // Known to the last digit written here, half a unit of it allowed; the crush with 1 mm for the zero level's window.
    for (name, unit, low, high, allowed) in [
        ("dynamic_crush", 1.0, 0.733, 0.750, 0.001),
        ("olc", STANDARD_GRAVITY_M_PER_S2, 29.3, 30.2, 0.05),
        ("vpi", STANDARD_GRAVITY_M_PER_S2, 59.8, 61.4, 0.05),
    ] {
        let found = spread(name, unit);
        assert!((found.0 - low).abs() <= allowed && (found.1 - high).abs() <= allowed, "{name}: {found:?}");
    }
}
