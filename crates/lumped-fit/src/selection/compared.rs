//! What the choice knows of a candidate before it counts: what its fit and its model say of it, the rules with what is
//! known of vehicles beside the record, and whether it is adequate.

use std::fmt;

use crumple_lumped::{Model, ParameterKind};

use crate::selection::evidence::{Evidence, OF_A_NUMBER};

/// What takes the energy of the impact in a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum EnergyClass {
    /// Plastic deformation.
    Plastic,
    /// Dampers.
    Damped,
    /// Nothing: springs give all of it back.
    Elastic,
}

impl EnergyClass {
    /// The class of a model.
    pub fn of(model: &Model) -> Self {
        match model {
            Model::Elastoplastic(_) | Model::ForceDeflection(_) | Model::LoadPaths(_) => Self::Plastic,
            Model::Own(own) if own.law().is_plastic() => Self::Plastic,
            _ if depends_on_rate(model) => Self::Damped,
            _ => Self::Elastic,
        }
    }

    /// Its name in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plastic => "plastic",
            Self::Damped => "damped",
            Self::Elastic => "elastic",
        }
    }
}

/// Whether a damper of the model has a force. A rate is the place of a damper's knot; a rate factor of a structure is a
/// prior and small.
pub fn depends_on_rate(model: &Model) -> bool {
    if let Model::Own(own) = model {
        return own.law().depends_on_rate();
    }
    let values = model.names().into_iter().zip(model.values());
    values.into_iter().any(|(name, value)| value != 0.0 && model.parameter_kind(&name) == Some(ParameterKind::Damping))
}

/// How a model misses the events of its own test.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OwnTestErrors {
    /// Dynamic crush of the model over that of the test, less 1; `None`: the model does not stop.
    pub crush: Option<f64>,
    /// Time of dynamic crush of the model over that of the test, less 1; `None`: the model does not stop.
    pub time: Option<f64>,
    /// Velocity of the model at the end of the compared window less that of the test, over the impact speed.
    pub velocity: Option<f64>,
    /// Restitution of the model, 0 without a rebound, less that of the test; `None`: the test shows none, or the model
    /// does not stop.
    pub restitution: Option<f64>,
}

impl OwnTestErrors {
    /// The largest error of each in several tests; `None` where one of the tests has none of crush or time.
    pub fn worst(each: &[Self]) -> Self {
        let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        let of_all = |of: fn(&Self) -> Option<f64>| -> Option<f64> {
            each.iter().map(of).collect::<Option<Vec<f64>>>()?.into_iter().reduce(larger)
        };
        Self {
            crush: of_all(|errors| errors.crush),
            time: of_all(|errors| errors.time),
            velocity: of_all(|errors| errors.velocity),
            restitution: each.iter().filter_map(|errors| errors.restitution).reduce(larger),
        }
    }
}

/// One candidate in the choice.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedCandidate {
    /// Its id.
    pub id: String,
    /// Name of its model.
    pub model: String,
    /// What takes the energy.
    pub class: EnergyClass,
    /// Free numbers.
    pub parameters: usize,
    /// Whether anybody says how well they are known.
    pub is_assessed: bool,
    /// Of these, what the record does not determine, in words.
    pub unidentified: Vec<String>,
    /// How many of the others it knows to an order of magnitude only.
    pub order_of_magnitude: usize,
    /// Of these, what would change the crush at other speeds if it were another, in words.
    pub affects_other_speeds: Vec<String>,
    /// Parameters on a bound of their search other than zero, in words.
    pub on_bound: Vec<String>,
    /// Whether no spring or damper is negative.
    pub physical: bool,
    /// Root mean square of model less record as measured, the quantity of the evidence; `None`: no response.
    pub misfit: Option<f64>,
    /// What the record says of it; `None`: the model has no response.
    pub evidence: Option<Evidence>,
    /// Displacement fit as measured, percent.
    pub fit_percent: Option<f64>,
    /// Of sensors on other masses the one that it follows worst: channel and displacement fit, percent.
    pub worst_sensor: Option<(String, f64)>,
    /// Coefficient of restitution of the model in the test; `None`: it does not come back.
    pub restitution: Option<f64>,
    /// Misfit of the wall's force, percent of its root mean square; `None`: the record has no such force.
    pub force_misfit_percent: Option<f64>,
    /// How it misses the events of the test, the largest error of each in several.
    pub own_test: OwnTestErrors,
    /// Of a plastic model, the largest relative error of the crush at lower speeds that the record itself shows.
    pub crush_error_at_lower_speeds: Option<f64>,
}

impl ComparedCandidate {
    /// How many of its numbers the record determines.
    pub fn determined(&self) -> usize {
        if self.is_assessed {
            self.parameters.saturating_sub(self.unidentified.len() + self.order_of_magnitude)
        } else {
            0
        }
    }

    /// `3 of 4 numbers determined, 1 with a wide interval`, as the report says it.
    pub fn determined_in_words(&self) -> String {
        if !self.is_assessed {
            return format!("{} numbers, not known how well", self.parameters);
        }
        let mut text = format!("{} of {} parameters determined", self.determined(), self.parameters);
        for (count, what) in [(self.order_of_magnitude, "with a wide interval"), (self.unidentified.len(), "open")] {
            if count > 0 {
                text.push_str(&format!(", {count} {what}"));
            }
        }
        text
    }
}

/// Share of the impact speed below which two velocities are not told apart: 5 % of 15 m/s are less than the drift of a
/// velocity.
const LEAST_RESTITUTION: f64 = 0.05;

/// The rules of the choice; every number can be changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelectionRules {
    /// What a model without plastic deformation is charged.
    pub plastic_prior: f64,
    /// What each free number is charged, beside what the evidence charges it for what it foretells.
    pub number_prior: f64,
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
    /// Two standard deviations of a measured wall force about a model, percent: half of the force that one mass misses
    /// is that of the masses in front, whatever its curve.
    pub force_limit_percent: f64,
    /// Standard deviation of the crush at lower speeds, beside what the record itself shows, percent: a rate effect
    /// that one speed does not show moves it by as much.
    pub lower_speed_limit_percent: f64,
}

impl Default for SelectionRules {
    fn default() -> Self {
        Self {
            plastic_prior: 10.0,
            number_prior: OF_A_NUMBER,
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
/// Name of the prior on free numbers.
const NUMBERS: &str = "numbers";
/// Name of the term for the crush at lower speeds that the record itself shows.
const LOWER_SPEEDS: &str = "lower speeds";
/// Name of the term for the force on the wall.
const WALL_FORCE: &str = "wall force";
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
        if self.number_prior > 0.0 {
            priors.push(Prior {
                name: NUMBERS,
                statement: format!("each free number is charged {:.2}", self.number_prior),
                source: "a number more halves the odds of a model: of models that the record does not tell apart the \
                         simpler one",
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
        if self.number_prior > 0.0 {
            terms.push((NUMBERS, self.number_prior * candidate.parameters as f64));
        }
        let of_record = [
            (LOWER_SPEEDS, candidate.crush_error_at_lower_speeds, self.lower_speed_limit_percent),
            (WALL_FORCE, candidate.force_misfit_percent.map(|misfit| 0.01 * misfit), 0.5 * self.force_limit_percent),
        ];
        terms.extend(of_record.into_iter().filter_map(|(name, error, deviation)| {
            Some((name, (error? / (0.01 * deviation)).powi(2))).filter(|_| deviation > 0.0)
        }));
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

/// An event of the test that a model repeats or misses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TestEvent {
    /// The dynamic crush.
    Crush,
    /// The time of dynamic crush.
    Time,
    /// The coefficient of restitution.
    Restitution,
}

impl TestEvent {
    /// Its name in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Crush => "dynamic_crush",
            Self::Time => "time_of_dynamic_crush",
            Self::Restitution => "coefficient_of_restitution",
        }
    }
}

/// A reason why a candidate is not adequate.
#[derive(Debug, Clone, PartialEq)]
pub enum Inadequacy {
    /// A spring or damper is negative.
    NotPassive,
    /// These parameters, in words, are on a bound of their search.
    OnBound(Vec<String>),
    /// It has no displacement to compare.
    NoDisplacement,
    /// Its displacement fit is too low, percent.
    DisplacementFit {
        /// The fit.
        percent: f64,
        /// The least fit that is adequate.
        limit: f64,
    },
    /// It has no response to compare.
    NoResponse,
    /// It has no dynamic crush: the mass does not stop.
    NeverStops,
    /// It misses an event of its own test: crush and time by a share, restitution by a difference.
    Misses {
        /// The event.
        event: TestEvent,
        /// Model beside test.
        error: f64,
        /// The largest error that is adequate.
        limit: f64,
    },
    /// It does not follow a sensor on another mass, which an adequate candidate follows.
    MissesSensor {
        /// Channel of the sensor.
        channel: String,
        /// Displacement fit there, percent.
        percent: f64,
        /// The least fit that is adequate.
        limit: f64,
    },
}

impl Inadequacy {
    /// Every reason against each candidate; none: it is adequate. A sensor on another mass speaks against those that do
    /// not follow it where another candidate does: it decides among models of more masses and of fewer.
    pub fn of_all(candidates: &[ComparedCandidate], rules: &SelectionRules) -> Vec<Vec<Self>> {
        let mut all: Vec<Vec<Self>> = candidates.iter().map(|candidate| Self::of(candidate, rules)).collect();
        let limit = rules.adequate_fit_percent;
        let misses = |candidate: &ComparedCandidate| {
            let (channel, percent) = candidate.worst_sensor.clone().filter(|(_, percent)| *percent < limit)?;
            Some(Self::MissesSensor { channel, percent, limit })
        };
        if all.iter().zip(candidates).any(|(reasons, candidate)| reasons.is_empty() && misses(candidate).is_none()) {
            all.iter_mut().zip(candidates).for_each(|(reasons, candidate)| reasons.extend(misses(candidate)));
        }
        all
    }

    fn of(candidate: &ComparedCandidate, rules: &SelectionRules) -> Vec<Self> {
        let mut reasons = Vec::new();
        if !candidate.physical {
            reasons.push(Self::NotPassive);
        }
        if !candidate.on_bound.is_empty() {
            reasons.push(Self::OnBound(candidate.on_bound.clone()));
        }
        let limit = rules.adequate_fit_percent;
        match candidate.fit_percent {
            None => reasons.push(Self::NoDisplacement),
            Some(percent) if percent < limit => reasons.push(Self::DisplacementFit { percent, limit }),
            Some(_) if candidate.evidence.is_none() => reasons.push(Self::NoResponse),
            Some(_) => {}
        }
        let own = &candidate.own_test;
        if own.crush.is_none() {
            reasons.push(Self::NeverStops);
        }
        // Where the velocity creeps to zero the time of crush is hardly defined: it is enough to be as slow by then.
        let time = own.time.filter(|_| own.velocity.is_none_or(|velocity| velocity.abs() > LEAST_RESTITUTION));
        let events = [
            (TestEvent::Crush, own.crush, 0.01 * rules.crush_limit_percent),
            (TestEvent::Restitution, own.restitution, rules.restitution_limit),
            (TestEvent::Time, time, 0.01 * rules.time_limit_percent),
        ];
        reasons.extend(events.into_iter().filter_map(|(event, error, limit)| {
            let error = error.filter(|error| error.abs() > limit)?;
            Some(Self::Misses { event, error, limit })
        }));
        reasons
    }

    /// Whether the dynamic crush of a candidate with this reason may be used nevertheless: it misses nothing but the
    /// time of the crush, the rebound, or the motion of another mass.
    pub fn leaves_the_crush(&self) -> bool {
        let is_event = matches!(self, Self::Misses { event: TestEvent::Time | TestEvent::Restitution, .. });
        is_event || matches!(self, Self::MissesSensor { .. })
    }
}

impl fmt::Display for Inadequacy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPassive => write!(f, "a spring or damper is negative"),
            Self::OnBound(names) => write!(f, "on a bound of its search: {}", names.join(", ")),
            Self::NoDisplacement => write!(f, "no displacement to compare"),
            Self::DisplacementFit { percent, limit } => {
                write!(f, "displacement fit of {percent:.1} % below {limit} %")
            }
            Self::NoResponse => write!(f, "no response to compare"),
            Self::NeverStops => write!(f, "the model never stops"),
            Self::MissesSensor { channel, percent, limit } => {
                write!(f, "follows the displacement of {channel} to {percent:.1} %, limit {limit} %")
            }
            Self::Misses { event: TestEvent::Restitution, error, limit } => {
                write!(f, "misses the restitution of its own test by {error:+.2}, limit {limit}")
            }
            Self::Misses { event, error, limit } => {
                let event = if *event == TestEvent::Crush { "dynamic crush" } else { "time of dynamic crush" };
                let (error, limit) = (100.0 * error, 100.0 * limit);
                write!(f, "misses the {event} of its own test by {error:+.1} %, limit {limit:.1} %")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_lumped::{Chain, Elastoplastic, Kelvin};

    #[test]
    fn a_class_is_that_of_the_model_and_of_its_dampers() {
        let class = |c: f64| {
            let kelvin = Kelvin { mass_kg: 1.0, stiffness_n_per_m: 2.0, damping_n_s_per_m: c };
            let chain = Chain::with_constants(&[1.0], &[2.0], &[c]).unwrap();
            let [kelvin, chain] = [Model::Kelvin(kelvin), Model::Chain(chain)].map(|model| EnergyClass::of(&model));
            assert_eq!(kelvin, chain);
            kelvin
        };
        assert_eq!((class(3.0), class(0.0)), (EnergyClass::Damped, EnergyClass::Elastic));
        let plastic = Elastoplastic {
            mass_kg: 1.0,
            loading_stiffness_n_per_m: 2.0,
            unloading_stiffness_n_per_m: 3.0,
            release: true,
        };
        assert_eq!(EnergyClass::of(&Model::Elastoplastic(plastic)), EnergyClass::Plastic);
    }
}
