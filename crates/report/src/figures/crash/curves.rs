//! The crash: acceleration, velocity and displacement over time, force over crush; the test, the models over it and
//! the other sensors at the same place.

use super::drawn_models::DrawnModels;
use super::force;
use super::same_place::Envelope;
use crate::drawing::numbers::{G_PER_M_PER_S2, KM_PER_H_PER_M_PER_S, MILLI, NBSP};
use crate::drawing::{Axis, Colour, Dash, Entry, Figure, Look, Panel, Width, over_time, span};
use crate::figures::time_view::{ACCELERATION, DISPLACEMENT, Titled, VELOCITY, over_time_axis, time_view_ms};
use crate::findings::{CandidateResult, Ranking, Run};
use crate::words;
use crumple_signal::Sampled;

/// A model may widen an axis beyond the test by this share of what the test spans.
const ROOM_FOR_MODELS: f64 = 0.25;

/// As many panels as there are records for; `None` without any.
pub fn figure(run: &Run, ranking: &Ranking) -> Option<Figure> {
    let models = DrawnModels::of(run, ranking);
    let title = if models.models.is_empty() { "The test: curves" } else { "Test and models" };
    drawn("curves", title, run, &models)
}

/// The pulse and the force over crush of the test and the recommended model: the figure of the first screen. `None`
/// without both.
pub fn first(run: &Run, ranking: &Ranking) -> Option<Figure> {
    let models = DrawnModels::of(run, ranking).recommended(ranking);
    let mut figure = drawn("first", "The pulse, and the force over crush", run, &models)?;
    let pulse = figure.panels.iter().position(|panel| panel.time)?;
    let force = figure.panels.iter().position(|panel| panel.follows.is_some())?;
    figure.panels = [pulse, force].map(|place| figure.panels[place].clone()).to_vec();
    figure.caption.clear();
    // Other curves, other sensors, cursor and zoom are in the figure below.
    let is_first = |entry: &Entry| entry.shown && matches!(entry.look.colour, Colour::Test | Colour::Series(_));
    let kept: Vec<bool> = figure.legend.iter().map(is_first).collect();
    for panel in &mut figure.panels {
        panel.curves.retain(|curve| kept[curve.entry]);
        panel.marks.retain(|mark| mark.colour == Colour::Event);
        panel.bands.clear();
        (panel.time, panel.follows, panel.height) = (false, None, HEIGHT_OF_FIRST);
        if let Some([from, to]) = panel.x.view {
            panel.curves.iter_mut().for_each(|curve| curve.points.retain(|p| (from..=to).contains(&p[0])));
        }
    }
    Some(figure.tidy())
}

/// Height of a panel of the first screen, as wide as 560.
const HEIGHT_OF_FIRST: f64 = 230.0;

fn drawn(id: &'static str, title: &str, run: &Run, models: &DrawnModels<'_>) -> Option<Figure> {
    let measured = &run.measured;
    if run.acceleration().is_none() && measured.displacement.is_none() {
        return None;
    }
    let mut figure = Figure::new(id, title);
    let test = figure.entry(test_name(run), Look::line(Colour::Test, Dash::Solid).width(Width::Thick), true);
    let raw =
        figure.entry("as read", Look::line(Colour::Raw, Dash::Solid).width(Width::Thin), measured.filtered.is_none());
    let envelope = Envelope::of_run(run);
    let same_place = figure.entry(
        envelope.as_ref().map_or_else(String::new, |e| format!("sensors at the same place: {}", e.channels.join(", "))),
        Look::area(Colour::Test),
        true,
    );
    let entries = models.entries(&mut figure);
    let view = view_ms(run);

    type Of = fn(&CandidateResult) -> Option<&Sampled>;
    let acceleration: (_, Titled, f64, Of) =
        (run.acceleration(), ACCELERATION, G_PER_M_PER_S2, |c| c.acceleration.as_ref());
    let velocity: (_, Titled, f64, Of) =
        (measured.velocity.as_ref(), VELOCITY, KM_PER_H_PER_M_PER_S, |c| c.velocity.as_ref());
    let displacement: (_, Titled, f64, Of) =
        (measured.displacement.as_ref(), DISPLACEMENT, MILLI, |c| c.displacement.as_ref());
    for (place, (signal, title, factor, of)) in [acceleration, velocity, displacement].into_iter().enumerate() {
        let Some(signal) = signal else { continue };
        let drawn: Vec<(usize, &Sampled)> =
            models.models.iter().zip(&entries).filter_map(|((c, _), entry)| Some((*entry, of(c)?))).collect();
        let shown = drawn.iter().filter(|(entry, _)| figure.legend[*entry].shown).map(|(_, signal)| *signal);
        let mut panel = over_time_axis(view, Axis { view: y_view(signal, shown, factor, view), ..Axis::of(title) });
        if let Some(edges) = envelope.as_ref().and_then(|e| e.edges(place, factor)) {
            panel.band(same_place, &edges);
        }
        if let Some(unfiltered) = measured.raw.as_ref().filter(|_| place == 0) {
            panel.line(if measured.filtered.is_some() { raw } else { test }, over_time(unfiltered, factor));
        }
        if place > 0 || measured.filtered.is_some() {
            panel.line(test, over_time(signal, factor));
        }
        for (entry, signal) in drawn {
            panel.line(entry, over_time(signal, factor));
        }
        mark_events(run, &mut panel, place);
        panel.windows.extend(window_ms(run));
        figure.panels.push(panel);
    }
    let mut caption = caption(run, models);
    if let Some((panel, words)) = force::panel(run, models, &entries, test, &mut figure) {
        figure.panels.push(panel);
        caption.push_str(&words);
    }
    figure.caption = caption;
    Some(figure.tidy())
}

/// `test, CFC 60`.
fn test_name(run: &Run) -> String {
    let cfc = run.filter.as_ref().and_then(|f| f.cfc).or_else(|| run.channel().and_then(|c| c.cfc));
    match (cfc, &run.measured.filtered) {
        (Some(cfc), Some(_)) => format!("test, CFC{NBSP}{cfc}"),
        (None, Some(_)) => "test, filtered".to_owned(),
        _ => "test, as read".to_owned(),
    }
}

/// First view of time: to a little beyond the rebound, or twice the time of crush.
pub(crate) fn view_ms(run: &Run) -> Option<[f64; 2]> {
    let [start, end] = time_view_ms(run)?;
    let Some(t_m) = run.time_of_crush_s().map(|t| MILLI * t).filter(|t| *t > 0.0) else { return Some([start, end]) };
    let rebound = run.events.as_ref().and_then(|e| e.time_of_rebound_s).map_or(0.0, |t| 1.1 * MILLI * t);
    Some([start.max(-0.1 * t_m), end.min(rebound.clamp(1.6 * t_m, 2.5 * t_m))])
}

/// The stretch that the models are compared over.
pub(super) fn window_ms(run: &Run) -> Option<[f64; 2]> {
    let simulation = run.candidates.iter().find_map(|candidate| candidate.simulation.as_ref())?;
    Some([MILLI * simulation.from_s, MILLI * simulation.to_s])
}

/// What the test spans in the first view, and of the models shown what is not far beyond it.
fn y_view<'a>(
    test: &Sampled,
    models: impl Iterator<Item = &'a Sampled>,
    factor: f64,
    view: Option<[f64; 2]>,
) -> Option<[f64; 2]> {
    let seen = |signal: &Sampled| {
        let [from, to] = view.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]).map(|t| t / MILLI);
        let from = signal.index_at_or_after(from).min(signal.len());
        let to = signal.index_at_or_after(to).saturating_add(1).min(signal.len()).max(from);
        span(&signal.samples()[from..to]).map(|(low, high)| (factor * low, factor * high))
    };
    let (low, high) = seen(test)?;
    let room = ROOM_FOR_MODELS * (high - low);
    let wide = models
        .filter_map(seen)
        .fold((low, high), |(l, h), (a, b)| (l.min(a.max(low - room)), h.max(b.min(high + room))));
    let margin = 0.06 * (wide.1 - wide.0);
    (margin > 0.0).then_some([wide.0 - margin, wide.1 + margin])
}

/// Time of crush and rebound in one of the three panels over time.
fn mark_events(run: &Run, panel: &mut Panel, place: usize) {
    let events = run.events.as_ref();
    let crush = events.and_then(|e| e.dynamic_crush_m);
    if let Some(t_m) = run.time_of_crush_s().map(|t| MILLI * t) {
        let time = format!("tₘ = {}", words::quantity(t_m, 1, "ms"));
        let name = match (place, crush) {
            (2, Some(crush)) => format!("C = {}", words::quantity(MILLI * crush, 1, "mm")),
            _ => time,
        };
        panel.mark(t_m, name, Colour::Event, Dash::Dashed);
        match (place, crush) {
            (1, _) => panel.dots.push([t_m, 0.0]),
            (2, Some(crush)) => panel.dots.push([t_m, MILLI * crush]),
            _ => {}
        }
    }
    let in_view = |t: &f64| panel.x.view.is_none_or(|[from, to]| (from..=to).contains(t));
    if let Some(t) = events.and_then(|e| e.time_of_rebound_s).map(|t| MILLI * t).filter(in_view) {
        let name = format!("rebound, {}", words::quantity(t, 1, "ms"));
        panel.mark(t, name, Colour::Muted, Dash::Dotted);
    }
    if panel.x.view.is_some_and(|[from, _]| from < 0.0) {
        panel.mark(0.0, "", Colour::Muted, Dash::Solid);
    }
}

fn caption(run: &Run, models: &DrawnModels) -> String {
    let mut text = format!("Channel {}", run.channel_id().unwrap_or("unknown"));
    if let Some(channel) = run.channel().filter(|channel| !channel.location.is_empty()) {
        text.push_str(&format!(" ({})", channel.location));
    }
    text.push_str(", SAE J211 sign: deceleration is negative.");
    if let Some(filter) = run.filter.as_ref().filter(|filter| filter.cfc.is_some()) {
        text.push_str(&format!(
            " Filtered in mode {}. Click the unfiltered record in the legend to show it; it may exceed the axes.",
            filter.mode
        ));
    }
    if let Some(events) = &run.events {
        let words = |text: &str| text.replace('-', " ");
        match (events.rule.as_deref().map(words), events.start.as_deref().map(words)) {
            (Some(rule), Some(start)) => {
                text.push_str(&format!(" Velocity and displacement by the {rule} rule from {start}."));
            }
            (Some(rule), None) => text.push_str(&format!(" Integrated by the {rule} rule.")),
            _ => {}
        }
        if events.time_of_dynamic_crush_s.is_none() {
            text.push_str(" The velocity does not reach zero within the record: there is no dynamic crush to mark.");
        }
    }
    if let Some([from, to]) = window_ms(run).filter(|_| !models.models.is_empty()) {
        let [from, to] = [from, to].map(|end| words::decimals(end, 1));
        text.push_str(&format!(" Models are compared in the shaded window, {from} to {to} ms."));
    }
    if models.hides_some() {
        text.push_str(
            " Click other models in the legend to show them. One curve stands for parameter sets that fit alike.",
        );
    }
    if models.equals > 0 {
        text.push_str(" Parameter sets that give exactly the same record (duals) are drawn once.");
    }
    text
}
