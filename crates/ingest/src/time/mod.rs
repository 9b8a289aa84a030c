//! Time of samples: units, stamps of clocks, grids, resampling, time zero.

mod grid;
mod resampling;
mod samples;
mod stamps;
mod unit;

use crumple_signal::{Sampled, SignalError};

pub use grid::{Grid, GridError, STEP_TOLERANCE, fit, median_step};
pub use resampling::{LinearInterpolation, OnGrid, on_grid};
pub use samples::{CALENDAR_S, Kind, LabelUnit, REMARKS as SAMPLE_REMARKS, Timed, Times};
pub use stamps::{Instant, instant, over_midnight, stamp, time_of_day};
pub use unit::{REMARKS as UNIT_REMARKS, stated_unit};

/// The same samples with the file's time `zero_s` as t = 0.
pub fn shift(wave: &Sampled, zero_s: f64) -> Result<Sampled, SignalError> {
    // To the picosecond, so that 0.02 - 0.012 is 0.008.
    wave.starting_at(((wave.t0_s() - zero_s) * 1e12).round() / 1e12)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shift_keeps_round_times() {
        let wave = Sampled::new(0.02, 1e-4, vec![0.0; 10]).unwrap();
        assert_eq!(shift(&wave, 0.012).unwrap().t0_s(), 0.008);
    }
}
