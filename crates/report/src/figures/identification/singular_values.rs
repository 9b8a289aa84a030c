//! Singular values of the Hankel matrix: the evidence for the order of a model.

use serde_json::json;

use crate::Run;
use crate::drawing::figure::{Figure, axis, base_layout, colour, set, short};
use crate::text::escape::html;
use crate::text::numbers::significant;

/// Values drawn: more say nothing about an order that a crash record supports.
const DRAWN: usize = 40;

/// Relative singular values of every model; `None` where none has any.
pub fn figure(run: &Run) -> Option<Figure> {
    let mut traces = Vec::new();
    let mut shapes = Vec::new();
    let mut labels = Vec::new();
    let mut decades = 0.0_f64;
    let mut caption = String::from("Singular values of the Hankel matrix relative to the largest.");
    // Models of several orders from one record share their singular values: drawn once.
    let mut drawn: Vec<(&[f64], usize)> = Vec::new();
    for model in &run.models {
        let Some(identification) = &model.identification else { continue };
        let values = &identification.singular_values;
        let Some(&largest) = values.first().filter(|largest| **largest > 0.0) else { continue };
        let order = identification.order as usize;
        let place = match drawn.iter().find(|(other, _)| *other == values.as_slice()) {
            Some((_, place)) => *place,
            None => {
                let place = drawn.len();
                drawn.push((values, place));
                let shown: Vec<f64> = values.iter().take(DRAWN).map(|s| s / largest).collect();
                let smallest = shown.iter().copied().filter(|s| *s > 0.0).fold(1.0, f64::min);
                decades = decades.max(-smallest.log10());
                traces.push(json!({
                    "type": "scatter", "mode": "lines+markers",
                    "x": (1..=shown.len()).collect::<Vec<_>>(),
                    // A value of zero has no place on a logarithmic axis.
                    "y": shown.iter().map(|&s| if s > 0.0 { json!(short(s)) } else { json!(null) }).collect::<Vec<_>>(),
                    "name": html(&model.id),
                    "line": {"color": colour::SERIES[place % colour::SERIES.len()], "width": 1.2},
                    "marker": {"size": 7}, "hovertemplate": "σ<sub>%{x}</sub>/σ<sub>1</sub> = %{y:.3e}",
                }));
                place
            }
        };
        let colour = colour::SERIES[place % colour::SERIES.len()];
        let x = order as f64 + 0.5;
        shapes.push(json!({"type": "line", "x0": x, "x1": x, "y0": 0, "y1": 1, "yref": "paper",
                           "line": {"color": colour::EVENT, "width": 1.4, "dash": "dash"}}));
        labels.push(json!({"x": x, "y": 1, "yref": "paper", "xanchor": "left", "yanchor": "top", "xshift": 4,
                           "yshift": -18.0 * labels.len() as f64, "showarrow": false, "text": format!("order {order}"),
                           "font": {"color": colour::EVENT, "size": 12}, "bgcolor": "rgba(255,255,255,0.85)"}));
        if order > 0 && order <= values.len() {
            traces.push(json!({
                "type": "scatter", "mode": "markers", "x": (1..=order).collect::<Vec<_>>(),
                "y": values[..order].iter().map(|s| short(s / largest)).collect::<Vec<_>>(),
                "marker": {"size": 10, "color": colour}, "showlegend": false, "hoverinfo": "skip",
            }));
        }
        if let (Some(kept), Some(dropped)) = (order.checked_sub(1).and_then(|k| values.get(k)), values.get(order))
            && *dropped > 0.0
        {
            caption.push_str(&format!(" {}: σ{order}/σ{} = {}.", model.id, order + 1, significant(kept / dropped, 3)));
        }
    }
    if traces.is_empty() {
        return None;
    }
    caption.push_str(
        " A wide gap supports the order before it; on a gentle slope the record does not determine \
         the order.",
    );
    // Whole decades where there are several. Within one or two of them 1, 2, 5 with their full number: plotly's own
    // minor digits ("2", "5") read as values.
    let mut values_axis = json!({"type": "log", "exponentformat": "power", "dtick": 1,
        "minor": {"dtick": "D1", "ticks": "outside", "ticklen": 2, "tickcolor": "#9aa5b1"}});
    if decades <= 2.5 {
        let marks = [1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001];
        set(
            &mut values_axis,
            json!({"tickmode": "array", "tickvals": marks, "ticktext": marks.map(|x| x.to_string())}),
        );
    }
    let mut layout = base_layout();
    set(
        &mut layout,
        json!({
            "showlegend": drawn.len() > 1,
            "hovermode": "closest",
            "xaxis": axis("index", json!({"rangemode": "tozero", "zeroline": false})),
            "yaxis": axis("relative singular value", values_axis),
            "shapes": shapes, "annotations": labels,
        }),
    );
    Some(Figure {
        id: "singular-values",
        title: "Evidence for the order",
        caption,
        height_px: 480,
        half_width: true,
        traces,
        layout,
    })
}
