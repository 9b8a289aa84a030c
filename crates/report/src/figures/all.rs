//! All figures, in the order of the page.

use crate::drawing::Figure;
use crate::findings::{Ranking, Run};

use super::crash::{crush_over_speed, curves, elements, mass_split, recorded, residual, sensors};
use super::identification::{bode, poles, responses, simulated, singular_values, stabilisation};

/// All figures that the run has records for, in the order of the page.
pub fn all_figures(run: &Run, ranking: &Ranking) -> Vec<Figure> {
    let mut figures = crash_figures(run, ranking);
    figures.extend(identification_figures(run));
    figures
}

/// Those of the crash.
pub fn crash_figures(run: &Run, ranking: &Ranking) -> Vec<Figure> {
    let figures = [
        recorded::figure(run),
        crush_over_speed::figure(run, ranking),
        curves::figure(run, ranking),
        residual::figure(run, ranking),
        sensors::figure(run, ranking),
        elements::figure(run, ranking),
        mass_split::figure(run, ranking),
    ];
    figures.into_iter().flatten().collect()
}

/// Those of the identified models; without a simulation where nobody knows what drove the record.
pub fn identification_figures(run: &Run) -> Vec<Figure> {
    let is_driven = |_: &Figure| run.ambient().is_none();
    let figures = [
        simulated::compare(run).filter(is_driven),
        simulated::errors(run).filter(is_driven),
        poles::figure(run),
        singular_values::figure(run),
        stabilisation::figure(run),
        bode::figure(run),
        responses::figure(run),
    ];
    figures.into_iter().flatten().collect()
}
