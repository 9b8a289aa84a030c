//! Times of the filters on one thread, each beside a plain memory pass over the same record.

use crumple_signal::{
    Butterworth, Cfc, CfcMode, Coefficients, FilterError, FilterSettings, Interpolation, Phase, Resampling, Sampled,
    filter, filter_both_ways, filter_both_ways_into, resample, run_sections,
};
use crumple_testkit::benchmark::{best_ms, memory_pass_ms, print_line};

const DT_S: f64 = 1e-5;

fn main() -> Result<(), FilterError> {
    for n in [10_000, 1_000_000, 10_000_000] {
        let samples: Vec<f64> = (0..n).map(|k| -200.0 * (1e-3 * f64::from(k)).sin()).collect();
        let pass_ms = memory_pass_ms(&samples);
        let coefficients = Coefficients::new(Cfc::Cfc60, CfcMode::Iso6487, DT_S);
        let mut output = Vec::new();
        let ms = best_ms(|| filter_both_ways_into(&samples, 0.1, &coefficients, &mut output, &|_| ()));
        print_line(&format!("cfc 60, both passes, {n} samples, buffer used again"), ms, pass_ms);
        // Two results at once, so that the allocator cannot give the memory of the run before.
        let ms = best_ms(|| [0.1, 0.2].map(|zero| filter_both_ways(&samples, zero, &coefficients)));
        print_line(&format!("cfc 60, both passes, {n} samples, fresh memory"), ms / 2.0, pass_ms);
        let record = Sampled::new(-0.05, DT_S, samples).map_err(FilterError::Result)?;
        let ms = best_ms(|| filter(&record, None, &FilterSettings::default()));
        print_line(&format!("zero level, cfc 60, checks, {n} samples"), ms, pass_ms);
        if n == 1_000_000 {
            others(&record, pass_ms)?;
        }
    }
    Ok(())
}

/// What is not run on every record, once.
fn others(record: &Sampled, pass_ms: f64) -> Result<(), FilterError> {
    let n = record.len();
    let design = Butterworth { cutoff_hz: 100.0, order: 4, phase: Phase::Zero }.design(DT_S)?;
    let ms = best_ms(|| run_sections(record.samples(), 0.1, &design));
    print_line(&format!("butterworth of order 4, zero phase, {n} samples"), ms, pass_ms);
    for interpolation in [Interpolation::Sinc, Interpolation::Linear] {
        let to = Resampling { rate_hz: 20_000.0, interpolation };
        let ms = best_ms(|| resample(record, to));
        print_line(&format!("100 kHz to 20 kHz, {}, {n} samples", interpolation.name()), ms, pass_ms);
    }
    // A pulse that ends in exact zeros decays into subnormal numbers, which some processors are slow at.
    let mut pulse = vec![0.0; n];
    pulse[1000..20_000].fill(-200.0);
    let coefficients = Coefficients::new(Cfc::Cfc60, CfcMode::Iso6487, DT_S);
    let ms = best_ms(|| filter_both_ways(&pulse, 0.0, &coefficients));
    print_line(&format!("cfc 60, both passes, {n} samples, long tail of zeros"), ms, pass_ms);
    Ok(())
}
