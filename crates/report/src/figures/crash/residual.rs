//! What the models leave of the test: test minus model.

use crate::drawing::numbers::{KM_PER_H_PER_M_PER_S, MILLI};
use crate::drawing::{Axis, Colour, Dash, Figure, Look, over_time};
use crate::findings::{CandidateResult, Ranking, Run};
use crumple_signal::Sampled;

use super::curves::{view_ms, window_ms};
use super::drawn_models::DrawnModels;
use crate::figures::time_view::{Titled, over_time_axis};

/// Models drawn: the recommended, the closest, then by rank. A residual has many times the points of a motion.
const DRAWN: usize = 6;

/// A band is seen whole up to so many times the largest residual.
const BAND: f64 = 6.0;

/// Of displacement and velocity; `None` without a test or without a model.
pub fn figure(run: &Run, ranking: &Ranking) -> Option<Figure> {
    let models = DrawnModels::of(run, ranking);
    let mut figure = Figure::new("residual", "Test minus model");
    let entries = models.entries(&mut figure);
    let window = window_ms(run);
    let best = ranking.best.as_deref().and_then(|id| run.candidate(id));
    let band = best.and_then(|best| best.simulation.as_ref()?.band.as_ref());
    let name_of_band = "recommended: 95 % band from its parameters";
    let moved = band.is_some().then(|| figure.entry(name_of_band, Look::area(Colour::Test), true));
    type Of = fn(&CandidateResult) -> Option<&Sampled>;
    let displacement: (_, Titled, f64, Of) =
        (&run.measured.displacement, ("residual of the displacement", "mm"), MILLI, |c| c.displacement.as_ref());
    let velocity: (_, Titled, f64, Of) =
        (&run.measured.velocity, ("residual of the velocity", "km/h"), KM_PER_H_PER_M_PER_S, |c| c.velocity.as_ref());
    let bands = [band.map(|b| (b.dt_s, &b.displacement_m)), band.map(|b| (b.dt_s, &b.velocity_m_per_s))];
    for ((test, title, factor, of), band) in [displacement, velocity].into_iter().zip(bands) {
        let mut panel = over_time_axis(view_ms(run), Axis::of(title));
        if let Some((entry, (dt_s, half_widths))) = moved.zip(band) {
            let edge = |(k, half): (usize, &f64)| [MILLI * k as f64 * dt_s, -factor * half, factor * half];
            panel.band(entry, &half_widths.iter().enumerate().map(edge).collect::<Vec<_>>());
        }
        let mut largest = 0.0_f64;
        for ((candidate, _), entry) in models.models.iter().zip(&entries).take(DRAWN) {
            let Some(left) = test.as_ref().zip(of(candidate)).and_then(|(test, model)| residual(test, model)) else {
                continue;
            };
            if models.is_shown(candidate) {
                largest = largest.max(factor * largest_within(&left, window));
            }
            panel.line(*entry, over_time(&left, factor));
        }
        // By what lies inside the compared window: what a model does after it would flatten the rest.
        let widest = band.map_or(0.0, |(_, half_widths)| half_widths.iter().copied().fold(0.0, f64::max));
        let band = (factor * widest).min(BAND * largest);
        let half = 1.15 * largest.max(band);
        panel.y.view = (half > 0.0).then_some([-half, half]);
        panel.windows.extend(window);
        if let Some(t_m) = run.time_of_crush_s() {
            panel.mark(MILLI * t_m, "", Colour::Event, Dash::Dashed);
        }
        figure.panels.push(panel);
    }
    figure.caption = String::from(
        "The axes hold the largest residual inside the shaded window, which the models are compared over; a model \
         that was made for the loading phase may leave them after it. Of many models the first six are drawn.",
    );
    let figure = figure.tidy();
    (!figure.panels.is_empty()).then_some(figure)
}

/// Test minus model at the model's samples, as far as the test reaches.
fn residual(test: &Sampled, model: &Sampled) -> Option<Sampled> {
    let first = (0..model.len()).find(|&k| test.at(model.time_s(k)).is_some())?;
    let left: Vec<f64> =
        (first..model.len()).map_while(|k| Some(test.at(model.time_s(k))? - model.samples()[k])).collect();
    Sampled::new(model.time_s(first), model.dt_s(), left).ok()
}

/// Largest magnitude inside the window in ms, or of all where there is none.
fn largest_within(signal: &Sampled, window: Option<[f64; 2]>) -> f64 {
    let [from, to] = window.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let inside = (0..signal.len()).filter(|&k| (from..=to).contains(&(MILLI * signal.time_s(k))));
    inside.fold(0.0, |largest, k| largest.max(signal.samples()[k].abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_residual_is_scaled_by_the_compared_window() {
        let residual = Sampled::new(0.0, 0.01, vec![0.0, 1e-3, -2e-3, 5.0]).unwrap();
        assert_eq!(largest_within(&residual, Some([0.0, 25.0])), 2e-3);
        assert_eq!(largest_within(&residual, None), 5.0);
    }
}
