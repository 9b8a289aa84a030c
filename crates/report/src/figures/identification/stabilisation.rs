//! Stabilisation diagram: poles over the order of the model.

use std::f64::consts::TAU;

use serde_json::json;

use crate::Run;
use crate::drawing::figure::{Figure, axis, base_layout, colour, room_above, set, short};
use crate::text::numbers::{decimals, significant};

const HEIGHT_PX: u32 = 460;

/// Marks in the order of the legend: word of the record, name, symbol, size, colour.
const MARKS: [(&str, &str, &str, u32, &str); 5] = [
    ("all", "frequency, damping, shape stable", "circle", 10, "#009e73"),
    ("frequency-and-damping", "frequency and damping stable", "diamond", 9, "#0072b2"),
    ("frequency", "frequency stable", "triangle-up", 8, "#b87a00"),
    ("new", "new", "x-thin-open", 7, "#55616d"),
    ("rejected", "rejected", "circle-open", 5, "#8794a1"),
];

/// The first diagram of the run; `None` without one.
pub fn figure(run: &Run) -> Option<Figure> {
    let diagram = run.stabilizations.first().filter(|d| !d.poles.is_empty())?;
    let hz = |re: f64, im: f64| re.hypot(im) / TAU;
    let mut traces = Vec::new();
    for (word, name, symbol, size, colour) in MARKS {
        let poles: Vec<_> = diagram.poles.iter().filter(|pole| pole.stability == word).collect();
        if poles.is_empty() {
            continue;
        }
        let hover: Vec<String> = poles
            .iter()
            .map(|p| {
                let modulus = p.re_per_s.hypot(p.im_rad_per_s);
                format!(
                    "{} Hz, ζ {}, order {}",
                    significant(modulus / TAU, 4),
                    significant(-p.re_per_s / modulus, 3),
                    p.order
                )
            })
            .collect();
        traces.push(json!({
            "type": "scatter", "mode": "markers", "name": name,
            "x": poles.iter().map(|p| short(hz(p.re_per_s, p.im_rad_per_s))).collect::<Vec<_>>(),
            "y": poles.iter().map(|p| p.order).collect::<Vec<_>>(),
            "text": hover, "hovertemplate": "%{text}<extra></extra>",
            "marker": {"symbol": symbol, "size": size, "color": colour, "line": {"width": 1.5}},
        }));
    }
    let (mut shapes, mut labels) = (Vec::new(), Vec::new());
    for (place, cluster) in diagram.clusters.iter().enumerate() {
        let f = cluster.natural_frequency_rad_per_s / TAU;
        shapes.push(json!({"type": "line", "x0": short(f), "x1": short(f), "y0": 0, "y1": 1, "yref": "paper",
                           "line": {"color": colour::GUIDE, "width": 1.2, "dash": "dot"}, "layer": "below"}));
        labels.push(json!({"x": short(f.log10()), "y": 1, "yref": "paper", "xanchor": "center", "yanchor": "bottom",
            "yshift": 1 + 16 * (place % 3), "showarrow": false,
            "text": format!("{} Hz, ζ {}", significant(f, 4), significant(cluster.damping_ratio, 3)),
            "font": {"size": 12, "color": colour::MUTED}}));
    }
    let percent = |x: f64| format!("{} %", decimals(100.0 * x, 0));
    let mut caption = format!(
        "{} of {}: poles of models of rising order, from one factorisation. Compared with the order before, stable is \
         a frequency within {}, a damping ratio within {}{}. Rejected: growing, damping ratio above {}, above {} of \
         the Nyquist frequency, or no stronger than noise. Marked: modes present in {} of the orders or more ({}).",
        diagram.method,
        diagram.channel,
        percent(diagram.frequency_change),
        percent(diagram.damping_change),
        diagram
            .shape_change
            .map_or_else(String::new, |x| format!(", a shape with MAC of {} or more", decimals(1.0 - x, 2))),
        significant(diagram.highest_damping, 2),
        percent(diagram.nyquist_share),
        percent(diagram.presence),
        diagram.clusters.len()
    );
    if run.stabilizations.len() > 1 {
        caption.push_str(&format!(" {} more are in the artifact.", run.stabilizations.len() - 1));
    }
    let mut layout = base_layout();
    let rows = u32::try_from(labels.len()).unwrap_or(3).clamp(1, 3);
    set(
        &mut layout,
        json!({
            "hovermode": "closest",
            "xaxis": axis("natural frequency, Hz", json!({
                "type": "log", "dtick": 1, "minor": {"showgrid": true, "gridcolor": "#f1f3f5"},
            })),
            "yaxis": axis("order", json!({"rangemode": "tozero", "dtick": 2, "zeroline": false})),
            "shapes": shapes, "annotations": labels,
        }),
    );
    room_above(&mut layout, HEIGHT_PX, rows, 1);
    Some(Figure {
        id: "stabilisation",
        title: "Stabilisation diagram",
        caption,
        height_px: HEIGHT_PX,
        half_width: false,
        traces,
        layout,
    })
}
