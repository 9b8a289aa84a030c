//! Which options differ from those of the run before.

use crumple_stage::{Pipeline, say};

/// Says of each option that differs what it is and what it was.
pub(crate) fn say_what_changed(now: &Pipeline, before: &Pipeline) {
    for (name, old, new) in now.changes_since(before) {
        let is = |value: Option<String>| value.unwrap_or_else(|| "not given".to_owned());
        say(format_args!("{:<16} {name} is {}, was {} in the run before", "run", is(new), is(old)));
    }
}
