//! Times of the filters on one thread, each beside a plain memory pass over the same record.

use crumple_signal::{
    Butterworth, Cfc, CfcMode, Coefficients, FilterError, FilterSettings, Interpolation, Phase, Resampling, Sampled,
    filter, filter_both_ways, filter_both_ways_into, resample, run_sections,
};
use crumple_testkit::benchmark::{Figure, best_s, memory_pass_s};

const DT_S: f64 = 1e-5;

fn main() -> Result<(), FilterError> {
    for n in [10_000, 1_000_000, 10_000_000] {
        let samples: Vec<f64> = (0..n).map(|k| -200.0 * (1e-3 * f64::from(k)).sin()).collect();
        let pass_s = memory_pass_s(&samples);
        let coefficients = Coefficients::new(Cfc::Cfc60, CfcMode::Iso6487, DT_S);
        let mut output = Vec::new();
        let s = best_s(|| filter_both_ways_into(&samples, 0.1, &coefficients, &mut output, &|_| ()));
        let figure = Figure::new(format!("CFC 60, both passes, {n} samples, buffer used again"), s, pass_s);
        if n == 1_000_000 { figure.aim(5e-3, "scipy 10 ms") } else { figure }.print();
        // Two results at once, so that the allocator cannot give the memory of the run before.
        let s = best_s(|| [0.1, 0.2].map(|zero| filter_both_ways(&samples, zero, &coefficients)));
        Figure::new(format!("CFC 60, both passes, {n} samples, fresh memory"), s / 2.0, pass_s).print();
        let record = Sampled::new(-0.05, DT_S, samples).map_err(FilterError::Result)?;
        let s = best_s(|| filter(&record, None, &FilterSettings::default()));
        Figure::new(format!("zero level, CFC 60, checks, {n} samples"), s, pass_s).print();
        if n == 1_000_000 {
            others(&record, pass_s)?;
        }
    }
    Ok(())
}

/// What is not run on every record, once.
fn others(record: &Sampled, pass_s: f64) -> Result<(), FilterError> {
    let n = record.len();
    let design = Butterworth { cutoff_hz: 100.0, order: 4, phase: Phase::Zero }.design(DT_S)?;
    let s = best_s(|| run_sections(record.samples(), 0.1, &design));
    Figure::new(format!("Butterworth of order 4, zero phase, {n} samples"), s, pass_s).print();
    for interpolation in [Interpolation::Sinc, Interpolation::Linear] {
        let to = Resampling { rate_hz: 20_000.0, interpolation };
        let s = best_s(|| resample(record, to));
        Figure::new(format!("100 kHz to 20 kHz, {}, {n} samples", interpolation.name()), s, pass_s).print();
    }
    // A pulse that ends in exact zeros decays into subnormal numbers, which some processors are slow at.
    let mut pulse = vec![0.0; n];
    pulse[1000..20_000].fill(-200.0);
    let coefficients = Coefficients::new(Cfc::Cfc60, CfcMode::Iso6487, DT_S);
    let s = best_s(|| filter_both_ways(&pulse, 0.0, &coefficients));
    Figure::new(format!("CFC 60, both passes, {n} samples, long tail of zeros"), s, pass_s).print();
    Ok(())
}
