//! Springs and dampers of the best model at work: the force of each against how far it is compressed.

use serde_json::json;

use crate::drawing::figure::{COMPUTED_POINTS, Figure, axis, base_layout, colour, over, set, with};
use crate::text::escape::html;
use crate::text::numbers::{KILO, MILLI, candidate_name};
use crate::{CandidateResult, Ranking, Run};

/// Of the best candidate, or of the first in rank without one; `None` where no forces are at hand.
pub fn figure(run: &Run, ranking: &Ranking) -> Option<Figure> {
    let with_forces = |candidate: &&CandidateResult| !candidate.elements.is_empty();
    let best = ranking.best.as_deref().and_then(|id| run.candidate(id)).filter(with_forces);
    let first = || {
        let place = |candidate: &&CandidateResult| ranking.place(&candidate.id).unwrap_or(usize::MAX);
        run.candidates.iter().filter(with_forces).min_by_key(place)
    };
    let candidate = best.or_else(first)?;
    let to_s = candidate.simulation.as_ref().map_or(f64::INFINITY, |s| s.to_s);
    let mut traces = Vec::new();
    for element in &candidate.elements {
        let from = element.force.index_at_or_after(0.0);
        let last = element.force.index_at_or_after(to_s).saturating_add(1).min(element.force.len());
        let x: Vec<f64> = element.deflection[from.min(last)..last].iter().map(|x| MILLI * x).collect();
        let y: Vec<f64> = element.force.samples()[from.min(last)..last].iter().map(|f| KILO * f).collect();
        let damper = element.name.starts_with('c');
        // One colour for what stands side by side in the model.
        let pair = element.name.trim_start_matches(['k', 'c']).parse::<usize>().unwrap_or(1) - 1;
        traces.push(with(
            over(&x, &y, COMPUTED_POINTS),
            json!({"name": format!("{} {}", if damper { "damper" } else { "spring" }, html(&element.name)),
                   "line": {"color": colour::SERIES[pair % colour::SERIES.len()], "width": 2,
                            "dash": if damper { "dash" } else { "solid" }},
                   "hovertemplate": "%{y:.1f} kN at %{x:.1f} mm"}),
        ));
    }
    let one_mass = candidate.masses.is_empty();
    let title = if one_mass { "compression of the front, mm" } else { "compression between the masses, mm" };
    let mut layout = base_layout();
    set(
        &mut layout,
        json!({
            "hovermode": "closest",
            "xaxis": axis(title, json!({})),
            "yaxis": axis("force, kN", json!({})),
        }),
    );
    Some(Figure {
        id: "elements",
        title: "Springs and dampers at work",
        caption: format!(
            "Force in each spring and damper of {}, against {}, over the compared \
             window. The area below a curve is the work the element takes up.",
            html(&candidate_name(&candidate.id)),
            if one_mass { "the compression of the front" } else { "how far the masses at its ends have come together" }
        ),
        height_px: 420,
        half_width: false,
        traces,
        layout,
    })
}
