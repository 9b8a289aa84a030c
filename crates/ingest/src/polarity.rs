//! Polarity of the pulse: a frontal impact decelerates, so SAE J211 has it negative. Reported, flipped only if asked.

use crumple_signal::{Axis, Notes, QuantityKind, Sampled, SignalError};

use crate::recording::Found;

/// How long after time zero the pulse is looked at, s.
const WINDOW_S: f64 = 0.150;
/// Change of velocity that counts where the impact speed is not known, m/s.
const CLEAR_CHANGE_M_PER_S: f64 = 0.25;
/// The same as a part of the impact speed.
const CLEAR_PART: f64 = 0.05;

/// Warns if the pulse, zero level removed, gains speed over the first 150 ms.
pub fn check(pulse: &Sampled, zero_level: Option<f64>, impact_speed_m_per_s: Option<f64>, notes: &mut Notes) {
    let zero = zero_level.unwrap_or(0.0);
    let (from, to) = (pulse.index_at_or_after(0.0), pulse.index_at_or_after(WINDOW_S));
    let change: f64 = pulse.samples()[from..to.max(from)].iter().map(|a| (a - zero) * pulse.dt_s()).sum();
    let clear = impact_speed_m_per_s.map_or(CLEAR_CHANGE_M_PER_S, |v| CLEAR_PART * v);
    if change > clear {
        notes.warning(format!(
            "the pulse is positive (it gains {change:.2} m/s in the first {:.0} ms), a frontal impact is negative by SAE J211: \
             if deceleration is positive in this file, use --sign flip",
            (pulse.end_s().min(WINDOW_S)) * 1e3
        ));
    }
}

/// Turns the sign of every acceleration along x, or along an axis that is not stated, and of its initial velocity. Returns how
/// many channels that are.
pub fn flip(channels: &mut [Found]) -> Result<usize, SignalError> {
    let mut flipped = 0;
    for Found { channel, wave, .. } in channels {
        if channel.quantity != QuantityKind::Acceleration || !matches!(channel.axis, None | Some(Axis::X)) {
            continue;
        }
        if let Some(sampled) = wave.take() {
            let (t0_s, dt_s) = (sampled.t0_s(), sampled.dt_s());
            let samples = sampled.into_samples().into_iter().map(|a| -a).collect();
            *wave = Some(Sampled::new(t0_s, dt_s, samples)?);
            channel.initial_velocity_m_per_s = channel.initial_velocity_m_per_s.map(|v| -v);
            flipped += 1;
        }
    }
    Ok(flipped)
}
