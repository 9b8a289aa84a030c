//! Frequency response of the identified transfer functions.

use crate::words;
use std::f64::consts::{PI, TAU};

use crate::drawing::{Axis, Colour, Dash, Figure, Look, Panel, over};
use crate::findings::{Model, Run, words_and_unit};
use crumple_artifact::records::TransferFunctionV1;

const POINTS: usize = 400;

/// Magnitude and phase of one model, with the words of its ends and its band.
struct Curve {
    frequencies_hz: Vec<f64>,
    magnitude_db: Vec<f64>,
    phase_deg: Vec<f64>,
    input: String,
    output: String,
    /// Where the band comes from; its edges are lower and upper magnitude (dB), lower and upper phase (degrees).
    band: Option<String>,
    edges: [Vec<Option<f64>>; 4],
}

/// Magnitude and phase of every model with a response or a transfer function; `None` where there is none.
pub fn figure(run: &Run) -> Option<Figure> {
    let nyquist_hz = run.acceleration().map(|a| a.rate_hz() / 2.0);
    let moduli: Vec<f64> = run
        .models
        .iter()
        .filter(|model| model.response.is_some() || model.transfer_function.is_some())
        .flat_map(|model| &model.modes)
        .map(|mode| mode.natural_frequency_rad_per_s / TAU)
        .filter(|f| *f > 1e-3)
        .collect();
    let span = span_hz(&moduli, nyquist_hz);
    let models: Vec<(&Model, Curve)> =
        run.models.iter().filter_map(|model| Some((model, curve(model, span)?))).collect();
    let (_, first) = models.first()?;
    let shown = models.iter().flat_map(|(_, curve)| &curve.frequencies_hz);
    let (low, high) = shown.fold((f64::INFINITY, 0.0_f64), |(l, h), &f| (l.min(f), h.max(f)));

    let axis = || Axis { logarithmic: true, ..Axis::new("frequency, Hz").from_to([low, high]) };
    let mut figure = Figure::new("bode", "Frequency response");
    let mut magnitude = Panel::new(axis(), Axis::new("magnitude, dB"));
    let mut phase = Panel::new(axis(), Axis::new("phase, °"));
    // The names of the modes of all models would cover each other.
    let is_drawn = |id: &String| models.iter().any(|(model, _)| model.id == *id);
    let marked = run.model_order().into_iter().map(|place| &run.models[place].id).find(|id| is_drawn(id));
    for (place, (model, curve)) in models.iter().enumerate() {
        let entry = figure.entry(&model.id, Look::of_series(place), true);
        for (panel, line, edges) in [
            (&mut magnitude, &curve.magnitude_db, &curve.edges[..2]),
            (&mut phase, &curve.phase_deg, &curve.edges[2..]),
        ] {
            panel.band(entry, &band(&curve.frequencies_hz, &edges[0], &edges[1]));
            panel.line(entry, over(&curve.frequencies_hz, line));
        }
        // One mark a resonance: a conjugate pair is one, an aperiodic pole none.
        let is_marked = Some(&model.id) == marked;
        for mode in model.modes.iter().filter(|mode| is_marked && mode.im_rad_per_s > 0.0) {
            let f = mode.natural_frequency_rad_per_s / TAU;
            if !(low..=high).contains(&f) {
                continue;
            }
            let damping = mode.damping_ratio.map_or_else(String::new, |z| format!(", ζ {}", words::significant(z, 3)));
            magnitude.mark(f, format!("{} Hz{damping}", words::significant(f, 3)), Colour::Muted, Dash::Dotted);
            phase.mark(f, "", Colour::Muted, Dash::Dotted);
        }
    }
    let ((in_words, _), (out_words, out_unit)) = (words_and_unit(&first.input), words_and_unit(&first.output));
    let mut caption = format!(
        "From {} to {}{}. Phase is unwrapped; natural frequencies of oscillating poles of the recommended, else the \
         closest model are marked.",
        words(in_words, "the input"),
        words(out_words, "the output"),
        if out_unit.is_some() { ", SI units" } else { "" }
    );
    for (model, band) in models.iter().filter_map(|(model, curve)| Some((model, curve.band.as_ref()?))) {
        caption.push_str(&format!(" Band of {}: {band}.", model.id));
    }
    if models.iter().all(|(_, curve)| curve.band.is_none()) {
        caption.push_str(" No band: the records hold no uncertainty of these models.");
    }
    figure.caption = caption;
    figure.panels = vec![magnitude, phase];
    Some(figure.tidy())
}

fn curve(model: &Model, (low, high): (f64, f64)) -> Option<Curve> {
    let degrees = |x: f64| x * 180.0 / PI;
    if let Some(r) = &model.response {
        let decibel = |edge: &[Option<f64>]| edge.iter().map(|x| x.filter(|x| *x > 0.0).map(decibel)).collect();
        let turned = |edge: &[Option<f64>]| edge.iter().map(|x| x.map(degrees)).collect();
        return Some(Curve {
            frequencies_hz: r.frequency_hz.clone(),
            magnitude_db: r.magnitude.iter().copied().map(self::decibel).collect(),
            phase_deg: r.phase_rad.iter().copied().map(degrees).collect(),
            input: r.input.clone(),
            output: r.output.clone(),
            band: r.band.clone(),
            edges: [
                decibel(&r.magnitude_lower),
                decibel(&r.magnitude_upper),
                turned(&r.phase_lower_rad),
                turned(&r.phase_upper_rad),
            ],
        });
    }
    let tf = model.transfer_function.as_ref().filter(|tf| !tf.numerator.is_empty() && !tf.denominator.is_empty())?;
    let frequencies_hz: Vec<f64> =
        (0..POINTS).map(|k| low * (high / low).powf(k as f64 / (POINTS - 1) as f64)).collect();
    let (magnitude_db, phase_deg) = response(tf, &frequencies_hz);
    let (input, output) = (tf.input.clone(), tf.output.clone());
    Some(Curve { frequencies_hz, magnitude_db, phase_deg, input, output, band: None, edges: Default::default() })
}

fn decibel(x: f64) -> f64 {
    20.0 * x.log10()
}

/// Frequency, lower and upper edge, where both are known.
fn band(frequencies_hz: &[f64], lower: &[Option<f64>], upper: &[Option<f64>]) -> Vec<[f64; 3]> {
    let edges = frequencies_hz.iter().zip(lower.iter().zip(upper));
    edges.filter_map(|(f, (l, u))| Some([*f, (*l)?, (*u)?])).collect()
}

fn words<'a>(text: &'a str, otherwise: &'a str) -> &'a str {
    if text.trim().is_empty() { otherwise } else { text.trim() }
}

/// A decade below the lowest and above the highest natural frequency, up to half the sampling rate.
fn span_hz(natural_hz: &[f64], nyquist_hz: Option<f64>) -> (f64, f64) {
    let (low, high) = natural_hz.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), &f| (l.min(f), h.max(f)));
    let (low, high) = if high > 0.0 { (low / 10.0, high * 10.0) } else { (0.1, 1000.0) };
    let high = nyquist_hz.map_or(high, |nyquist| high.min(nyquist));
    if high > low { (low, high) } else { (low, 10.0 * low) }
}

/// Magnitude in dB and unwrapped phase in degrees.
fn response(tf: &TransferFunctionV1, frequencies_hz: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut magnitude_db = Vec::with_capacity(frequencies_hz.len());
    let mut phase_deg = Vec::with_capacity(frequencies_hz.len());
    let mut last = 0.0;
    for &f in frequencies_hz {
        let (num_re, num_im) = at_i_omega(&tf.numerator, TAU * f);
        let (den_re, den_im) = at_i_omega(&tf.denominator, TAU * f);
        magnitude_db.push(20.0 * (num_re.hypot(num_im) / den_re.hypot(den_im)).log10());
        let mut phase = num_im.atan2(num_re) - den_im.atan2(den_re);
        // The first point is taken to (−π, π], each other to the turn nearest to the one before.
        phase -= TAU * ((phase - last) / TAU).round();
        last = phase;
        phase_deg.push(phase * 180.0 / PI);
    }
    (magnitude_db, phase_deg)
}

/// A polynomial, highest power first, at `iω` by Horner's rule.
fn at_i_omega(coefficients: &[f64], omega: f64) -> (f64, f64) {
    coefficients.iter().fold((0.0, 0.0), |(re, im), c| (c - omega * im, omega * re))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damped_oscillator_at_its_natural_frequency_is_a_quarter_turn_behind() {
        // 1/(s² + 2ζω s + ω²) at iω is 1/(2ζω² i).
        let (omega, zeta) = (TAU * 5.0, 0.2);
        let tf = TransferFunctionV1 {
            numerator: vec![1.0],
            denominator: vec![1.0, 2.0 * zeta * omega, omega * omega],
            input: String::new(),
            output: String::new(),
            delay_s: None,
        };
        let (magnitude_db, phase_deg) = response(&tf, &[5.0]);
        let expected = -20.0 * (2.0 * zeta * omega * omega).log10();
        // 1e-9: rounding of a handful of operations, far below what a plot shows.
        assert!((magnitude_db[0] - expected).abs() < 1e-9);
        assert!((phase_deg[0] + 90.0).abs() < 1e-9);
    }

    #[test]
    fn phase_runs_on_beyond_half_a_turn() {
        // Three equal lags: −270° far above their corner.
        let tf = TransferFunctionV1 {
            numerator: vec![1.0],
            denominator: vec![1.0, 3.0, 3.0, 1.0],
            input: String::new(),
            output: String::new(),
            delay_s: None,
        };
        let frequencies: Vec<f64> = (0..200).map(|k| 1e-3 * 10_f64.powf(f64::from(k) / 33.0)).collect();
        let (_, phase_deg) = response(&tf, &frequencies);
        // The lags are arctan(ω): within 3·180/(π·ω) degrees of −270 at the last frequency, ω ≈ 6.7e3.
        assert!((phase_deg[199] + 270.0).abs() < 0.03, "{}", phase_deg[199]);
    }

    #[test]
    fn the_span_stays_below_half_the_sampling_rate() {
        assert_eq!(span_hz(&[4.0, 400.0], Some(2000.0)), (0.4, 2000.0));
        assert_eq!(span_hz(&[], None), (0.1, 1000.0));
    }
}
