//! The zero level before the event.

use crumple_signal::{PreEvent, PreEventWindow, Sampled};
use serde::Serialize;

use crate::FilterError;

/// What is done about the zero level of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ZeroLevel {
    /// The samples stay as they are.
    None,
    /// The mean of the pre-event samples is subtracted.
    PreEvent(PreEventWindow),
    /// Of an acceleration in free fall before the event its level at rest, which is subtracted
    /// ([`free_fall`](crumple_signal::free_fall)).
    AtRest(f64),
}

impl Default for ZeroLevel {
    fn default() -> Self {
        Self::PreEvent(PreEventWindow::default())
    }
}

/// Mean and standard deviation of the samples before the event, by [`crumple_signal::pre_event`]; a window that ends
/// before it starts is an error here. `Ok(None)`: the record covers less than 10 ms of the window.
///
/// A zero level that is wrong by δ adds δ·t to the velocity and δ·t²/2 to the displacement: 0.1 g over 100 ms is
/// 0.098 m/s and 4.9 mm. The mean itself is wrong by about the noise floor over the root of the number of samples.
pub fn pre_event(samples: &Sampled, window: PreEventWindow) -> Result<Option<PreEvent>, FilterError> {
    let PreEventWindow { from_s, to_s } = window;
    if to_s < from_s {
        return Err(FilterError::Window { from_s, to_s });
    }
    Ok(crumple_signal::pre_event(samples, window))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_a_window_that_ends_before_it_starts() {
        let samples = Sampled::new(-0.06, 1e-3, vec![0.0; 200]).unwrap();
        let error = pre_event(&samples, PreEventWindow { from_s: -0.01, to_s: -0.05 }).unwrap_err();
        assert_eq!(error.to_string(), "the zero level window ends at -0.05 s, before it starts at -0.01 s");
    }
}
