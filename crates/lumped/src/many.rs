//! Many parameter sets of the double model at once.

use crate::exact::exact_step::exact_step;
use crate::{DoubleSpringMassDamper, LumpedError};

/// Sets that are worked on side by side.
const LANES: usize = 8;
/// Samples kept in the lanes' order before they go to their rows.
const BLOCK: usize = 64;

/// Displacement of the compartment after an impact for many parameter sets, row after row into `out`: sample `k` of set `i`, at
/// `k dt`, is `out[i * samples + k]`.
///
/// The same exact steps as [`Model::respond`](crate::Model::respond), to rounding, eight sets side by side: one set is a chain of
/// products that each wait for the one before, eight keep the processor busy. A set that leaves the range of numbers
/// leaves infinities or NaN in its own row, for the caller to see. Errors: parameters without meaning, `out` of another
/// length than sets times samples.
pub fn compartment_displacements(
    models: &[DoubleSpringMassDamper],
    impact_speed_m_per_s: f64,
    dt_s: f64,
    samples: usize,
    out: &mut [f64],
) -> Result<(), LumpedError> {
    if out.len() != models.len() * samples {
        return Err(LumpedError::Value {
            name: "length of the result",
            value: out.len() as f64,
            expected: "parameter sets times samples",
        });
    }
    for model in models {
        model.check()?;
    }
    if samples == 0 {
        return Ok(());
    }
    for (sets, rows) in models.chunks(LANES).zip(out.chunks_mut(LANES * samples)) {
        let mut phi = [[0.0; LANES]; 16];
        for (lane, model) in sets.iter().enumerate() {
            let step = exact_step(&model.state_matrix(), dt_s);
            for (i, entry) in phi.iter_mut().enumerate() {
                entry[lane] = step[(i / 4, i % 4)];
            }
        }
        let mut z = [[0.0; LANES], [0.0; LANES], [impact_speed_m_per_s; LANES], [impact_speed_m_per_s; LANES]];
        let mut kept = [[0.0; LANES]; BLOCK];
        let mut from = 0;
        while from < samples {
            let count = BLOCK.min(samples - from);
            for instant in &mut kept[..count] {
                *instant = z[1];
                z = std::array::from_fn(|i| {
                    std::array::from_fn(|l| {
                        (phi[4 * i][l] * z[0][l] + phi[4 * i + 1][l] * z[1][l])
                            + (phi[4 * i + 2][l] * z[2][l] + phi[4 * i + 3][l] * z[3][l])
                    })
                });
            }
            for (lane, row) in rows.chunks_mut(samples).enumerate() {
                for (x, instant) in row[from..from + count].iter_mut().zip(&kept) {
                    *x = instant[lane];
                }
            }
            from += count;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Model;

    #[test]
    fn every_row_is_the_response_of_its_set() {
        let set = |i: usize| DoubleSpringMassDamper {
            m1_kg: 291.0,
            m2_kg: 582.0,
            k1_n_per_m: 2e5 + 1e4 * i as f64,
            k2_n_per_m: 4e5,
            c1_n_s_per_m: 4e3,
            c2_n_s_per_m: 9e3 - 300.0 * i as f64,
        };
        // Neither a multiple of the lanes nor of the block.
        let models: Vec<_> = (0..11).map(set).collect();
        let mut out = vec![0.0; 11 * 131];
        compartment_displacements(&models, 12.0, 1e-3, 131, &mut out).unwrap();
        for (model, row) in models.iter().zip(out.chunks(131)) {
            let wanted = Model::DoubleSpringMassDamper(*model).respond(12.0, 1e-3, 131).unwrap();
            // The same products in the same order.
            assert_eq!(row, wanted.compartment().displacement_m);
        }
        assert!(compartment_displacements(&models, 12.0, 1e-3, 130, &mut out).is_err());
        assert!(compartment_displacements(&[], 12.0, 1e-3, 130, &mut []).is_ok());
    }
}
