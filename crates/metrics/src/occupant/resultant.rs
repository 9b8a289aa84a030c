//! The resultant of up to three axes.

use crumple_signal::{Acceleration, Signal};

use crate::MetricsError;
use crate::metric::grid::same_grid;

/// Resultant of components at one place, sample by sample: `sqrt(x² + y² + z²)`.
///
/// Formed after filtering (SAE J211-1: filtering comes before every non-linear operation). Of fewer than three axes it
/// is nowhere above the resultant of all three, and neither is what grows with it (HIC, 3 ms clip). Errors: no
/// component, components on different grids.
pub fn resultant(components: &[&Signal<Acceleration>]) -> Result<Signal<Acceleration>, MetricsError> {
    let Some((first, others)) = components.split_first() else { return Err(MetricsError::Empty) };
    for other in others {
        same_grid(("one component", first), ("another", other))?;
    }
    let length = |k: usize| components.iter().fold(0.0_f64, |length, a| length.hypot(a.samples()[k]));
    Ok(first.with_samples((0..first.len()).map(length).collect())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_components_make_a_length_and_one_its_magnitude() {
        let signal = |level: f64| Signal::new(0.0, 0.5, vec![0.0, level]).unwrap();
        let length = resultant(&[&signal(2.0), &signal(-3.0), &signal(6.0)]).unwrap();
        // 7 in whole numbers, a unit in the last place of each root.
        assert!((length.samples()[1] - 7.0).abs() < 1e-14, "{length:?}");
        assert_eq!(resultant(&[&signal(-3.0)]).unwrap().samples(), [0.0, 3.0]);
        assert!(resultant(&[]).is_err());
        assert!(resultant(&[&signal(1.0), &Signal::new(0.1, 0.5, vec![0.0, 1.0]).unwrap()]).is_err());
    }
}
