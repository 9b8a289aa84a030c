//! Predicts impacts that were not made with the models of a test that was.
//!
//! A [`Candidate`] is a structure whose parameters one test gave. [`predict`] lets it meet the wall, another vehicle or
//! a moving barrier ([`Partner`]) at other speeds and with other masses and says what comes out ([`Outcome`]), how sure
//! that is, and whether the model is asked beyond what was tested. Added mass goes to the rearmost mass, the
//! compartment; springs and dampers stay. An occupant rides in the compartment and does not push back on it.
//!
//! Intervals hold what is known: the parameters' covariance as measured, the inputs, what adequate models differ by,
//! a rate effect that one test hardly shows, and the force beyond the tested crush. They do not hold what no model of
//! this test can know: a part that was not reached, another failure mode, another overlap.
//!
//! Quantities are SI; displacement is crush, positive towards the barrier.

mod error;
mod impact {
    //! One impact of one candidate: its structure with the mass asked for, the wall or a partner, an occupant, what
    //! comes out, how far it reaches.

    pub mod candidate;
    pub mod made_test;
    pub mod outcome;
    pub mod partner;
    pub mod restraint;
}
mod intervals {
    //! How sure a prediction is: directions of the parameters, the other models, everything else that is not known.

    pub mod prediction;
    pub mod sources;
    pub mod tested;
}
mod plan;
mod predict;
mod stage;

pub use error::PredictError;
pub use impact::candidate::{Candidate, ImpactSetup, ParameterSpread, Partner, Scenario, TestedImpact};
pub use impact::made_test::MadeTest;
pub use impact::outcome::{Energy, Outcome, Quantity, Reach, Wave};
pub use impact::partner::{BodyOutcome, CollisionOutcome};
pub use impact::restraint::{Fitted, FittedRestraint, MeasuredRide};
pub use intervals::prediction::{Prediction, Support};
pub use intervals::sources::{HALF_WIDTH, INTERVAL_LEVEL, Inputs, Interval};
pub use intervals::tested::Directions;
pub use plan::{SecondTest, expected_widths};
pub use predict::predict;

/// The program.
pub const PROGRAM: crumple_stage::Program = crumple_stage::Program::of_stage::<stage::Predict>();

/// `crumple plan`: which second test would make a prediction surer.
pub const PLAN: crumple_stage::Program =
    crumple_stage::Program::of_tool::<stage::PlanOptions>("plan", |call| crumple_stage::run_tool(call, stage::plan));
