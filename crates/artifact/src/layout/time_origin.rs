//! MCAP log times are unsigned nanoseconds; crash records start before time zero.
//!
//! `log_time = origin + t`, where the origin is a whole number of seconds, a function of the data alone, large enough
//! that no log time is negative. It stands in the `content` metadata as `time.t0_offset_ns`.

const SECOND_NS: i64 = 1_000_000_000;

/// Nanoseconds of a time, rounded; saturating (±292 years).
pub(crate) fn to_ns(t_s: f64) -> i64 {
    (t_s * 1e9).round() as i64
}

/// The origin for a record whose earliest time is `earliest_ns`.
pub(crate) fn origin_ns(earliest_ns: i64) -> i64 {
    let seconds = earliest_ns.saturating_neg().max(0) / SECOND_NS + i64::from(earliest_ns < 0);
    seconds.saturating_mul(SECOND_NS)
}

/// Log time of a record time.
pub(crate) fn log_time(origin_ns: i64, t_ns: i64) -> u64 {
    u64::try_from(origin_ns.saturating_add(t_ns)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_log_time_is_negative_and_the_origin_is_whole_seconds() {
        for earliest in [0, -1, -20_000_000, -1_000_000_000, 5] {
            let origin = origin_ns(earliest);
            assert_eq!(origin % SECOND_NS, 0);
            assert!(origin + earliest >= 0);
        }
        assert_eq!(origin_ns(-20_000_000), SECOND_NS);
        assert_eq!(origin_ns(0), 0);
    }
}
