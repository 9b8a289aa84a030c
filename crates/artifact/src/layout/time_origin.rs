//! MCAP log times are unsigned nanoseconds; crash records start before time zero.
//!
//! `log_time = origin + t`. The origin is 1000 s, so that all artifacts of a run stand on one time line in a viewer; a
//! record that starts earlier than that before time zero has a larger one, in steps of 1000 s. It stands in the
//! `content` metadata as `time.t0_offset_ns`.

/// The origin, and its steps: longer than records run before time zero.
const STEP_NS: i64 = 1_000_000_000_000;

/// The farthest time that 64 bits of nanoseconds hold, s.
pub(crate) const FARTHEST_S: f64 = 9.2e9;

/// Nanoseconds of a time, rounded; saturating (±292 years).
pub(crate) fn to_ns(t_s: f64) -> i64 {
    (t_s * 1e9).round() as i64
}

/// The origin for a record whose earliest time is `earliest_ns`.
pub(crate) fn origin_ns(earliest_ns: i64) -> i64 {
    let before_zero = earliest_ns.saturating_neg().max(1);
    (before_zero.saturating_add(STEP_NS - 1) / STEP_NS).saturating_mul(STEP_NS)
}

/// Log time of a record time.
pub(crate) fn log_time(origin_ns: i64, t_ns: i64) -> u64 {
    u64::try_from(origin_ns.saturating_add(t_ns)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_log_time_is_negative_and_records_of_one_run_share_the_origin() {
        for earliest in [0, -1, -20_000_000, -STEP_NS, 5] {
            assert_eq!(origin_ns(earliest), STEP_NS);
        }
        for earliest in [-STEP_NS - 1, -5 * STEP_NS / 2, to_ns(-FARTHEST_S)] {
            let origin = origin_ns(earliest);
            assert_eq!(origin % STEP_NS, 0);
            assert!(origin + earliest >= 0);
        }
    }
}
