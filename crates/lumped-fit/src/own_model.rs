//! Own models: laws that a person states, fitted to the motion of one or several sensors like a stated chain.

use std::sync::Arc;

use crumple_lumped::{FreeNumber, LawMass, Model, OwnLaw, OwnModel, ParameterKind};

use crate::candidate::Candidate;
use crate::chain::{AROUND, ChainCoordinates, fit_stated};
use crate::coordinates::Coordinates;
use crate::error::SolveError;
use crate::parameters::{FitParameter, Map};
use crate::record::observation::Observation;

/// Fits the free numbers of a law to waves, each of a mass by its index from the barrier on (`None`: the last), as
/// [`StatedChain::fit`](crate::StatedChain::fit) does those of a chain: logarithms within the bounds of the law.
/// `total_mass_kg`: mass of the vehicle.
///
/// Errors: a rest or a share without a total, masses that leave nothing for the rest, nothing that is free, no start
/// with a finite motion.
pub fn fit_own_model(
    law: &Arc<OwnLaw>,
    total_mass_kg: Option<f64>,
    observed: &Observation,
    starts: usize,
) -> Result<Vec<Candidate>, SolveError> {
    let needs_total = law.masses().any(|mass| matches!(mass, LawMass::Rest | LawMass::Share(_)));
    if needs_total && total_mass_kg.is_none() {
        return Err(SolveError::RestWithoutTotal);
    }
    let total_kg = total_mass_kg.unwrap_or(0.0);
    let start = OwnModel::at_start(law.clone(), total_kg)?;
    let masses = law.masses().count();
    let rest = law.masses().position(|mass| mass == LawMass::Rest);
    let of_mass = |(index, mass): (usize, LawMass)| match mass {
        LawMass::Free(free) => Some(number(index, format!("m{}_kg", index + 1), ParameterKind::Mass, &free)),
        _ => None,
    };
    let of_parameter = |(place, (name, kind, free)): (usize, (&str, ParameterKind, Option<FreeNumber>))| {
        Some(number(masses + place, name.to_owned(), kind, &free?))
    };
    let free: Vec<FitParameter> = law
        .masses()
        .enumerate()
        .filter_map(of_mass)
        .chain(law.parameters().enumerate().filter_map(of_parameter))
        .collect();
    if free.is_empty() {
        return Err(SolveError::NothingFree);
    }
    let numbers = Coordinates::new(Model::Own(start), free).with_rest(rest, total_kg);
    fit_stated(&ChainCoordinates::within(numbers), observed, starts)
}

/// A number with its logarithm within its bounds; searches start around a start that is given, else anywhere.
fn number(index: usize, name: String, kind: ParameterKind, free: &FreeNumber) -> FitParameter {
    let around = |start: f64| ((start / AROUND).max(free.lower), (start * AROUND).min(free.upper));
    let (low, high) = free.start.map_or((free.lower, free.upper), around);
    let (bounds, starts) = ((free.lower.ln(), free.upper.ln()), (low.ln(), high.ln()));
    let number = FitParameter::of_search((index, name.into(), kind), Map::Logarithm(1.0), bounds, starts);
    FitParameter { limit: free.upper, lowest: free.lower, ..number }
}
