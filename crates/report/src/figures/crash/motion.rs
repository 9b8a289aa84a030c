//! Acceleration, velocity and displacement of the pulse channel on one time axis.

use serde_json::{Value, json};

use crate::Run;
use crate::drawing::figure::{
    Figure, MEASURED_POINTS, axis, base_layout, colour, event_line, over_time, room_above, set, short, span, with,
};
use crate::drawing::time_view::time_view_ms;
use crate::text::numbers::{G_PER_M_PER_S2, KM_PER_H_PER_M_PER_S, MILLI, decimals};

const HEIGHT_PX: u32 = 740;

/// The three curves, or as many as there are; `None` without any.
pub fn figure(run: &Run) -> Option<Figure> {
    let measured = &run.measured;
    if run.acceleration().is_none() && measured.displacement.is_none() {
        return None;
    }
    let mut traces = Vec::new();
    if let Some(raw) = &measured.raw {
        // The raw record is thin where there is a filtered one, and the main curve where there is none.
        let line = if measured.filtered.is_some() {
            json!({"color": colour::RAW, "width": 0.8})
        } else {
            json!({"color": colour::MAIN, "width": 1.6})
        };
        traces.push(with(
            over_time(raw, G_PER_M_PER_S2, MEASURED_POINTS),
            json!({"name": "acceleration, as read", "line": line, "hovertemplate": "%{y:.2f} g",
                   "opacity": if measured.filtered.is_some() { 0.75 } else { 1.0 }}),
        ));
    }
    if let Some(filtered) = &measured.filtered {
        traces.push(with(
            over_time(filtered, G_PER_M_PER_S2, MEASURED_POINTS),
            json!({"name": format!("acceleration, {}", filter_name(run)), "line": {"color": colour::MAIN, "width": 2.2},
                   "hovertemplate": "%{y:.2f} g"}),
        ));
    }
    if let Some(velocity) = &measured.velocity {
        traces.push(with(
            over_time(velocity, KM_PER_H_PER_M_PER_S, MEASURED_POINTS),
            json!({"name": "velocity", "yaxis": "y2", "line": {"color": colour::SERIES[2], "width": 2.2},
                   "showlegend": false, "hovertemplate": "%{y:.2f} km/h"}),
        ));
    }
    if let Some(displacement) = &measured.displacement {
        traces.push(with(
            over_time(displacement, MILLI, MEASURED_POINTS),
            json!({"name": "displacement (crush)", "yaxis": "y3", "line": {"color": colour::SECOND, "width": 2.2},
                   "showlegend": false, "hovertemplate": "%{y:.1f} mm"}),
        ));
    }

    let (mut shapes, mut labels) = (Vec::new(), Vec::new());
    let mut mark = |t_s: f64, name: &str, colour: &str, dash: &str| {
        let (line, mut label) = event_line(MILLI * t_s, name, colour, dash);
        // Neighbours take turns in height: in a narrow window they would lie over each other.
        set(&mut label, json!({"yshift": 1 + 16 * (labels.len() % 2)}));
        shapes.push(line);
        labels.push(label);
    };
    mark(0.0, "time zero", colour::MUTED, "solid");
    if let Some(t_m) = run.time_of_crush_s() {
        mark(t_m, &format!("t<sub>m</sub> = {} ms", decimals(MILLI * t_m, 1)), colour::EVENT, "dash");
    }
    let events = run.events.as_ref();
    if let Some(t_s) = events.and_then(|e| e.time_of_rebound_s) {
        mark(t_s, &format!("rebound, {} ms", decimals(MILLI * t_s, 1)), colour::MUTED, "dot");
    }
    if let (Some(t_m), Some(crush)) = (run.time_of_crush_s(), events.and_then(|e| e.dynamic_crush_m)) {
        traces.push(marker(t_m, 0.0, "y2", "v = 0"));
        traces.push(marker(t_m, MILLI * crush, "y3", "dynamic crush"));
        labels.push(json!({
            "x": short(MILLI * t_m), "xref": "x", "y": short(MILLI * crush), "yref": "y3", "xanchor": "left",
            "yanchor": "top", "xshift": 8, "yshift": -6, "showarrow": false,
            "text": format!("<b>C = {} mm</b>", decimals(MILLI * crush, 1)), "font": {"color": colour::EVENT},
            "bgcolor": "rgba(255,255,255,0.8)",
        }));
    }

    let (acceleration_view, cut) = acceleration_view(run);
    let mut layout = base_layout();
    set(
        &mut layout,
        json!({
            "hovermode": "x unified", "hoversubplots": "axis",
            "xaxis": axis("time after time zero, ms", json!({"anchor": "y3", "range": time_view_ms(run)
                .map(|[from, to]| json!([short(from), short(to)])), "hoverformat": ".2f"})),
            "yaxis": axis("acceleration, g", json!({"domain": [0.69, 1.0], "range": acceleration_view})),
            "yaxis2": axis("velocity, km/h", json!({"domain": [0.345, 0.655]})),
            "yaxis3": axis("displacement, mm", json!({"domain": [0.0, 0.31], "range": displacement_view(run)})),
            "shapes": shapes, "annotations": labels,
        }),
    );
    room_above(&mut layout, HEIGHT_PX, 2, 1);
    Some(Figure {
        id: "motion",
        title: "The crash: acceleration, velocity, displacement",
        caption: caption(run, cut),
        height_px: HEIGHT_PX,
        half_width: false,
        traces,
        layout,
    })
}

/// First view of the acceleration, g: the filtered curve with room for its ripple, and whether that cuts peaks of the
/// unfiltered one, which can be five times as high. `null`: all there is.
fn acceleration_view(run: &Run) -> (Value, bool) {
    let (Some(raw), Some(filtered)) = (&run.measured.raw, &run.measured.filtered) else { return (Value::Null, false) };
    let (Some((raw_low, raw_high)), Some((low, high))) = (span(raw.samples()), span(filtered.samples())) else {
        return (Value::Null, false);
    };
    let room = 0.5 * (high - low);
    let (view_low, view_high) = (low - room, high + room);
    if view_low <= raw_low && raw_high <= view_high {
        return (Value::Null, false);
    }
    let margin = 0.05 * (high - low);
    let view = [view_low.max(raw_low - margin), view_high.min(raw_high + margin)];
    (json!(view.map(|a| short(G_PER_M_PER_S2 * a))), true)
}

/// First view of the displacement, mm: from contact on. Before it the vehicle just comes nearer.
fn displacement_view(run: &Run) -> Value {
    let (Some(x), Some([_, to_ms])) = (&run.measured.displacement, time_view_ms(run)) else { return Value::Null };
    let from = x.index_at_or_after(0.0);
    let to = x.index_at_or_after(to_ms / MILLI).saturating_add(1).min(x.len()).max(from);
    let Some((low, high)) = span(&x.samples()[from..to]) else { return Value::Null };
    let (low, margin) = (low.min(0.0), 0.12 * (high - low.min(0.0)));
    if margin > 0.0 { json!([short(MILLI * (low - margin)), short(MILLI * (high + margin))]) } else { Value::Null }
}

fn marker(t_s: f64, y: f64, axis: &str, name: &str) -> Value {
    json!({
        "type": "scatter", "mode": "markers", "x": [short(MILLI * t_s)], "y": [short(y)], "yaxis": axis, "name": name,
        "marker": {"color": colour::EVENT, "size": 9, "line": {"color": "#ffffff", "width": 1.5}},
        "showlegend": false, "hoverinfo": "skip",
    })
}

/// `CFC 60`, or what else is known of the filter.
fn filter_name(run: &Run) -> String {
    let cfc = run.filter.as_ref().and_then(|f| f.cfc).or_else(|| run.channel().and_then(|c| c.cfc));
    match cfc {
        Some(cfc) => format!("CFC {cfc}"),
        None => "filtered".to_owned(),
    }
}

fn caption(run: &Run, cut: bool) -> String {
    let mut text = format!("Channel {}", run.channel_id().unwrap_or("unknown"));
    if let Some(channel) = run.channel().filter(|channel| !channel.location.is_empty()) {
        text.push_str(&format!(" ({})", channel.location));
    }
    text.push_str(", SAE J211 sign: deceleration is negative.");
    if let Some(filter) = run.filter.as_ref().filter(|filter| filter.cfc.is_some()) {
        text.push_str(&format!(" Filtered to {}, mode {}.", filter_name(run), filter.mode));
    }
    if cut {
        text.push_str(" Peaks of the unfiltered record reach beyond the first view: double-click to see them.");
    }
    if let Some(events) = &run.events {
        match (events.rule.as_deref(), events.start.as_deref()) {
            (Some(rule), Some(start)) => text.push_str(&format!(
                " Velocity and displacement by the {} rule from {}.",
                rule.replace('-', " "),
                start.replace('-', " ")
            )),
            (Some(rule), None) => text.push_str(&format!(" Integrated by the {} rule.", rule.replace('-', " "))),
            _ => {}
        }
        if events.time_of_dynamic_crush_s.is_none() {
            text.push_str(" The velocity does not reach zero within the record: there is no dynamic crush to mark.");
        }
    }
    text
}
