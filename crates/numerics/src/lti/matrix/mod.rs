//! Functions of small real matrices: eigenvalues and eigenvectors, exponential, logarithm, polynomial roots.

pub mod checks;
pub mod complex;
pub mod eigen;
pub mod exponential;
pub mod logarithm;
pub mod roots;
