//! Depth and time of crush that a fit of one mass is scaled by.

use crumple_signal::Notes;

use crate::solvers::task::Task;

/// Depth and time by which a fit to the displacement of one mass is scaled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    /// Dynamic crush, m; without one the largest displacement of the window.
    pub crush_m: f64,
    /// Its time, s after time zero; without one the end of the window.
    pub time_s: f64,
    /// Whether the mass stops there.
    pub stops: bool,
}

/// Dynamic crush and its time.
///
/// Where the velocity never reaches zero: the end of the window (that of the settings, or of the record) and the
/// largest displacement up to there, with a warning. `None`, with a warning, without a displacement or where it is
/// nowhere positive.
pub(super) fn extent_of(task: &Task<'_>, notes: &mut Notes) -> Option<Extent> {
    let (kind, test) = (task.model, task.test);
    if let Some((time_s, crush_m)) = test.time_of_dynamic_crush_s.zip(test.dynamic_crush_m) {
        return Some(Extent { crush_m, time_s, stops: true });
    }
    let Some(displacement) = test.displacement else {
        notes.warning(format!("{kind}: not fitted, there is no displacement"));
        return None;
    };
    let end_s = displacement.end_s() - test.time_zero_s;
    let time_s = task.settings.fit_to_s.unwrap_or(end_s);
    let first = displacement.index_at_or_after(test.time_zero_s);
    let after = displacement.index_at_or_after(test.time_zero_s + time_s + 0.5 * displacement.dt_s());
    let window = displacement.samples().get(first..after.min(displacement.len())).unwrap_or_default();
    let crush_m = window.iter().copied().fold(0.0, f64::max);
    if crush_m <= 0.0 || time_s <= 0.0 {
        notes.warning(format!("{kind}: not fitted, the displacement is nowhere positive after time zero"));
        return None;
    }
    notes.warning(format!(
        "{kind}: the velocity of the record never reaches zero: fitted up to {:.2} ms, the end of the window, with the \
         largest displacement {:.1} mm in place of the dynamic crush",
        1e3 * time_s,
        1e3 * crush_m
    ));
    Some(Extent { crush_m, time_s, stops: false })
}

/// Time, s after time zero, and depth, m, of dynamic crush; `None`, with a warning, where the record has none.
pub(super) fn crush_of(task: &Task<'_>, notes: &mut Notes) -> Option<(f64, f64)> {
    let events = task.test.time_of_dynamic_crush_s.zip(task.test.dynamic_crush_m);
    if events.is_none() {
        notes.warning(format!(
            "{}: not solved, since the velocity of the record never reaches zero: it has no dynamic crush, which {} \
             starts from; direct-fit does without",
            task.model, task.method
        ));
    }
    events
}
