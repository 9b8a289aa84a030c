//! Force against crush: loading and unloading, the equal-energy line, the best model.

use crumple_signal::Sampled;
use serde_json::{Value, json};

use crate::drawing::figure::{
    COMPUTED_POINTS, Figure, MEASURED_POINTS, axis, base_layout, colour, over, set, short, with,
};
use crate::text::escape::html;
use crate::text::numbers::{G_PER_M_PER_S2, KILO, MILLI, NBSP, candidate_name, decimals, significant};
use crate::{Ranking, Run};

/// Force over displacement; without a mass the deceleration takes the force's place. `None` without a displacement.
pub fn figure(run: &Run, ranking: &Ranking) -> Option<Figure> {
    let displacement = run.measured.displacement.as_ref()?;
    let drawn = match &run.measured.force {
        Some(force) => Ordinate { signal: force.clone(), factor: KILO, unit: "kN", title: "force, kN" },
        None => Ordinate {
            signal: negated(run.acceleration()?)?,
            factor: G_PER_M_PER_S2,
            unit: "g",
            title: "deceleration, g (mass not known)",
        },
    };

    // After separation the force is noise about zero: the unloading branch ends at the rebound, if the record shows it.
    let t_end = run.events.as_ref().and_then(|e| e.time_of_rebound_s).unwrap_or(f64::INFINITY);
    let (loading, unloading) = branches(displacement, &drawn, run.time_of_crush_s(), t_end);
    let hover = format!("%{{y:.1f}} {} at %{{x:.1f}} mm", drawn.unit);
    let mut traces = vec![with(
        over(&loading.scaled_x(), &loading.scaled_y(drawn.factor), MEASURED_POINTS),
        json!({"name": "loading", "line": {"color": colour::MAIN, "width": 2.2}, "fill": "tozeroy",
               "fillcolor": "rgba(0,114,178,0.08)", "hovertemplate": hover}),
    )];
    if !unloading.x.is_empty() {
        traces.push(with(
            over(&unloading.scaled_x(), &unloading.scaled_y(drawn.factor), MEASURED_POINTS),
            json!({"name": "unloading", "line": {"color": colour::SECOND, "width": 2.2, "dash": "dash"},
                   "hovertemplate": hover}),
        ));
    }

    let work = loading.work();
    let crush = run.events.as_ref().and_then(|e| e.dynamic_crush_m).filter(|crush| *crush > 0.0);
    if let Some(crush) = crush {
        // The linear spring that takes up the same work at the same crush: k C²/2 = work.
        let end = drawn.factor * 2.0 * work / crush;
        traces.push(json!({
            "type": "scatter", "mode": "lines", "x": [0, short(MILLI * crush)], "y": [0, short(end)],
            "name": "equal-energy line", "line": {"color": colour::MUTED, "width": 1.6, "dash": "dot"},
            "hoverinfo": "skip",
        }));
    }
    traces.extend(model_trace(run, ranking, &hover));
    // The load cells saw all masses, each with its own deceleration.
    if let Some(cells) = run.measured.barrier_force.as_ref().filter(|_| drawn.unit == "kN") {
        traces.push(load_cell_trace(cells, displacement, t_end, &hover));
    }
    let mut labels = Vec::new();
    if let Some(crush) = crush {
        labels.push(json!({
            "x": short(MILLI * crush), "y": 0, "xref": "x", "yref": "y", "ax": -70, "ay": -30,
            "arrowcolor": colour::EVENT,
            "arrowwidth": 1.2, "arrowhead": 2, "text": format!("<b>C = {} mm</b>", decimals(MILLI * crush, 1)),
            "font": {"color": colour::EVENT}, "bgcolor": "rgba(255,255,255,0.85)",
        }));
    }
    let caption = caption(run, crush, &loading, &unloading);
    let reach = |extreme: fn(f64, f64) -> f64| loading.x.iter().chain(&unloading.x).copied().fold(0.0, extreme);
    let (low, high) = (reach(f64::min), reach(f64::max));
    let view = [MILLI * (low - 0.02 * (high - low)), MILLI * (high + 0.05 * (high - low))];
    let mut layout = base_layout();
    set(
        &mut layout,
        json!({
            "hovermode": "closest",
            "xaxis": axis("displacement, mm", json!({"range": [short(view[0]), short(view[1])]})),
            "yaxis": axis(drawn.title, json!({})),
            "annotations": labels,
        }),
    );
    Some(Figure {
        id: "force",
        title: if run.measured.force.is_some() { "Force against crush" } else { "Deceleration against crush" },
        caption,
        height_px: 460,
        half_width: false,
        traces,
        layout,
    })
}

/// The loading branch, up to the time of crush, and the unloading branch after it, up to `t_end`.
fn branches(displacement: &Sampled, ordinate: &Ordinate, t_m: Option<f64>, t_end: f64) -> (Branch, Branch) {
    let (mut loading, mut unloading) = (Branch::default(), Branch::default());
    for k in displacement.index_at_or_after(0.0)..displacement.len() {
        let t = displacement.time_s(k);
        let Some(force) = ordinate.signal.at(t) else { continue };
        let x = displacement.samples()[k];
        if t_m.is_none_or(|t_m| t <= t_m) {
            loading.push(x, force);
        } else if t <= t_end {
            if unloading.x.is_empty() {
                unloading.join(&loading);
            }
            unloading.push(x, force);
        }
    }
    (loading, unloading)
}

/// Force of the best model over the displacement of its compartment.
fn model_trace(run: &Run, ranking: &Ranking, hover: &str) -> Option<Value> {
    let best = ranking.best.as_deref().and_then(|id| run.candidate(id))?;
    let (x, a) = (best.displacement.as_ref()?, best.acceleration.as_ref()?);
    let mass_kg = run.test.mass_kg;
    let scale = if run.measured.force.is_some() { KILO * mass_kg.unwrap_or(f64::NAN) } else { G_PER_M_PER_S2 };
    let to_s = best.simulation.as_ref().map_or(f64::INFINITY, |s| s.to_s);
    let last = x.index_at_or_after(to_s).saturating_add(1).min(x.len()).min(a.len());
    let xs: Vec<f64> = x.samples()[..last].iter().map(|x| MILLI * x).collect();
    let ys: Vec<f64> = a.samples()[..last].iter().map(|a| -scale * a).collect();
    scale.is_finite().then(|| {
        with(
            over(&xs, &ys, COMPUTED_POINTS),
            json!({"name": format!("model: {}", html(&candidate_name(&best.id))),
                   "line": {"color": colour::SERIES[2], "width": 1.8, "dash": "dashdot"}, "hovertemplate": hover}),
        )
    })
}

/// The barrier force as its load cells measured it, up to `t_end`.
fn load_cell_trace(cells: &Sampled, displacement: &Sampled, t_end: f64, hover: &str) -> Value {
    let last = t_end.min(displacement.end_s());
    let (x, y): (Vec<f64>, Vec<f64>) = (displacement.index_at_or_after(0.0)..displacement.len())
        .map(|k| (displacement.time_s(k), displacement.samples()[k]))
        .take_while(|(t, _)| *t <= last)
        .filter_map(|(t, x)| Some((MILLI * x, KILO * cells.at(t)?)))
        .unzip();
    with(
        over(&x, &y, MEASURED_POINTS),
        json!({"name": "barrier load \
            cells", "line": {"color": colour::MEASURED, "width": 1.6}, "hovertemplate": hover}),
    )
}

fn caption(run: &Run, crush: Option<f64>, loading: &Branch, unloading: &Branch) -> String {
    let mut caption = String::new();
    if let Some(crush) = crush
        && run.test.mass_kg.is_some()
        && run.measured.force.is_some()
    {
        caption.push_str(&format!(
            "Loading takes up {}{NBSP}kJ; a linear spring with the same work at the same crush has {}{NBSP}kN/m. ",
            significant(KILO * loading.work(), 4),
            significant(KILO * 2.0 * loading.work() / (crush * crush), 4)
        ));
        if !unloading.x.is_empty() {
            caption.push_str(&format!("Unloading gives {}{NBSP}kJ back. ", significant(KILO * -unloading.work(), 4)));
        }
    }
    caption.push_str(if run.measured.force.is_some() {
        "Force is the test mass times the deceleration of this sensor: the barrier force of a vehicle that moves as \
         one body."
    } else {
        "Deceleration takes the place of force, since no force record or mass is at hand."
    });
    if run.measured.barrier_force.is_some() && run.measured.force.is_some() {
        caption.push_str(
            " The load cells measured it at the barrier: where the two part, the engine and other masses move \
             otherwise than this sensor.",
        );
    }
    caption
}

struct Ordinate {
    signal: Sampled,
    factor: f64,
    unit: &'static str,
    title: &'static str,
}

fn negated(signal: &Sampled) -> Option<Sampled> {
    Sampled::new(signal.t0_s(), signal.dt_s(), signal.samples().iter().map(|y| -y).collect()).ok()
}

/// A stretch of the force-deflection curve, SI.
#[derive(Default)]
struct Branch {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Branch {
    fn push(&mut self, x: f64, y: f64) {
        self.x.push(x);
        self.y.push(y);
    }

    /// Starts where another ends, so that the drawing has no gap.
    fn join(&mut self, other: &Self) {
        if let (Some(&x), Some(&y)) = (other.x.last(), other.y.last()) {
            self.push(x, y);
        }
    }

    fn scaled_x(&self) -> Vec<f64> {
        self.x.iter().map(|x| MILLI * x).collect()
    }

    fn scaled_y(&self, factor: f64) -> Vec<f64> {
        self.y.iter().map(|y| factor * y).collect()
    }

    /// Work along the branch by the trapezoidal rule in x, J; it closes with the kinetic energy to O(dt²).
    fn work(&self) -> f64 {
        self.x.windows(2).zip(self.y.windows(2)).map(|(x, y)| (x[1] - x[0]) * (y[0] + y[1]) / 2.0).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_of_a_linear_spring_is_half_force_times_crush() {
        let branch = Branch { x: vec![0.0, 0.1, 0.5], y: vec![0.0, 2e4, 1e5] };
        // The trapezoidal rule is exact on a straight line; 1e-9 J is rounding.
        assert!((branch.work() - 0.5 * 1e5 * 0.5).abs() < 1e-9, "{}", branch.work());
    }
}
