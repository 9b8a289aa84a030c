//! Butterworth filters and resampling: what holds for every design and record.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crumple_signal::{
    Butterworth, Cfc, CfcMode, Class, Design, FilterSettings, Interpolation, Phase, Resampling, Sampled, ZeroLevel,
    filter, resample, run_sections,
};
use proptest::prelude::*;

const DT_S: f64 = 1e-4;

fn any_phase() -> impl Strategy<Value = Phase> {
    prop::sample::select(vec![Phase::Zero, Phase::Causal])
}

/// Filters with cut-offs from 0.2 % to 45 % of the rate.
fn any_design() -> impl Strategy<Value = Design> {
    (20.0..4500.0_f64, 1..=8_usize, any_phase())
        .prop_map(|(cutoff_hz, order, phase)| Butterworth { cutoff_hz, order, phase }.design(DT_S).unwrap())
}

/// Amplitude gain of the filter as run, from its coefficients: the product over the sections of `|(a0 + a1·z⁻¹ +
/// a2·z⁻²)/(1 - b1·z⁻¹ - b2·z⁻²)|` at `z = e^(j·2π·f·T)`, squared for zero phase.
fn gain(design: &Design, frequency_hz: f64) -> f64 {
    let (sine, cosine) = (2.0 * PI * frequency_hz * DT_S).sin_cos();
    let norm = |c0: f64, c1: f64, c2: f64| {
        let (re, im) = (c0 + c1 * cosine + c2 * (2.0 * cosine * cosine - 1.0), c1 * sine + c2 * 2.0 * sine * cosine);
        re.hypot(im)
    };
    let one_pass: f64 =
        design.sections.iter().map(|&[a0, a1, a2, b1, b2]| norm(a0, a1, a2) / norm(1.0, -b1, -b2)).product();
    if design.asked.phase == Phase::Zero { one_pass * one_pass } else { one_pass }
}

/// Cut-off of the analogue prototype behind a digital frequency.
fn warped(frequency_hz: f64) -> f64 {
    (PI * frequency_hz * DT_S).tan()
}

/// Gain after the definition of the Butterworth filter, without any section.
fn closed_form(Butterworth { cutoff_hz, order, phase }: Butterworth, f: f64) -> f64 {
    let power = (warped(f) / warped(cutoff_hz)).powf(2.0 * order as f64);
    match phase {
        Phase::Causal => 1.0 / (1.0 + power).sqrt(),
        // Two passes of a prototype widened so that the cut-off stays.
        Phase::Zero => 1.0 / (1.0 + power * (2.0_f64.sqrt() - 1.0)),
    }
}

proptest! {
    #[test]
    fn the_cut_off_is_at_minus_three_decibels(design in any_design()) {
        let gain = gain(&design, design.asked.cutoff_hz);
        // Coefficients rounded to 1e-16 around poles 1e-3 from the unit circle, up to 8 of them: 1e-10 for one.
        prop_assert!((gain - FRAC_1_SQRT_2).abs() < 1e-9, "{design:?}: {gain}");
    }

    #[test]
    fn the_response_is_that_of_the_definition(design in any_design(), f in 20.0..4900.0_f64) {
        let (gain, expected) = (gain(&design, f), closed_form(design.asked, f));
        // As above; relative to 1, the gain in the pass band.
        prop_assert!((gain - expected).abs() < 1e-9, "{gain} {expected}");
    }

    #[test]
    fn the_sections_are_linear(
        pairs in prop::collection::vec((-1000.0..1000.0_f64, -1000.0..1000.0_f64), 4..300),
        p in -3.0..3.0_f64, cutoff in 100.0..4000.0_f64, order in 1..=6_usize, phase in any_phase()
    ) {
        let design = Butterworth { cutoff_hz: cutoff, order, phase }.design(DT_S).unwrap();
        let (a, b): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| p * a + b).collect();
        let (a, b) = (run_sections(&a, 0.0, &design), run_sections(&b, 0.0, &design));
        for ((y, a), b) in run_sections(&sum, 0.0, &design).into_iter().zip(a).zip(b) {
            // Inputs up to 4e3 and a thousand roundings in recursions of condition 1e3.
            prop_assert!((y - (p * a + b)).abs() < 1e-8);
        }
    }

    #[test]
    fn zero_phase_is_the_same_backwards(
        pulse in prop::collection::vec(-1000.0..1000.0_f64, 1..100), cutoff in 200.0..4000.0_f64, order in 1..=4_usize
    ) {
        let design = Butterworth { cutoff_hz: cutoff, order, phase: Phase::Zero }.design(DT_S).unwrap();
        let rest = vec![0.0; 1000];
        let record = [rest.as_slice(), &pulse, &rest].concat();
        let mut backward = record.clone();
        backward.reverse();
        let forward = run_sections(&record, 0.0, &design);
        for (y, z) in forward.iter().zip(run_sections(&backward, 0.0, &design).iter().rev()) {
            // The order of the passes changes rounding only, and what is left after 1000 samples (1e-20).
            prop_assert!((y - z).abs() < 1e-8, "{y} {z}");
        }
    }

    #[test]
    fn a_constant_passes(level in -1000.0..1000.0_f64, design in any_design()) {
        for y in run_sections(&[level; 300], 0.0, &design) {
            // Gain at frequency 0 from coefficients rounded to 1e-16 over 1 - b1 - b2 down to 1e-4, for 16 sections.
            prop_assert!((y - level).abs() < 1e-6, "{y}");
        }
    }

    #[test]
    fn up_and_down_again_gives_the_record_back(
        amplitudes in prop::collection::vec(-100.0..100.0_f64, 6), up in 1.1..5.0_f64
    ) {
        let dt_s = DT_S;
        // Tones up to 3 kHz: 0.3 of the rate.
        let tone = |k: i32, t: f64| (2.0 * PI * 500.0 * f64::from(k) * t).sin();
        let at = |t: f64| amplitudes.iter().zip(1..).map(|(a, k)| a * tone(k, t)).sum();
        let record = Sampled::new(-0.05, dt_s, (0..1500).map(|k| at(-0.05 + f64::from(k) * dt_s)).collect()).unwrap();
        let there = Resampling { rate_hz: 1e4 * up, interpolation: Interpolation::Sinc };
        let back = Resampling { rate_hz: 1e4, interpolation: Interpolation::Sinc };
        let found = resample(&resample(&record, there).unwrap(), back).unwrap();
        // Twice the 1e-4 of the kernel on amplitudes that add up to 600; the ends by the reach of both kernels.
        for k in 100..found.len() - 100 {
            let expected = at(found.time_s(k));
            prop_assert!((found.samples()[k] - expected).abs() < 0.12, "{k}: {} {expected}", found.samples()[k]);
        }
    }
}

fn run(samples: Vec<f64>, class: Cfc, mode: CfcMode) -> Vec<f64> {
    let settings = FilterSettings { class: Class::Cfc(class), mode, zero_level: ZeroLevel::None, butterworth: None };
    filter(&Sampled::new(0.0, DT_S, samples).unwrap(), None, &settings).unwrap().samples.into_samples()
}

fn any_class() -> impl Strategy<Value = Cfc> {
    prop::sample::select(Cfc::ALL.to_vec())
}

fn any_mode() -> impl Strategy<Value = CfcMode> {
    prop::sample::select(vec![CfcMode::Iso6487, CfcMode::SaeReflect, CfcMode::SaeZeroState])
}

/// Two records of equal length, with accelerations of a crash in m/s².
fn two_records() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    prop::collection::vec((-1000.0..1000.0, -1000.0..1000.0), 4..400).prop_map(|pairs| pairs.into_iter().unzip())
}

proptest! {
    #[test]
    fn the_filter_is_linear(
        (a, b) in two_records(), p in -10.0..10.0_f64, q in -10.0..10.0_f64, class in any_class(), mode in any_mode()
    ) {
        let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| p * a + q * b).collect();
        let (a, b) = (run(a, class, mode), run(b, class, mode));
        for ((y, a), b) in run(sum, class, mode).into_iter().zip(a).zip(b) {
            // Inputs up to 2e4 and about 1e3 roundings in a recursion of condition 1e2: well below 1e-8.
            prop_assert!((y - (p * a + q * b)).abs() < 1e-8);
        }
    }

    #[test]
    fn the_filter_has_no_phase(
        pulse in prop::collection::vec(-1000.0..1000.0, 1..200), class in any_class(), mode in any_mode()
    ) {
        // Rest on both sides for longer than the filter rings, so that the ends have no part in it.
        let rest = vec![0.0; 1500];
        let record = [rest.as_slice(), &pulse, &rest].concat();
        let mut backward = record.clone();
        backward.reverse();
        let forward = run(record, class, mode);
        for (y, z) in forward.iter().zip(run(backward, class, mode).iter().rev()) {
            // The order of the passes changes rounding only: 1e-13 of the largest sample, times the condition of the
            // recursion.
            prop_assert!((y - z).abs() < 1e-8, "{y} {z}");
        }
        // Gain 1 at frequency 0: the area of the pulse, hence the change of velocity, is kept.
        let area: f64 = pulse.iter().sum();
        prop_assert!((forward.iter().sum::<f64>() - area).abs() < 1e-7);
    }

    #[test]
    fn a_straight_line_passes_unchanged_where_the_ends_are_mirrored(
        level in -1000.0..1000.0, slope in -10.0..10.0, n in 250_usize..600
    ) {
        let line: Vec<f64> = (0..n).map(|k| level + slope * k as f64).collect();
        let filtered = run(line.clone(), Cfc::Cfc180, CfcMode::Iso6487);
        // Starting from a mean instead of the line leaves a transient of a few slopes, which decays over the 100
        // mirrored samples by the pole radius 0.85 of CFC 180 to 1e-7; at CFC 60 (0.946) it would be 4e-3.
        for (x, y) in line.iter().zip(filtered) {
            prop_assert!((x - y).abs() < 1e-5, "{x} {y}");
        }
    }

    #[test]
    fn no_record_makes_it_panic(
        samples in prop::collection::vec(prop::num::f64::NORMAL, 0..60), dt_exponent in -300..300, mode in any_mode()
    ) {
        let record = Sampled::new(0.0, 10_f64.powi(dt_exponent), samples).unwrap();
        let settings = FilterSettings { class: Class::Cfc(Cfc::Cfc60), mode, ..FilterSettings::default() };
        if let Ok(filtered) = filter(&record, None, &settings) {
            prop_assert!(filtered.samples.samples().iter().all(|y| y.is_finite()));
        }
    }
}
