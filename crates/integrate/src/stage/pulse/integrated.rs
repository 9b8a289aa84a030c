//! The motion of one channel and everything read off it.

use crumple_metrics::{CrashEvents, Interval, Metric};
use crumple_signal::{Drift, Motion};

/// A channel that was integrated.
pub struct Integrated {
    pub motion: Motion,
    pub events: CrashEvents,
    pub metrics: Vec<Metric>,
    pub drift: Option<Drift>,
    /// Of the events, in the order of [`EVENT_NAMES`](crumple_integrate::EVENT_NAMES); empty if nothing is uncertain.
    pub event_intervals: Vec<Option<Interval>>,
    /// Why an event has none, in the same order.
    pub events_without: Vec<Option<String>>,
    /// Why a metric has none, in the order of the metrics.
    pub metrics_without: Vec<Option<String>>,
}
