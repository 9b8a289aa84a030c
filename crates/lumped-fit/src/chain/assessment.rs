//! Profile likelihood, bootstrap and propagation of uncertain inputs for a fitted chain.
//!
//! The rules are those of the single models in `uncertainty`; a chain adds masses that are the rest of a total, and
//! coordinates that are all logarithms.

use std::collections::BTreeMap;

use crate::chain::coordinates::{ChainCoordinates, StatedChain};
use crate::chain::fit::ChainSolution;
use crate::fit::problem::Problem;
use crate::free::parameterisation::Parameterisation;
use crate::uncertainty::assessment::AssessmentOptions;
use crate::uncertainty::block_bootstrap::{BlockBootstrap, replicate};
use crate::uncertainty::profile_likelihood::{Profile, Profiled};
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

/// Profiles, bootstrap and propagation of one solution; empty where nothing was asked for, or the model has no finite
/// response.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ChainAssessment {
    /// Profiles of everything that was free; of a mass that is the rest where one mass was.
    pub profile: Vec<Profile<String>>,
    /// Block bootstrap.
    pub bootstrap: Option<BlockBootstrap<String>>,
    /// The fit repeated with uncertain inputs.
    pub propagation: Option<Propagation<String>>,
}

/// The crush of a chain is looked for up to this time after contact, s. One that stops later counts as without a
/// crush.
const HORIZON_S: f64 = 2.0;

/// Assesses a solution of [`fit_chain`](crate::fit_chain), called with the arguments of that fit, by the rules of
/// [`profile`](crate::profile), [`bootstrap`](crate::bootstrap) and [`propagate`](crate::propagate) in the logarithms
/// of the free numbers.
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
    let coordinates = ChainCoordinates::new(stated, length_s)?;
    let mut measured = observed.clone();
    for (wave, noise) in measured.waves.iter_mut().zip(&solution.noise) {
        wave.weight = solution.noise[0] / noise;
    }
    let problem = Problem::new(&coordinates, &measured, 0.0);
    let theta = &solution.theta;
    let Some(misfit) = problem.misfit(theta) else { return Ok(ChainAssessment::default()) };

    let mut assessment = ChainAssessment::default();
    if let (true, Some(known)) = (asked.options.profile, &solution.linearised) {
        let bounds: Vec<(f64, f64)> = coordinates.axes().iter().map(|axis| (axis.lower, axis.upper)).collect();
        assessment.profile = Profiled {
            names: &coordinates.names,
            at: theta,
            bounds: &bounds,
            value: &|_, coordinate| coordinate.exp(),
            ends_at_zero: &|_| false,
            refit: &|fixed, coordinate, others| problem.follow_others(fixed, coordinate, others),
            misfit: &misfit,
            observed: &measured,
            expected: &known.half_width,
            effective_samples: known.effective_samples,
        }
        .profiles();
        assessment.profile.extend(profile_of_the_rest(&coordinates, theta, &assessment.profile));
    }
    if asked.options.bootstrap > 0 {
        assessment.bootstrap =
            replicate(&measured, &misfit, asked.options.bootstrap, coordinates.all_names(), |resampled| {
                let minimum = Problem::new(&coordinates, resampled, 0.0).follow(theta)?;
                Some(coordinates.values(&minimum.theta))
            });
    }
    if asked.inputs.any() {
        let mass_kg = stated.total_mass_kg.unwrap_or_else(|| solution.chain.masses_kg().iter().sum());
        let repetitions = (asked.repetitions, measured.waves.len());
        assessment.propagation = over_repetitions(mass_kg, &asked.inputs, repetitions, |errors: &Errors| {
            let Repetition { observed, mass_ratio } = with_errors(&measured, errors)?;
            repeat(&coordinates.of_mass(mass_ratio), &observed, theta, mass_ratio)
        });
    }
    Ok(assessment)
}

/// Fits one repetition, from the minimum scaled to the mass drawn.
///
/// Gives the value of every free number, in its unit, and `dynamic_crush_m` of the compartment where the chain stops
/// within [`HORIZON_S`]. `None` without a finite response.
fn repeat(
    coordinates: &ChainCoordinates,
    waves: &Observation,
    theta: &[f64],
    mass_ratio: f64,
) -> Option<BTreeMap<String, f64>> {
    // Without a rest everything is a share of the mass; with one the free masses alone, so that something is
    // left for it.
    let by = |i: usize| if !coordinates.has_rest() || coordinates.is_mass(i) { mass_ratio.ln() } else { 0.0 };
    let start: Vec<f64> = theta.iter().enumerate().map(|(i, x)| x + by(i)).collect();
    let minimum = Problem::new(coordinates, waves, 0.0).follow(&start)?;
    let mut values: BTreeMap<String, f64> =
        coordinates.all_names().into_iter().zip(coordinates.values(&minimum.theta)).collect();
    let events = coordinates.model(&minimum.theta)?.events(waves.impact_speed_m_per_s, HORIZON_S).ok();
    if let Some(crush) = events.and_then(|mut events| events.pop()?.dynamic_crush_m) {
        values.insert("dynamic_crush_m".to_owned(), crush);
    }
    Some(values)
}

/// The profile of the mass that is the rest of the total `m`. With one free mass it is the mirrored profile of that
/// mass, `m_rest = m - m_free` with lower and upper end exchanged; with several there is none.
fn profile_of_the_rest(
    coordinates: &ChainCoordinates,
    theta: &[f64],
    profiles: &[Profile<String>],
) -> Option<Profile<String>> {
    coordinates.free_rest()?;
    let mut masses = (0..theta.len()).filter(|&i| coordinates.is_mass(i));
    let (mass, None) = (masses.next()?, masses.next()) else { return None };
    let mirrored = profiles.get(mass)?;
    let total = coordinates.values(theta).last()? + theta[mass].exp();
    Some(Profile {
        parameter: coordinates.all_names().pop()?,
        low: mirrored.high.map(|kg| total - kg),
        high: mirrored.low.map(|kg| total - kg),
        points: mirrored.points.iter().rev().map(|(kg, rise)| (total - kg, *rise)).collect(),
    })
}
