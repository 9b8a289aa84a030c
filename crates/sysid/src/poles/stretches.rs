//! Parts of a long record that are searched in its place.

use crate::{IdentifyError, IoData, thinned};

/// Records of more than so many stretches get [`SEVERAL`] of them.
const LONG: usize = 10;

/// Stretches of a record that long.
const SEVERAL: usize = 3;

/// First samples of the stretches of `length` in which the inputs have the largest power, largest first and none over
/// another, with their samples; last, from 0, the whole record filtered and thinned to as many, for slow modes.
///
/// Power is the sum over inputs of the mean square about the mean, each input in units of its own root mean square.
pub(crate) fn stretches(data: &IoData, length: usize) -> Result<Vec<(usize, IoData)>, IdentifyError> {
    let samples = data.samples();
    let scales = data.input_scales();
    let power = |first: usize| -> f64 {
        let of = |(u, scale): (&Vec<f64>, &f64)| {
            let part = &u[first..first + length];
            let mean = part.iter().sum::<f64>() / length as f64;
            part.iter().map(|x| ((x - mean) / scale).powi(2)).sum::<f64>()
        };
        data.inputs().iter().zip(&scales).map(of).sum()
    };
    let mut ranked: Vec<(f64, usize)> =
        (0..=samples - length).step_by(length / 4).map(|first| (power(first), first)).collect();
    // Stable: of equals the first.
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let count = if samples > LONG * length { SEVERAL } else { 1 };
    let mut taken: Vec<usize> = Vec::new();
    for (_, first) in ranked {
        if taken.len() < count && taken.iter().all(|other| first.abs_diff(*other) >= length) {
            taken.push(first);
        }
    }
    let mut all = Vec::with_capacity(taken.len() + 1);
    for first in taken {
        all.push((first, data.slice(first, first + length)?));
    }
    all.push((0, thinned(data, samples.div_ceil(length))?));
    Ok(all)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::random::uniform_at;

    #[test]
    fn stretches_are_where_the_input_moves_and_the_whole_comes_thinned() {
        let loud = |k: usize| if (520..640).contains(&k) { 5.0 } else { 1.0 };
        let u: Vec<f64> = (0..2000).map(|k| loud(k) * (uniform_at(1, k) - 0.5)).collect();
        let data = IoData::single(u.clone(), u, 0.1).unwrap();
        let all = stretches(&data, 100).unwrap();
        assert_eq!(all.len(), 4);
        assert!((500..=550).contains(&all[0].0) && all[..3].iter().all(|(_, part)| part.samples() == 100));
        let (first, thin) = &all[3];
        assert!(*first == 0 && thin.samples() <= 100 && (thin.sample_time_s() - 2.0).abs() < 1e-12);
        assert_eq!(stretches(&data, 1000).unwrap().len(), 2);
    }
}
