//! Which of the candidates to use: what each brings into the choice, and the record of it.
//! May use `inputs` and `options`.

pub mod compared_candidates;
pub mod felt;
pub mod recommendation;
