//! Which of the candidates to use: what each brings into the choice, and the record of it.

pub mod compared_candidates;
pub mod felt;
pub mod recommendation;
