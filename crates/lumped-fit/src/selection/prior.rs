//! What is known of vehicles beside the record, as squared terms that a reader can take off.

use crate::selection::compared_candidate::{ComparedCandidate, EnergyClass};

/// Restitution below which none is told from another: 5 % of 15 m/s are less than the drift of a velocity.
const LEAST_RESTITUTION: f64 = 0.05;

/// The rules of the choice; every number can be changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelectionRules {
    /// What a model without plastic deformation is charged.
    pub plastic_prior: f64,
    /// Restitution of vehicles in general, where the record shows none.
    pub restitution_prior: f64,
    /// Standard deviation of its logarithm; 0: no such term.
    pub restitution_deviation: f64,
    /// Displacement fit as measured from which a model is adequate, percent.
    pub adequate_fit_percent: f64,
    /// Largest relative error of the dynamic crush of the test, or of any of several, of an adequate model, percent.
    pub crush_limit_percent: f64,
    /// Largest relative error of the time of dynamic crush, percent.
    pub time_limit_percent: f64,
    /// Largest difference of the coefficient of restitution.
    pub restitution_limit: f64,
    /// Misfit of a measured wall force up to which a model is recommended, percent.
    pub force_limit_percent: f64,
    /// Error of the crush at lower speeds, beside what the record itself shows, up to which a plastic model is taken
    /// for its criterion, percent.
    pub lower_speed_limit_percent: f64,
}

impl Default for SelectionRules {
    fn default() -> Self {
        Self {
            plastic_prior: 10.0,
            restitution_prior: 0.15,
            restitution_deviation: 0.35,
            adequate_fit_percent: 90.0,
            // Of 208 made cars every damped one keeps its model within these limits, and no plastic one keeps a damped
            // model; 0.05 and 0.15 of restitution do the same.
            crush_limit_percent: 3.5,
            time_limit_percent: 5.0,
            restitution_limit: 0.1,
            force_limit_percent: 35.0,
            lower_speed_limit_percent: 1.0,
        }
    }
}

/// One piece of prior knowledge, in words.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    /// Its name.
    pub name: &'static str,
    /// What it says, with its numbers.
    pub statement: String,
    /// Where it comes from.
    pub source: &'static str,
}

/// Name of the prior on what takes the energy.
const CLASS: &str = "class";
/// Name of the prior on restitution.
const RESTITUTION: &str = "restitution";

impl SelectionRules {
    /// The priors that are in use. `tested`: the restitution that the record shows.
    pub fn priors(&self, tested: Option<f64>) -> Vec<Prior> {
        let mut priors = Vec::new();
        if self.plastic_prior > 0.0 {
            priors.push(Prior {
                name: CLASS,
                statement: format!(
                    "the front of a vehicle deforms plastically and depends little on the rate: a model whose energy \
                     goes into dampers or back into springs is charged {}, so it must win by more than that without \
                     this term",
                    self.plastic_prior
                ),
                source: "96 to 99 % of the energy is lost in full frontal tests at 56 km/h; differences above 10 are \
                         decisive (Burnham & Anderson 2002, section 2.6)",
            });
        }
        if self.restitution_deviation > 0.0 {
            let centre = match tested {
                Some(e) => format!("the test shows {:.3}", e.max(LEAST_RESTITUTION)),
                None => format!("the record shows none, vehicles in general {}", self.restitution_prior),
            };
            priors.push(Prior {
                name: RESTITUTION,
                statement: format!(
                    "coefficient of restitution e: {centre}; term ((ln e - ln {:.3})/{})^2",
                    self.centre(tested),
                    self.restitution_deviation
                ),
                source: "full frontal tests at 56 km/h: 0.10 to 0.20; restitution and speed: Monson & Germane, SAE \
                         1999-01-0097",
            });
        }
        priors
    }

    /// What each of them adds to the criterion of a candidate.
    pub fn terms(&self, candidate: &ComparedCandidate, tested: Option<f64>) -> Vec<(&'static str, f64)> {
        let mut terms = Vec::new();
        if self.plastic_prior > 0.0 {
            let is_plastic = candidate.class == EnergyClass::Plastic;
            terms.push((CLASS, if is_plastic { 0.0 } else { self.plastic_prior }));
        }
        if self.restitution_deviation > 0.0 {
            let e = candidate.restitution.unwrap_or(0.0).max(LEAST_RESTITUTION);
            terms.push((RESTITUTION, ((e / self.centre(tested)).ln() / self.restitution_deviation).powi(2)));
        }
        terms
    }

    fn centre(&self, tested: Option<f64>) -> f64 {
        tested.unwrap_or(self.restitution_prior).max(LEAST_RESTITUTION)
    }
}
