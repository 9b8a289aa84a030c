//! All figures, in the order of the page.

use serde_json::json;

use super::crash::{elements, force, mass_split, models, motion, sensors};
use super::identification::{bode, poles, responses, singular_values, stabilisation};
use crate::drawing::figure::{Figure, set};
use crate::{Ranking, Run};

/// All figures that the run has records for, in the order of the page.
pub fn all_figures(run: &Run, ranking: &Ranking) -> Vec<Figure> {
    let mut figures: Vec<Figure> = [
        motion::figure(run),
        models::figure(run, ranking),
        sensors::figure(run, ranking),
        force::figure(run, ranking),
        elements::figure(run, ranking),
        mass_split::figure(run, ranking),
        poles::figure(run),
        singular_values::figure(run),
        stabilisation::figure(run),
        bode::figure(run),
        responses::figure(run),
    ]
    .into_iter()
    .flatten()
    .collect();
    // Left alone, plotly drops points of a line by its own rule, and smooth curves come out with corners.
    for line in figures.iter_mut().flat_map(|figure| &mut figure.traces).filter_map(|trace| trace.get_mut("line")) {
        set(line, json!({"simplify": false}));
    }
    figures
}
