//! What a joint model says of the crush at every speed, with the tests it was fitted to.

use crate::drawing::numbers::{KM_PER_H_PER_M_PER_S, MILLI};
use crate::drawing::{Axis, Colour, Dash, Figure, Look, Panel, Symbol, Width};
use crate::findings::{Ranking, Run, capitalised};
use crate::words;
use crumple_artifact::records::PredictionV1;

/// The tests as points, the recommended model's predictions as a line with their interval; `None` of one test alone.
pub fn figure(run: &Run, ranking: &Ranking) -> Option<Figure> {
    let joint = run.joint.as_ref()?;
    let best = ranking.best.as_deref()?;
    let of_best = run.predictions.iter().filter(|p| p.candidate == best && p.partner.is_none());
    let mut predictions: Vec<&PredictionV1> = of_best.filter(|p| p.dynamic_crush_m.is_some()).collect();
    let mass_kg = predictions.first()?.mass_kg;
    predictions.retain(|prediction| prediction.mass_kg == mass_kg);
    predictions.sort_by(|a, b| a.impact_speed_m_per_s.total_cmp(&b.impact_speed_m_per_s));
    let mut figure = Figure::new("crush-over-speed", "Dynamic crush over impact speed");
    let tests = figure.entry("tests as measured", Look::marks(Colour::Test, Symbol::Ring), true);
    let look = Look::line(Colour::Series(0), Dash::Solid).width(Width::Thick);
    let line = figure.entry(capitalised(&run.name_of(best)), look, true);
    let band = figure.entry("its 90 % interval", Look::area(Colour::Series(0)), true);
    let km_per_h = |speed: f64| KM_PER_H_PER_M_PER_S * speed;
    let mut panel = Panel::new(Axis::of(("impact speed", "km/h")), Axis::of(("dynamic crush", "mm")));
    let edge = |p: &&PredictionV1| {
        let interval = p.intervals.iter().find(|interval| interval.name == "dynamic_crush_m")?;
        Some([km_per_h(p.impact_speed_m_per_s), MILLI * interval.low, MILLI * interval.high])
    };
    panel.band(band, &predictions.iter().filter_map(edge).collect::<Vec<_>>());
    let point = |p: &&PredictionV1| Some([km_per_h(p.impact_speed_m_per_s), MILLI * p.dynamic_crush_m?]);
    panel.line(line, predictions.iter().filter_map(point).collect());
    let measured = joint.tests.iter().map(|test| &test.test);
    let measured = measured.filter_map(|t| Some([km_per_h(t.impact_speed_m_per_s), MILLI * t.dynamic_crush_m?]));
    panel.points(tests, measured.collect());
    figure.panels.push(panel);
    let mass = words::quantity(mass_kg, 0, "kg");
    let caption =
        format!("Predictions of the joint model at {mass} against the wall of the tests; each test at its own mass.");
    Some(Figure { caption, ..figure.tidy() })
}
