//! Whether two signals can be compared sample by sample.

use crumple_signal::Sampled;

use crate::error::MetricsError;

/// Refuses two signals that are not sampled at the same times.
pub(crate) fn same_grid(
    (first, a): (&'static str, &Sampled),
    (second, b): (&'static str, &Sampled),
) -> Result<(), MetricsError> {
    if a.is_empty() {
        return Err(MetricsError::Empty);
    }
    if a.len() != b.len() || a.t0_s() != b.t0_s() || a.dt_s() != b.dt_s() {
        return Err(MetricsError::Grids {
            first,
            first_len: a.len(),
            first_t0_s: a.t0_s(),
            second,
            second_len: b.len(),
            second_t0_s: b.t0_s(),
        });
    }
    Ok(())
}

/// Refuses what cannot be rated: grids that differ, a reference of zeros.
pub(crate) fn rated_grid(reference: &Sampled, comparison: &Sampled) -> Result<(), MetricsError> {
    same_grid(("the reference", reference), ("the comparison", comparison))?;
    if reference.samples().iter().all(|x| *x == 0.0) {
        return Err(MetricsError::ZeroReference);
    }
    Ok(())
}
