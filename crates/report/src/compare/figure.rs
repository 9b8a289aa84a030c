//! The tests of several runs and their recommended models over each other.

use crate::drawing::numbers::{G_PER_M_PER_S2, KILO, KM_PER_H_PER_M_PER_S, MILLI};
use crate::drawing::{Axis, Colour, Dash, Figure, Look, Panel, Width, over_time, span};
use crumple_signal::Sampled;

use super::compared_run::ComparedRun;
use crate::figures::crash::curves::view_ms;
use crate::figures::time_view::{ACCELERATION, DISPLACEMENT, FORCE, Titled, VELOCITY, over_time_axis};

/// What of a run is drawn in one panel over time: the test's wave and the model's.
type Pair<'a> = (Option<&'a Sampled>, Option<&'a Sampled>);
type WavesOf = for<'a> fn(&'a ComparedRun) -> Pair<'a>;

/// Acceleration, velocity, displacement over time and force over crush; `None` where no run has a curve.
pub fn figure(runs: &[ComparedRun]) -> Option<Figure> {
    let mut figure = Figure::new("curves", "Curves over each other");
    let same = |a: Option<&Sampled>, b: Option<&Sampled>| match (a, b) {
        (Some(a), Some(b)) => (a.t0_s(), a.dt_s(), a.samples()) == (b.t0_s(), b.dt_s(), b.samples()),
        (a, b) => a.is_none() && b.is_none(),
    };
    let one_test = runs.windows(2).all(|pair| {
        let [a, b] = [of_test(&pair[0]), of_test(&pair[1])];
        a.into_iter().zip(b).all(|(a, b)| same(a, b))
    });
    let thick = Look::line(Colour::Test, Dash::Solid).width(Width::Thick);
    let entries: Vec<(usize, usize)> = runs
        .iter()
        .enumerate()
        .map(|(k, run)| {
            let test = match (one_test, k) {
                (true, 0) => figure.entry("test, the same in all runs", thick, true),
                (true, _) => 0,
                (false, _) => {
                    let look = Look::line(Colour::Series(k), Dash::Solid).width(Width::Thick);
                    figure.entry(format!("{}, test", run.name), look, true)
                }
            };
            let model = run.recommended().map_or_else(|| "model".to_owned(), |model| run.run.name_of(&model.id));
            let look = Look::line(Colour::Series(k), Dash::Dashed);
            (test, figure.entry(format!("{}, {model}", run.name), look, true))
        })
        .collect();
    let drawn = |k: usize| k == 0 || !one_test;
    let views = || runs.iter().filter_map(|run| view_ms(&run.run));
    let view = views().reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let quantities: [(Titled, f64, WavesOf); 3] = [
        (ACCELERATION, G_PER_M_PER_S2, |run| {
            (run.run.acceleration(), run.recommended().and_then(|model| model.acceleration.as_ref()))
        }),
        (VELOCITY, KM_PER_H_PER_M_PER_S, |run| {
            (run.run.measured.velocity.as_ref(), run.recommended().and_then(|model| model.velocity.as_ref()))
        }),
        (DISPLACEMENT, MILLI, |run| {
            (run.run.measured.displacement.as_ref(), run.recommended().and_then(|model| model.displacement.as_ref()))
        }),
    ];
    for (title, factor, of) in quantities {
        let mut panel = over_time_axis(view, Axis::of(title));
        for (k, run) in runs.iter().enumerate() {
            let (test, model) = of(run);
            if let Some(test) = test.filter(|_| drawn(k)) {
                panel.line(entries[k].0, over_time(test, factor));
            }
            if let Some(model) = model {
                panel.line(entries[k].1, over_time(model, factor));
            }
            let events = run.run.events.as_ref().filter(|_| title == DISPLACEMENT && drawn(k));
            if let Some((t_m, crush)) = events.and_then(|e| e.time_of_dynamic_crush_s.zip(e.dynamic_crush_m)) {
                panel.dots.push([MILLI * t_m, MILLI * crush]);
            }
        }
        figure.panels.push(panel);
    }
    figure.panels.extend(force_over_crush(runs, &entries, one_test));
    figure.caption = "SAE J211 sign: deceleration is negative. Solid: the test; dashed: the model that its run \
                      recommends, its own motion without the filter. The dots are dynamic crush and its time."
        .to_owned();
    Some(figure.tidy()).filter(|figure| !figure.panels.is_empty())
}

/// The waves of the test that are drawn.
fn of_test(run: &ComparedRun) -> [Option<&Sampled>; 3] {
    [run.run.acceleration(), run.run.measured.velocity.as_ref(), run.run.measured.displacement.as_ref()]
}

/// Up to the rebound, where the force ends. `None` where a run has no mass.
fn force_over_crush(runs: &[ComparedRun], entries: &[(usize, usize)], one_test: bool) -> Option<Panel> {
    let mut panel = Panel::new(Axis::of(DISPLACEMENT), Axis::of(FORCE));
    for (k, run) in runs.iter().enumerate() {
        let mass_kg = run.run.test.mass_kg?;
        let end = run.run.events.as_ref().and_then(|events| events.time_of_rebound_s).unwrap_or(f64::INFINITY);
        let curve = |x: &Sampled, a: &Sampled| -> Option<Vec<[f64; 2]>> {
            let steps = (0..x.len()).filter(|i| (0.0..=end).contains(&x.time_s(*i)));
            let points = steps.map(|i| {
                let at = a.index_at_or_after(x.time_s(i) - 0.5 * a.dt_s());
                [MILLI * x.samples()[i], -KILO * mass_kg * a.samples().get(at).copied().unwrap_or(f64::NAN)]
            });
            Some(points.collect()).filter(|points: &Vec<_>| points.len() > 1)
        };
        let measured = &run.run.measured;
        let test = measured.displacement.as_ref().zip(run.run.acceleration()).filter(|_| k == 0 || !one_test);
        if let Some(points) = test.and_then(|(x, a)| curve(x, a)) {
            panel.line(entries[k].0, points);
        }
        let model = run.recommended();
        let waves = model.and_then(|model| model.displacement.as_ref().zip(model.acceleration.as_ref()));
        if let Some(points) = waves.and_then(|(x, a)| curve(x, a)) {
            panel.line(entries[k].1, points);
        }
    }
    let forward: Vec<f64> = panel.curves.iter().flat_map(|curve| &curve.points).map(|point| point[0]).collect();
    let (low, high) = span(&forward)?;
    let room = 0.03 * (high - low);
    panel.x.view = (room > 0.0).then_some([low - room, high + room]);
    Some(panel)
}
