//! Butterworth filters, resampling and delay: what holds for every design and record.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crumple_filter::{Butterworth, Design, Interpolation, Pass, Phase, Resampling, delay, resample, run_sections};
use crumple_signal::Sampled;
use proptest::prelude::*;

const DT_S: f64 = 1e-4;

fn any_phase() -> impl Strategy<Value = Phase> {
    prop::sample::select(vec![Phase::Zero, Phase::Causal])
}

/// Filters of every kind with cut-offs from 0.2 % to 45 % of the rate.
fn any_design() -> impl Strategy<Value = Design> {
    let pass = prop_oneof![
        (20.0..4500.0_f64).prop_map(Pass::Low),
        (20.0..4500.0_f64).prop_map(Pass::High),
        (20.0..2000.0_f64, 1.2..2.0_f64).prop_map(|(low, ratio)| Pass::Band(low, low * ratio)),
    ];
    (pass, 1..=8_usize, any_phase())
        .prop_map(|(pass, order, phase)| Butterworth { pass, order, phase }.design(DT_S).unwrap())
}

/// Cut-off of the analogue prototype behind a digital frequency.
fn warped(frequency_hz: f64) -> f64 {
    (PI * frequency_hz * DT_S).tan()
}

/// Gain of one pass after the definition of the Butterworth filter, without any section.
fn closed_form(pass: Pass, order: usize, phase: Phase, f: f64) -> f64 {
    let w = warped(f);
    let ratio = match pass {
        Pass::Low(cutoff) => w / warped(cutoff),
        Pass::High(cutoff) => warped(cutoff) / w,
        Pass::Band(low, high) => {
            let (w1, w2) = (warped(low), warped(high));
            (w * w - w1 * w2) / (w * (w2 - w1))
        }
    };
    let power = ratio.abs().powf(2.0 * order as f64);
    match phase {
        Phase::Causal => 1.0 / (1.0 + power).sqrt(),
        // Two passes of a prototype widened so that the cut-off stays.
        Phase::Zero => 1.0 / (1.0 + power * (2.0_f64.sqrt() - 1.0)),
    }
}

proptest! {
    #[test]
    fn the_cut_off_is_at_minus_three_decibels(design in any_design()) {
        for f in design.asked.pass.frequencies_hz() {
            // Coefficients rounded to 1e-16 around poles 1e-3 from the unit circle, up to 8 of them: 1e-10 for one.
            prop_assert!((design.gain(f) - FRAC_1_SQRT_2).abs() < 1e-9, "{f} Hz: {}", design.gain(f));
        }
    }

    #[test]
    fn the_response_is_that_of_the_definition(design in any_design(), f in 20.0..4900.0_f64) {
        let Butterworth { pass, order, phase } = design.asked;
        let expected = closed_form(pass, order, phase, f);
        // As above; relative to 1, the gain in the pass band.
        prop_assert!((design.gain(f) - expected).abs() < 1e-9, "{} {expected}", design.gain(f));
    }

    #[test]
    fn the_sections_are_linear(
        pairs in prop::collection::vec((-1000.0..1000.0_f64, -1000.0..1000.0_f64), 4..300),
        p in -3.0..3.0_f64, cutoff in 100.0..4000.0_f64, order in 1..=6_usize, phase in any_phase()
    ) {
        let design = Butterworth { pass: Pass::Low(cutoff), order, phase }.design(DT_S).unwrap();
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
        let design = Butterworth { pass: Pass::Low(cutoff), order, phase: Phase::Zero }.design(DT_S).unwrap();
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
    fn a_constant_passes_a_low_pass_and_not_the_others(level in -1000.0..1000.0_f64, design in any_design()) {
        let output = run_sections(&[level; 300], 0.0, &design);
        let expected = if matches!(design.asked.pass, Pass::Low(_)) { level } else { 0.0 };
        for y in output {
            // Gain at frequency 0 from coefficients rounded to 1e-16 over 1 - b1 - b2 down to 1e-4, for 16 sections.
            prop_assert!((y - expected).abs() < 1e-6, "{y}");
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

    #[test]
    fn the_delay_of_a_shifted_band_limited_pulse_is_its_shift(
        shift_s in -3e-3..3e-3_f64, width_s in 4e-4..1.5e-3_f64, skew in -1.0..1.0_f64, scale in 0.2..5.0_f64
    ) {
        let pulse = |centre: f64, scale: f64| {
            let at = |t: f64| {
                let u = (t - centre) / width_s;
                scale * (-u * u / 2.0).exp() * (1.0 + skew * u)
            };
            Sampled::new(0.0, DT_S, (0..600).map(|k| at(f64::from(k) * DT_S)).collect()).unwrap()
        };
        let found = delay(&pulse(0.03 + shift_s, scale), &pulse(0.03, 1.0), 5e-3).unwrap();
        // A Gaussian 4 samples wide leaves 1e-34 above half the rate; Newton ends at 1e-12 of a sample, the rest is
        // rounding of the spectra.
        prop_assert!((found.delay_s - shift_s).abs() < 1e-9, "{found:?}");
    }
}
