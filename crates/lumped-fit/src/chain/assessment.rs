//! The assessment of a fitted chain, with the propagation of uncertain inputs.

use std::collections::BTreeMap;

use crumple_lumped::{Chain, HORIZON_S, ParameterKind};

use crate::chain::coordinates::{ChainCoordinates, StatedChain};
use crate::chain::fit::{ChainSolution, assess_at};
use crate::fit::as_measured::near;
use crate::free::coordinates::Coordinates;
use crate::uncertainty::assessment::{Assessment, AssessmentOptions};
use crate::uncertainty::propagation::{
    Errors, InputUncertainty, Propagation, Repetition, over_repetitions, with_errors,
};
use crate::{Observation, SolveError};

/// What is computed for a chain beyond the covariance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ChainAssessmentOptions {
    /// Profile and bootstrap.
    pub options: AssessmentOptions,
    /// Errors of what the test is told.
    pub inputs: InputUncertainty,
    /// Repetitions with these errors.
    pub repetitions: usize,
}

/// Assessment and propagation of one solution.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ChainAssessment {
    /// Covariance, intervals, profiles and bootstrap; `None` where nothing is determined.
    pub assessment: Option<Assessment>,
    /// The fit repeated with uncertain inputs, where asked for.
    pub propagation: Option<Propagation>,
}

/// Assesses a solution of [`fit_chain`](crate::fit_chain), called with the arguments of that fit, by the rules of
/// [`assess`](crate::assess) and [`propagate`](crate::propagate) in the logarithms of the free numbers.
///
/// The weights of the waves stay those of the fit. An uncertain mass is that of the test: where a mass is the rest of
/// the total, the rest takes the difference; where none is, all masses change by the same share. Numbers that are
/// given stay, so springs are proportional to the mass only where all of them are free.
///
/// Every repetition descends from the minimum: the intervals are those of this minimum and contain no other. The same
/// seeds as for the single models, a stream for each replicate: the result does not depend on the number of threads.
/// Errors: as of the fit.
pub fn assess_chain(
    stated: &StatedChain,
    observed: &Observation,
    solution: &ChainSolution,
    asked: &ChainAssessmentOptions,
) -> Result<ChainAssessment, SolveError> {
    let length_s = observed.waves.iter().map(|w| w.time_s(w.samples.len() - 1)).fold(0.0, f64::max);
    let coordinates = ChainCoordinates::new(stated, length_s)?.numbers;
    let mut measured = observed.clone();
    let sensors = &solution.fit.sensors;
    for (wave, sensor) in measured.waves.iter_mut().zip(sensors) {
        wave.weight = sensors[0].noise / sensor.noise;
    }
    let (problem, theta) = (near(&coordinates, &measured), &solution.theta);
    let on_bound: Vec<bool> =
        coordinates.names().iter().map(|name| solution.fit.active_bounds.contains(name)).collect();
    let assessment = assess_at(&problem, (theta, &on_bound), asked.options);
    let repeated = || {
        let mass_kg = stated.total_mass_kg.unwrap_or_else(|| solution.chain.masses_kg().iter().sum());
        let repetitions = (asked.repetitions, measured.waves.len());
        over_repetitions(mass_kg, &asked.inputs, repetitions, |errors: &Errors| {
            let Repetition { observed, mass_ratio } = with_errors(&measured, errors)?;
            repeat(&coordinates.of_mass(mass_ratio), &observed, theta, mass_ratio)
        })
    };
    Ok(ChainAssessment { assessment, propagation: asked.inputs.any().then(repeated).flatten() })
}

/// Fits one repetition, from the minimum scaled to the mass drawn.
///
/// Gives the value of every free number, in its unit, and `dynamic_crush_m` of the compartment where the chain stops
/// within [`HORIZON_S`]. `None` without a finite response.
fn repeat(
    coordinates: &Coordinates<Chain>,
    waves: &Observation,
    theta: &[f64],
    mass_ratio: f64,
) -> Option<BTreeMap<String, f64>> {
    // Without a rest everything is a share of the mass; with one the free masses alone, so that something is
    // left for it.
    let of_mass = |i: usize| coordinates.rest.is_none() || coordinates.free[i].kind == ParameterKind::Mass;
    let by = |i: usize| if of_mass(i) { mass_ratio.ln() } else { 0.0 };
    let start: Vec<f64> = theta.iter().enumerate().map(|(i, x)| x + by(i)).collect();
    let minimum = near(coordinates, waves).follow(&start)?;
    let free = coordinates.names().into_iter().zip(minimum.theta.iter().map(|x| x.exp()));
    let mut values: BTreeMap<String, f64> = free.chain(coordinates.free_rest(&minimum.theta)).collect();
    let events = coordinates.model(&minimum.theta)?.events(waves.impact_speed_m_per_s, HORIZON_S).ok();
    if let Some(crush) = events.and_then(|mut events| events.pop()?.dynamic_crush_m) {
        values.insert("dynamic_crush_m".to_owned(), crush);
    }
    Some(values)
}
