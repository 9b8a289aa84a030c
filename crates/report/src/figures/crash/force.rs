//! Force against crush: loading and unloading, the equal-energy line, the models, the barrier's load cells.

use crate::drawing::numbers::{G_PER_M_PER_S2, KILO, MILLI};
use crate::drawing::{Axis, Colour, Dash, Figure, Look, Panel, over, span};
use crate::figures::time_view::{DISPLACEMENT, FORCE};
use crate::findings::{CandidateResult, Run};
use crate::words;
use crumple_signal::Sampled;

use super::drawn_models::DrawnModels;

/// The panel with what is to be said of it; without a mass the deceleration takes the force's place. `None` without a
/// displacement.
pub fn panel(
    run: &Run,
    models: &DrawnModels,
    entries: &[usize],
    test: usize,
    figure: &mut Figure,
) -> Option<(Panel, String)> {
    let displacement = run.measured.displacement.as_ref()?;
    let drawn = match &run.measured.force {
        Some(force) => Ordinate { signal: force.clone(), factor: KILO, title: FORCE },
        None => Ordinate {
            signal: negated(run.acceleration()?)?,
            factor: G_PER_M_PER_S2,
            title: ("deceleration (mass not known)", "g"),
        },
    };
    // After separation the force is noise about zero: the unloading branch ends at the rebound, if the record shows it.
    let t_end = run.events.as_ref().and_then(|e| e.time_of_rebound_s).unwrap_or(f64::INFINITY);
    let (loading, unloading) = branches(displacement, &drawn, run.time_of_crush_s(), t_end);
    let mut panel = Panel::new(Axis::of(DISPLACEMENT), Axis::of(drawn.title));
    // What an acceleration of 1 g is on this axis: a body's own mass times it, or itself.
    let per_g = match (&run.measured.force, run.test.mass_kg) {
        (Some(_), mass_kg) => mass_kg.map(|mass_kg| -KILO * mass_kg / G_PER_M_PER_S2),
        (None, _) => Some(-1.0),
    };
    panel.follows = per_g;
    let whole = Branch { x: [&loading.x[..], &unloading.x].concat(), y: [&loading.y[..], &unloading.y].concat() };
    let (low, high) = span(&whole.x)?;
    let reach = MILLI * (high - low.min(0.0));
    panel.x.view = (reach > 0.0).then_some([MILLI * low.min(0.0) - 0.02 * reach, MILLI * high + 0.05 * reach]);

    let crush = run.events.as_ref().and_then(|e| e.dynamic_crush_m).filter(|crush| *crush > 0.0);
    if let Some(crush) = crush {
        // The linear spring that takes up the same work at the same crush: k C²/2 = work.
        let end = drawn.factor * 2.0 * loading.work() / crush;
        let line = figure.entry("equal-energy line (force over crush)", Look::line(Colour::Muted, Dash::Dotted), true);
        panel.line(line, vec![[0.0, 0.0], [MILLI * crush, end]]);
        panel.mark(
            MILLI * crush,
            format!("C = {}", words::quantity(MILLI * crush, 1, "mm")),
            Colour::Event,
            Dash::Dashed,
        );
    }
    panel.line(test, over(&whole.scaled_x(), &whole.scaled_y(drawn.factor)));
    // The load cells saw all masses, each with its own deceleration.
    if let Some(cells) = run.measured.barrier_force.as_ref().filter(|_| run.measured.force.is_some()) {
        let entry =
            figure.entry("barrier load cells (force over crush)", Look::line(Colour::Series(2), Dash::DashDot), true);
        panel.line(entry, load_cells(cells, displacement, t_end));
    }
    for ((candidate, _), entry) in models.models.iter().zip(entries) {
        panel.line(*entry, per_g.and_then(|per_g| model_line(candidate, per_g)).unwrap_or_default());
    }
    let mut heights = whole.scaled_y(drawn.factor);
    heights.extend(
        panel
            .curves
            .iter()
            .filter(|c| figure.legend[c.entry].shown && !entries.contains(&c.entry))
            .flat_map(|c| &c.points)
            .map(|p| p[1]),
    );
    panel.y.view = span(&heights).filter(|(low, high)| high > low).map(|(low, high)| {
        let margin = 0.06 * (high - low);
        [low - margin, high + margin]
    });
    Some((panel, caption(run, crush, &loading, &unloading)))
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

/// Force of a model over the displacement of its compartment, up to where it is compared.
fn model_line(candidate: &CandidateResult, per_g: f64) -> Option<Vec<[f64; 2]>> {
    let (displacement, a) = (candidate.displacement.as_ref()?, candidate.acceleration.as_ref()?);
    let to_s = candidate.simulation.as_ref().map_or(f64::INFINITY, |s| s.to_s);
    let last = displacement.index_at_or_after(to_s).saturating_add(1).min(displacement.len());
    let samples = displacement.samples()[..last].iter().enumerate();
    let point = |(k, x): (usize, &f64)| Some([MILLI * x, per_g * G_PER_M_PER_S2 * a.at(displacement.time_s(k))?]);
    Some(samples.filter_map(point).collect())
}

/// The barrier force as its load cells measured it, up to `t_end`.
fn load_cells(cells: &Sampled, displacement: &Sampled, t_end: f64) -> Vec<[f64; 2]> {
    let last = t_end.min(displacement.end_s());
    (displacement.index_at_or_after(0.0)..displacement.len())
        .map(|k| (displacement.time_s(k), displacement.samples()[k]))
        .take_while(|(t, _)| *t <= last)
        .filter_map(|(t, x)| Some([MILLI * x, KILO * cells.at(t)?]))
        .collect()
}

fn caption(run: &Run, crush: Option<f64>, loading: &Branch, unloading: &Branch) -> String {
    let with_unit = |value: f64, unit: &str| words::significant_quantity(value, 4, unit);
    let mut caption = String::from(" ");
    if crush.is_some() && run.test.mass_kg.is_some() && run.measured.force.is_some() {
        let work = with_unit(KILO * loading.work(), "kJ");
        let spring = run
            .one_spring()
            .map(|spring| format!("; one spring with the energy and the crush of the test has {}", spring.shown()));
        caption.push_str(&format!("Loading takes up {work}{}. ", spring.unwrap_or_default()));
        if !unloading.x.is_empty() {
            let work = with_unit(KILO * -unloading.work(), "kJ");
            caption.push_str(&format!("Unloading gives {work} back. "));
        }
    }
    caption.push_str(if run.measured.force.is_some() {
        "Force is the test mass times the deceleration of this sensor: the barrier force of a vehicle that moves as \
         one body."
    } else {
        "Deceleration instead of force: the record has neither mass nor force."
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
    title: (&'static str, &'static str),
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
