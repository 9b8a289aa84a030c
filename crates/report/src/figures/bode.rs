//! Frequency response of the identified transfer functions.

use std::f64::consts::{PI, TAU};

use crumple_artifact::records::TransferFunctionV1;
use serde_json::json;

use crate::Run;
use crate::escape::html;
use crate::figure::{Figure, axis, base_layout, colour, compact, room_above, set, short};
use crate::people::significant;

const POINTS: usize = 400;
const HEIGHT_PX: u32 = 500;
/// Rows that the names of natural frequencies are spread over.
const NAME_ROWS: u32 = 3;

/// Magnitude and phase of every model with a transfer function; `None` where there is none.
pub fn figure(run: &Run) -> Option<Figure> {
    let models: Vec<_> = run
        .models
        .iter()
        .filter_map(|model| Some((model, model.transfer_function.as_ref()?)))
        .filter(|(_, tf)| !tf.numerator.is_empty() && !tf.denominator.is_empty())
        .collect();
    let (_, first) = models.first()?;
    let nyquist_hz = run.acceleration().map(|a| a.rate_hz() / 2.0);
    let moduli: Vec<f64> = models
        .iter()
        .flat_map(|(model, _)| &model.modes)
        .map(|mode| mode.natural_frequency_rad_per_s / TAU)
        .filter(|f| *f > 1e-3)
        .collect();
    let (low, high) = span_hz(&moduli, nyquist_hz);
    let frequencies: Vec<f64> = (0..POINTS).map(|k| low * (high / low).powf(k as f64 / (POINTS - 1) as f64)).collect();

    let (mut traces, mut shapes, mut labels) = (Vec::new(), Vec::new(), Vec::new());
    for (place, (model, tf)) in models.iter().enumerate() {
        let line = json!({"color": colour::SERIES[place % colour::SERIES.len()], "width": 2,
                          "dash": colour::DASHES[place % colour::DASHES.len()]});
        let (magnitude_db, phase_deg) = response(tf, &frequencies);
        let x = compact_log(&frequencies);
        traces.push(
            json!({"type": "scatter", "mode": "lines", "x": x.clone(), "y": compact(magnitude_db.iter().copied()),
            "name": html(&model.id), "legendgroup": model.id, "line": line, "hovertemplate": "%{y:.2f} dB"}),
        );
        traces.push(json!({"type": "scatter", "mode": "lines", "x": x, "y": compact(phase_deg.iter().copied()),
            "yaxis": "y2", "name": html(&model.id), "legendgroup": model.id, "showlegend": false, "line": line,
            "hovertemplate": "%{y:.1f}°"}));
        // One label a resonance: a conjugate pair is one, an aperiodic pole none.
        for mode in model.modes.iter().filter(|mode| mode.im_rad_per_s > 0.0) {
            let f = mode.natural_frequency_rad_per_s / TAU;
            if !(low..=high).contains(&f) {
                continue;
            }
            shapes.push(json!({"type": "line", "x0": short(f), "x1": short(f), "y0": 0, "y1": 1, "yref": "paper",
                               "line": {"color": colour::GUIDE, "width": 1.2, "dash": "dot"}, "layer": "below"}));
            let damping = mode.damping_ratio.map_or_else(String::new, |z| format!(", ζ {}", significant(z, 3)));
            // A label on a logarithmic axis stands at the logarithm. Neighbours take turns in height.
            let level = labels.len() as u32 % NAME_ROWS;
            labels.push(
                json!({"x": short(f.log10()), "y": 1, "yref": "paper", "xanchor": "center", "yanchor": "bottom",
                "yshift": 1 + 16 * level, "showarrow": false, "text": format!("{} Hz{damping}", significant(f, 3)),
                "font": {"size": 12, "color": colour::MUTED}}),
            );
        }
    }
    let labels_drawn = labels.len();
    let mut layout = base_layout();
    set(
        &mut layout,
        json!({
            "hovermode": "x unified", "hoversubplots": "axis",
            "xaxis": axis("frequency, Hz", json!({"type": "log", "anchor": "y2", "hoverformat": ".3~f",
                "range": [short(low.log10()), short(high.log10())], "dtick": 1, "minor": {"showgrid": true, "gridcolor": "#f1f3f5"}})),
            "yaxis": axis("magnitude, dB", json!({"domain": [0.44, 1.0]})),
            "yaxis2": axis("phase, °", json!({"domain": [0.0, 0.38]})),
            "shapes": shapes, "annotations": labels,
        }),
    );
    room_above(&mut layout, HEIGHT_PX, (labels_drawn as u32).clamp(1, NAME_ROWS), 1);
    Some(Figure {
        id: "bode",
        title: "Frequency response",
        caption: format!(
            "From {} to {}, SI units. Phase is unwrapped; natural frequencies of oscillating poles are marked.",
            words(&first.input, "the input"),
            words(&first.output, "the output")
        ),
        height_px: HEIGHT_PX,
        half_width: false,
        traces,
        layout,
    })
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

/// Frequencies on a logarithmic grid: digits relative to each value, not to the span.
fn compact_log(frequencies: &[f64]) -> serde_json::Value {
    frequencies.iter().map(|f| format!("{f:.5e}").parse::<f64>().unwrap_or(*f)).collect()
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
