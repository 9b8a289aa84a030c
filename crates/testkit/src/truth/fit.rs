//! How well the motion of a candidate follows the record, by the waves of the artifacts.

use super::run::Made;

/// `100 (1 - |x - y| / |x - mean x|)`, percent, of the displacement of the record, x, and of a candidate, y, over the
/// window that its simulation was compared in, at the instants of the record. `None` without one of the waves.
pub fn fit_percent(made: &Made, candidate: &str) -> Option<f64> {
    let simulation = &made.candidate(candidate)?["simulation"];
    let (from_s, to_s) = (simulation["from_s"].as_f64()?, simulation["to_s"].as_f64()?);
    let zero_s = made.number("/events/time_zero_s")?;
    let channel = made.summary.pointer("/events/channel")?.as_str()?;
    let record = made.waves.get(&format!("{channel}/displacement"))?.sampled.clone();
    let model = made.waves.get(&format!("{candidate}/displacement"))?.sampled.clone();
    let window = (0..record.len()).map(|k| record.t0_s() + k as f64 * record.dt_s() - zero_s);
    let pairs: Vec<(f64, f64)> = window
        .zip(record.samples())
        .filter(|(time_s, _)| (from_s - 1e-9..=to_s + 1e-9).contains(time_s))
        .filter_map(|(time_s, x)| Some((*x, model.at(time_s)?)))
        .collect();
    let mean = pairs.iter().map(|(x, _)| x).sum::<f64>() / pairs.len() as f64;
    let [misfit, spread] = [
        pairs.iter().map(|(x, y)| (x - y).powi(2)).sum::<f64>(),
        pairs.iter().map(|(x, _)| (x - mean).powi(2)).sum::<f64>(),
    ];
    (spread > 0.0).then(|| 100.0 * (1.0 - (misfit / spread).sqrt()))
}
