//! Springs and dampers of the best model at work: the force of each against how far it is compressed.

use crate::drawing::numbers::{KILO, MILLI};
use crate::drawing::{Axis, Colour, Dash, Figure, Look, Panel, over};
use crate::figures::time_view::FORCE;
use crate::findings::{CandidateResult, Ranking, Run};

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
    let one_mass = candidate.masses.is_empty();
    let compressed = if one_mass { "compression of the front" } else { "compression between the masses" };
    let mut figure = Figure::new("elements", "Springs and dampers at work");
    let mut panel = Panel::new(Axis::of((compressed, "mm")), Axis::of(FORCE));
    for element in &candidate.elements {
        let from = element.force.index_at_or_after(0.0);
        let last = element.force.index_at_or_after(to_s).saturating_add(1).min(element.force.len());
        let x: Vec<f64> = element.deflection[from.min(last)..last].iter().map(|x| MILLI * x).collect();
        let y: Vec<f64> = element.force.samples()[from.min(last)..last].iter().map(|f| KILO * f).collect();
        let damper = element.name.starts_with('c');
        // One colour for what stands side by side in the model.
        let pair = element.name.trim_start_matches(['k', 'c']).parse::<usize>().unwrap_or(1).saturating_sub(1);
        let look = Look::line(Colour::Series(pair), if damper { Dash::Dashed } else { Dash::Solid });
        let kind = if damper { "damper" } else { "spring" };
        let entry = figure.entry(format!("{kind} {}", element.name), look, true);
        panel.line(entry, over(&x, &y));
    }
    let against =
        if one_mass { "the compression of the front" } else { "how far the masses at its ends have come together" };
    figure.caption = format!(
        "Force in each spring and damper of {}, against {against}, over the compared window. The area below a curve \
         is the work the element takes up.",
        run.name_of(&candidate.id)
    );
    figure.panels.push(panel);
    Some(figure.tidy())
}
