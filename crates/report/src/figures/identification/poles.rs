//! Poles in the s plane with lines of equal damping and circles of equal frequency.

use std::f64::consts::TAU;

use serde_json::{Value, json};

use crate::Run;
use crate::drawing::figure::{Figure, axis, base_layout, colour, set, short};
use crate::text::escape::html;
use crate::text::numbers::{decimals, significant};

/// Marker symbols of the models, so that they differ without colour too.
const SYMBOLS: [&str; 6] = ["x", "cross", "star", "hexagram", "diamond-tall", "hourglass"];
const DAMPING_RAYS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
/// A pole this many times farther out than the next nearer one lies outside the first view.
const FAR: f64 = 8.0;

/// Every model's poles; `None` where no model has any.
pub fn figure(run: &Run) -> Option<Figure> {
    let mut moduli: Vec<f64> =
        run.models.iter().flat_map(|m| &m.modes).map(|p| p.re_per_s.hypot(p.im_rad_per_s)).collect();
    if moduli.is_empty() {
        return None;
    }
    moduli.sort_by(f64::total_cmp);
    let (radius, outside) = first_view(&moduli);

    let (mut traces, unstable) = pole_traces(run);
    let (zeros, far_zeros) = zero_traces(run, radius);
    traces.extend(zeros);
    let (shapes, labels) = guide_lines(radius);
    let caption = caption(unstable, far_zeros, outside);
    let mut layout = base_layout();
    set(
        &mut layout,
        json!({
            "hovermode": "closest",
            "xaxis": axis("real part, 1/s", json!({
                "range": [short(-1.2 * radius), short(0.45 * radius)], "zeroline": false, "constrain": "range",
            })),
            "yaxis": axis("imaginary part, rad/s", json!({"range": [short(-1.2 * radius), short(1.2 * radius)],
                "scaleanchor": "x", "scaleratio": 1, "constrain": "range"})),
            "shapes": shapes, "annotations": labels,
        }),
    );
    Some(Figure {
        id: "poles",
        title: "Poles and zeros of the identified models",
        caption,
        height_px: 480,
        half_width: true,
        traces,
        layout,
    })
}

/// The poles of every model, stable and unstable apart, and how many are unstable.
fn pole_traces(run: &Run) -> (Vec<Value>, usize) {
    let mut traces = Vec::new();
    let mut unstable = 0;
    for (place, model) in run.models.iter().enumerate() {
        for stable in [true, false] {
            let poles: Vec<_> = model.modes.iter().filter(|p| (p.re_per_s <= 0.0) == stable).collect();
            if poles.is_empty() {
                continue;
            }
            if !stable {
                unstable += poles.len();
            }
            let hover: Vec<String> = poles
                .iter()
                .map(|p| {
                    let damping =
                        p.damping_ratio.map_or_else(String::new, |z| format!("<br>ζ = {}", significant(z, 4)));
                    format!(
                        "{} {} {}i 1/s<br>f<sub>n</sub> = {} Hz{damping}",
                        significant(p.re_per_s, 5),
                        if p.im_rad_per_s < 0.0 { "−" } else { "+" },
                        significant(p.im_rad_per_s.abs(), 5),
                        significant(p.natural_frequency_rad_per_s / TAU, 4)
                    )
                })
                .collect();
            let id = html(&model.id);
            traces.push(json!({
                "type": "scatter", "mode": "markers",
                "x": poles.iter().map(|p| short(p.re_per_s)).collect::<Vec<_>>(),
                "y": poles.iter().map(|p| short(p.im_rad_per_s)).collect::<Vec<_>>(),
                "text": hover, "hovertemplate": format!("%{{text}}<extra>{id}</extra>"),
                "name": if stable { id.clone() } else { format!("{id}, unstable") },
                "marker": if stable {
                    json!({"symbol": SYMBOLS[place % SYMBOLS.len()], "size": 11,
                           "color": colour::SERIES[place % colour::SERIES.len()]})
                } else {
                    json!({"symbol": "triangle-up-open", "size": 13, "color": "#b3261e", "line": {"width": 2.5}})
                },
            }));
        }
    }
    (traces, unstable)
}

/// The zeros of every model, and how many lie outside the first view of this radius.
fn zero_traces(run: &Run, radius: f64) -> (Vec<Value>, usize) {
    let mut traces = Vec::new();
    let mut far_zeros = 0;
    for (place, model) in run.models.iter().enumerate() {
        let Some(response) = &model.response else { continue };
        let zeros: Vec<(f64, f64)> =
            response.zeros_re_per_s.iter().zip(&response.zeros_im_rad_per_s).map(|(re, im)| (*re, *im)).collect();
        far_zeros += zeros.iter().filter(|(re, im)| re.hypot(*im) > 1.2 * radius).count();
        if zeros.is_empty() {
            continue;
        }
        let id = html(&model.id);
        traces.push(json!({
            "type": "scatter", "mode": "markers",
            "x": zeros.iter().map(|z| short(z.0)).collect::<Vec<_>>(),
            "y": zeros.iter().map(|z| short(z.1)).collect::<Vec<_>>(),
            "hovertemplate": format!("zero %{{x:.5~g}} %{{y:+.5~g}}i 1/s<extra>{id}</extra>"),
            // No name in the legend without a mark in the first view.
            "showlegend": zeros.iter().any(|(re, im)| re.hypot(*im) <= 1.2 * radius),
            "name": format!("{id}, zeros"),
            "visible": if run.models.len() > 3 { json!("legendonly") } else { json!(true) },
            "marker": {"symbol": "circle-open", "size": 10, "color": colour::SERIES[place % colour::SERIES.len()],
                       "line": {"width": 2}},
        }));
    }
    (traces, far_zeros)
}

/// Rays of equal damping, rings of equal frequency and the imaginary axis, with their labels.
fn guide_lines(radius: f64) -> (Vec<Value>, Vec<Value>) {
    let (mut shapes, mut labels) = (Vec::new(), Vec::new());
    let guide = json!({"color": colour::GUIDE, "width": 1, "dash": "dot"});
    let label = |x: f64, y: f64, text: String, xanchor: &str, yanchor: &str| {
        json!({"x": short(x), "y": short(y), "text": text, "showarrow": false, "xanchor": xanchor, "yanchor": yanchor,
               "font": {"size": 11, "color": colour::MUTED}, "bgcolor": "rgba(255,255,255,0.75)"})
    };
    for damping in DAMPING_RAYS {
        let (x, y) = (-damping * radius, (1.0 - damping * damping).sqrt() * radius);
        for sign in [1.0, -1.0] {
            shapes.push(json!({"type": "line", "x0": 0, "y0": 0, "x1": short(x), "y1": short(sign * y), "line": guide,
                               "layer": "below"}));
        }
        labels.push(label(x, y, format!("ζ {}", decimals(damping, 1)), "right", "bottom"));
    }
    let step = nice_step(radius / TAU / 2.5);
    for ring in 1..=4 {
        let r = TAU * step * f64::from(ring);
        if r > 1.02 * radius {
            break;
        }
        shapes.push(json!({"type": "circle", "x0": short(-r), "x1": short(r), "y0": short(-r), "y1": short(r),
                           "line": guide, "layer": "below"}));
        labels.push(label(0.0, -r, format!("{} Hz", significant(step * f64::from(ring), 2)), "left", "middle"));
    }
    shapes.push(json!({"type": "line", "x0": 0, "x1": 0, "y0": 0, "y1": 1, "yref": "paper",
                       "line": {"color": "#7b8794", "width": 1}, "layer": "below"}));
    (shapes, labels)
}

fn caption(unstable: usize, far_zeros: usize, outside: usize) -> String {
    let mut caption = String::from(
        "Continuous poles, and zeros as circles. Rays join poles of equal damping ratio ζ, circles those of equal \
         natural frequency.",
    );
    match unstable {
        0 => caption.push_str(" All poles are stable."),
        1 => caption.push_str(" One pole is unstable (right half plane): it describes the window, not the structure."),
        n => caption.push_str(&format!(
            " {n} poles are unstable (right half plane): they describe the window, not the structure."
        )),
    }
    if far_zeros > 0 {
        // Of the wider side of the view some may still be in sight.
        let lie = if far_zeros == 1 { "zero lies" } else { "zeros lie" };
        caption.push_str(&format!(" {far_zeros} {lie} farther out than these poles."));
    }
    if outside > 0 {
        caption.push_str(&format!(" {outside} far poles lie outside the first view; double-click to see all."));
    }
    caption
}

/// Radius of the first view and the number of poles left outside it, from moduli in rising order.
fn first_view(moduli: &[f64]) -> (f64, usize) {
    // The view must hold half of the poles: a single slow one does not push all others out.
    let half = moduli.len() / 2;
    let gap = |k: &usize| moduli[*k] > 0.0 && moduli[k + 1] > FAR * moduli[*k];
    let far = (half.saturating_sub(1)..moduli.len() - 1).find(gap);
    let inside = far.map_or(moduli.len(), |index| index + 1);
    let radius = 1.12 * moduli[inside - 1];
    (if radius > 0.0 { radius } else { 1.0 }, moduli.len() - inside)
}

/// The largest of 1, 2, 5 times a power of ten that is not above `x`.
fn nice_step(x: f64) -> f64 {
    let power = 10_f64.powf(x.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|m| m * power).find(|step| *step <= x).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_far_pole_does_not_crowd_the_others() {
        let (radius, outside) = first_view(&[10.0, 30.0, 32.0, 5000.0]);
        assert_eq!((radius, outside), (1.12 * 32.0, 1));
        assert_eq!(first_view(&[0.0]), (1.0, 0));
        assert_eq!(first_view(&[0.02, 3.0, 3.5, 9.0]), (1.12 * 9.0, 0));
    }

    #[test]
    fn rings_are_at_round_frequencies() {
        assert_eq!(nice_step(7.0), 5.0);
        assert_eq!(nice_step(0.3), 0.2);
    }
}
