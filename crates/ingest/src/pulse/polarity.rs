//! Polarity of the pulse: a frontal impact decelerates, so SAE J211 has it negative. Reported, flipped only if asked.

use crumple_metrics::{Exchange, Plausibility};
use crumple_signal::{About, Axis, Notes, PreEventWindow, QuantityKind, Sampled, SignalError, Weight, pre_event};

use crate::recording::read_channel::ReadChannel;

/// How long after time zero the pulse is looked at, s.
const WINDOW_S: f64 = 0.150;
/// Change of velocity that counts where the impact speed is not known, m/s.
const CLEAR_CHANGE_M_PER_S: f64 = 0.25;
/// The same as a part of the impact speed.
const CLEAR_PART: f64 = 0.05;

/// Gain of speed over impact speed that only a pulse of the wrong sign shows: a frontal impact loses 1.0 to 1.35 times
/// the impact speed, and a record may end early.
const CERTAIN: std::ops::RangeInclusive<f64> = 0.6..=1.6;

/// Gain of speed over impact speed above which no sign makes an impact of it: a perfect rebound loses twice the impact
/// speed, and a tenth is left to gain and impact speed. A larger gain suggests a wrong unit.
const IMPOSSIBLE: f64 = 2.2;

/// Whether the sign of the pulse is certainly wrong, and the note of `--sign auto` about it.
pub fn certainly_wrong(pulse: Option<&Sampled>, impact_speed_m_per_s: Option<f64>) -> (bool, String) {
    let (Some(pulse), Some(speed)) = (pulse, impact_speed_m_per_s.filter(|speed| *speed > 0.0)) else {
        return (false, "sign kept: without a pulse and its impact speed its polarity is not certain".to_owned());
    };
    let zero = pre_event(pulse, PreEventWindow::default()).map_or(0.0, |before| before.zero_level);
    let ratio = change(pulse, zero) / speed;
    let gains = format!(
        "over the first {:.0} ms the pulse changes the speed by {ratio:+.2} times the impact speed",
        1e3 * pulse.end_s().min(WINDOW_S)
    );
    if CERTAIN.contains(&ratio) {
        (true, format!("sign turned by --sign auto: {gains}, where a frontal impact loses speed"))
    } else if ratio <= 0.0 {
        (false, format!("sign kept: {gains}"))
    } else {
        (false, format!("sign kept, since its polarity is not certain: {gains}"))
    }
}

/// Change of velocity over the first 150 ms, m/s.
fn change(pulse: &Sampled, zero: f64) -> f64 {
    let (from, to) = (pulse.index_at_or_after(0.0), pulse.index_at_or_after(WINDOW_S));
    pulse.samples()[from..to.max(from)].iter().map(|a| (a - zero) * pulse.dt_s()).sum()
}

/// Whether the pulse pushes the vehicle forward over the first 150 ms, as a sled does or a hit from behind.
pub fn pushes_forward(pulse: &Sampled, zero_level: Option<f64>) -> bool {
    change(pulse, zero_level.unwrap_or(0.0)) > CLEAR_CHANGE_M_PER_S
}

/// What was done about the sign of the pulse before it is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Polarity {
    /// It is as in the file.
    AsRead,
    /// It was turned.
    Turned,
    /// It is as in the file, and asked about: it fits the impact speed with the other sign.
    Questioned,
    /// The pulse is that of an occupant; its criteria are of magnitudes, so that the sign does not matter.
    OfOccupant,
}

impl Polarity {
    /// The same, or [`Questioned`](Self::Questioned) where the other sign is asked about.
    pub fn unless_asked(self, plausibility: Option<&Plausibility>) -> Self {
        match plausibility {
            Some(Plausibility::After(Exchange::Polarity, _)) => Self::Questioned,
            _ => self,
        }
    }
}

/// Warns if the pulse, zero level removed, gains speed over the first 150 ms, with what helps: turning it only where it
/// was not turned and where what it then loses is that of an impact.
pub fn check(
    pulse: &Sampled,
    zero_level: Option<f64>,
    impact_speed_m_per_s: Option<f64>,
    polarity: Polarity,
    notes: &mut Notes,
) {
    let change = change(pulse, zero_level.unwrap_or(0.0));
    let clear = impact_speed_m_per_s.map_or(CLEAR_CHANGE_M_PER_S, |v| CLEAR_PART * v);
    // A vehicle that stands is pushed either way.
    let is_silent = matches!(polarity, Polarity::OfOccupant | Polarity::Questioned);
    if change <= clear || is_silent || impact_speed_m_per_s == Some(0.0) {
        return;
    }
    let ratio = impact_speed_m_per_s.filter(|v| *v > 0.0).map(|v| change / v);
    let way_out = match (polarity, ratio) {
        (Polarity::Turned, _) => "--sign has turned it: leave --sign out".to_owned(),
        (_, Some(ratio)) if ratio > IMPOSSIBLE => {
            format!(
                "{ratio:.1} times the impact speed is too large for an impact of either sign: check the unit (--unit) \
                 and the \
                impact speed first"
            )
        }
        (_, None) => "if this is a frontal impact with deceleration positive, use --sign flip; a motion from rest (a \
                      sled, a hit from behind), a shock or a drop may be positive and needs no flag"
            .to_owned(),
        _ => "if deceleration is positive in this file, use --sign flip".to_owned(),
    };
    notes.concern(About::Pulse, Weight::Decisive, format!(
        "the pulse is positive (it gains {change:.2} m/s in the first {:.0} ms), a frontal impact is negative by SAE \
         J211: {way_out}",
        (pulse.end_s().min(WINDOW_S)) * 1e3
    ));
}

/// Turns the sign of every acceleration along x, or along an axis that is not stated, and of its initial velocity.
/// Returns how many channels that are.
pub fn flip(channels: &mut [ReadChannel]) -> Result<usize, SignalError> {
    let mut flipped = 0;
    for ReadChannel { channel, wave, .. } in channels {
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
