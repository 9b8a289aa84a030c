//! Markov parameters: what a system answers to a unit impulse.

use crumple_linalg::dot;
use crumple_lti::StateSpace;

use crate::EraError;
use crate::data::contiguous::{columns_of, rows_of};

/// Markov parameters of a system, one sequence for every pair of an output and an input, all of one length.
///
/// Sample 0 of a sequence is the direct term `D`, sample `k` is `C A^(k-1) B`. Records of one free decay on several
/// sensors are those of one input.
#[derive(Debug, Clone, PartialEq)]
pub struct MarkovParameters<'a> {
    sequences: Vec<&'a [f64]>,
    inputs: usize,
}

impl<'a> MarkovParameters<'a> {
    /// `sequences[i * inputs + j]` is what output `i` answers to input `j`.
    /// Errors: no sequence, a number that `inputs` does not divide, other lengths, a sample that is not finite.
    pub fn new(sequences: Vec<&'a [f64]>, inputs: usize) -> Result<Self, EraError> {
        if inputs == 0 || sequences.is_empty() || !sequences.len().is_multiple_of(inputs) {
            return Err(EraError::Sequences { sequences: sequences.len(), inputs });
        }
        let samples = sequences[0].len();
        for (number, sequence) in sequences.iter().enumerate() {
            if sequence.len() != samples {
                return Err(EraError::Lengths { number, found: sequence.len(), expected: samples });
            }
            if let Some(index) = sequence.iter().position(|y| !y.is_finite()) {
                return Err(EraError::NotFinite { index });
            }
        }
        Ok(Self { sequences, inputs })
    }

    /// Number of outputs, `q`.
    pub fn outputs(&self) -> usize {
        self.sequences.len() / self.inputs
    }

    /// Number of inputs, `m`.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Samples of each sequence, the direct term included.
    pub fn samples(&self) -> usize {
        self.sequences[0].len()
    }

    /// What output `i` answers to input `j`.
    pub fn sequence(&self, i: usize, j: usize) -> &'a [f64] {
        self.sequences[i * self.inputs + j]
    }

    /// All sequences, in the order of [`MarkovParameters::new`].
    pub fn sequences(&self) -> &[&'a [f64]] {
        &self.sequences
    }
}

/// Markov parameters of a discrete model, in the order of [`MarkovParameters::new`]. Those of an unstable model may
/// overflow, which the caller has to check.
///
/// `samples` values each: `D`, `C B`, `C A B`, ... for every pair of an output and an input.
pub fn markov_parameters(model: &StateSpace, samples: usize) -> Vec<Vec<f64>> {
    let (a, c) = (rows_of(&model.a), rows_of(&model.c));
    let m = model.b.ncols();
    let mut sequences = vec![Vec::with_capacity(samples); c.len() * m];
    for (j, b) in columns_of(&model.b).into_iter().enumerate() {
        let mut x = b;
        let mut next = vec![0.0; x.len()];
        for k in 0..samples {
            for (i, c) in c.iter().enumerate() {
                sequences[i * m + j].push(if k == 0 { model.d[(i, j)] } else { dot(c, &x) });
            }
            if k > 0 {
                for (next, a) in next.iter_mut().zip(&a) {
                    *next = dot(a, &x);
                }
                std::mem::swap(&mut x, &mut next);
            }
        }
    }
    sequences
}
