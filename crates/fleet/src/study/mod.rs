//! What a fleet says of vehicles: one model for the tests of each, how stiffness and damping depend on mass, year and
//! class, and how far each test is predicted from the others.

pub mod classes;
pub mod left_out;
pub mod options;
pub mod regression;
pub mod report;
pub mod together;
pub mod vehicle_models;
pub mod vehicles;
