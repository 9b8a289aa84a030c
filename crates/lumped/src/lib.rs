//! Lumped-parameter crash models and their exact responses.
//!
//! A model is a [`Structure`]: one or more masses joined by [`Element`]s, between any two nodes, that meets a rigid
//! barrier at `t = 0` with `x = 0` and `v = v0`. Displacement `x` is crush, positive towards the barrier, and `x'' = a`
//! is negative while the vehicle is stopped (SAE J211). Every response here is exact: a matrix exponential where all
//! forces are linear, else Taylor series from event to event, never a step-by-step integration with a step error. What
//! remains is rounding, about `1e-16` a step relative to the largest motion.
//!
//! The families are names for structures, with the names of their parameters; some have closed forms beside:
//!
//! - [`Kelvin`]: spring and damper in parallel.
//! - [`Elastoplastic`]: stiff unloading about a permanent set.
//! - [`Maxwell`]: spring and damper in series.
//! - [`Nonlinear1`], [`Nonlinear2`]: secant spring and damper with piecewise-linear coefficients.
//! - [`DoubleSpringMassDamper`]: chassis and passenger compartment, two of each.
//! - [`CrushedStructure`] and [`CrushedLoadPaths`]: one mass or two behind structures crushed along curves.
//! - [`OwnLaw`]: masses and elements whose forces are expressions that a person states.
//! - [`TripleSpringMassDamper`] and [`Chain`]: three and any number of masses, coefficients constant or piecewise
//!   linear.
//!
//! Contact stays closed in all of them (the mass is tied to the barrier) except where `release` is set. So a linear
//! model describes the loading phase of a crash; what it does after rebound is not a prediction.
//!
//! # What is taken for granted
//! Everything is SI. Masses are rigid and move along x alone; springs and dampers have no mass. Time counts from
//! contact. A force is positive in compression, a deflection too; in a row element i lies in front of mass i, so that
//! element 1 touches the barrier.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `x, v, a` | displacement (crush), velocity, acceleration | m, m/s, m/s² |
//! | `m, k, c` | mass, stiffness, damping | kg, N/m, N·s/m |
//! | `u, w` | compression of an element and its rate | m, m/s |
//! | `v0` | impact speed, positive | m/s |
//! | `t_m, C` | time of dynamic crush and dynamic crush, the first zero of `v` and `x` there | s, m |
//!
//! No result depends on the sampling interval. A motion that leaves the range of numbers is [`LumpedError::Diverges`]
//! with its time, never a NaN.
//!
//! ```
//! use crumple_lumped::Kelvin;
//!
//! let car = Kelvin { mass_kg: 1200.0, stiffness_n_per_m: 4e5, damping_n_s_per_m: 0.0 };
//! // Without a damper C = v0 sqrt(m/k).
//! assert!(car.events(14.0).dynamic_crush_m.is_some_and(|crush| (crush - 14.0 * 0.003_f64.sqrt()).abs() < 1e-12));
//! ```

mod error;
mod exact {
    //! Exact steps of linear equations of motion, their derivatives, and the search for the first zero on them.

    pub mod crossing;
    pub mod derivatives;
    pub mod linear_motion;
}
mod families {
    //! One file a family of models: what it is made of, its closed form where it has one, the names of its parameters.

    pub mod chain;
    pub mod law_text;
    pub mod load_paths;
    pub mod one_mass;
    pub mod own_law;
}
mod kind;
mod matching {
    //! Springs and dampers of the double model from poles or a state space: every solution, in double length.

    pub mod coefficient_matching;
    pub mod cubic;
    pub mod physical_coordinates;
}
mod model;
mod motion {
    //! What moves a model and what it answers: start, drive, motion, forces, energies, events, derivatives.

    pub mod collision;
    pub mod mass_motion;
}
mod response {
    //! What a structure answers: motions, derivatives, forces, energies, events; exactly or by series.

    pub mod collisions;
    pub mod element_paths;
    pub mod front_to_front;
    pub mod motions;
}
mod series {
    //! Motions of any structure by Taylor series from event to event, with their derivatives.

    pub mod changes;
    pub mod expression_series;
    pub mod step;
    pub mod walk;
}
mod structure {
    //! What a model is made of: masses, and elements between any two nodes.

    pub mod connected_masses;
    pub mod crush_curve;
    pub mod elements;
    pub mod expression;
    pub mod force_deflection;
    pub mod own_force;
    pub mod piecewise_linear;
}

pub use crumple_numerics::lti::Complex;
pub use error::LumpedError;
pub use families::chain::{Chain, TripleSpringMassDamper};
pub use families::law_text::LawMistake;
pub use families::load_paths::{CrushedLoadPaths, CrushedStructure, LoadPath};
pub use families::one_mass::{DoubleSpringMassDamper, Elastoplastic, Kelvin, Maxwell, Nonlinear1, Nonlinear2};
pub use families::own_law::{FreeNumber, LawMass, OwnLaw, OwnModel};
pub use kind::{LOAD_PATHS, MOST_KNOTS, MOST_KNOTS_OF_PATH, ModelKind, Parameter, ParameterKind};
pub use matching::coefficient_matching::{
    Certificate, CoefficientMatch, CoefficientMatching, MatchRoot, MatchedSolution, Reading, matching_sensitivity,
};
pub use matching::physical_coordinates::{PhysicalCoordinates, RealisedModel};
pub use model::{Model, parameter_kind, parameter_kind_of_unit, structure_of};
pub use motion::collision::{
    Collision, Dynamics, ElementEnergy, ElementEvent, ElementForce, ElementState, Energy, Extremum, Meeting,
    MeetingState, Moment, Turn,
};
pub use motion::mass_motion::{
    Asked, CrashPulse, CrushEvents, Drive, HORIZON_S, Instants, Motion, Response, Sensitivity, Start, State, Waves,
};
pub use response::collisions::{CollisionQuestions, Occupant, OccupantMotion, OccupantStop};
pub use response::element_paths::{Leg, PathPoint, lead};
pub use response::front_to_front::{CONTACT_SHARE, FrontToFront};
pub use series::walk::steps_taken;
pub use structure::connected_masses::{Connection, Element, Node, Place, Structure};
pub use structure::crush_curve::{Extrapolation, InSeries};
pub use structure::elements::{Damper, PlasticSpring, SeriesSpringDamper, Spring};
pub use structure::force_deflection::{ForceDeflection, ForceDeflectionParameter};
pub use structure::own_force::OwnForce;
pub use structure::piecewise_linear::PiecewiseLinear;
