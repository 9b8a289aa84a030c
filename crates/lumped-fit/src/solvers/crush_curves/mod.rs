//! Structures that are crushed along force-deflection curves, read off the record: of one mass and of two.

pub mod assumptions;
pub mod load_paths;
pub mod one_mass;
