//! Agreement of redundant sensors: two at one place, or left and right of one place.

use std::collections::BTreeMap;

use crumple_signal::iso13499::IsoCode;
use crumple_signal::{About, Channel, Notes, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G, Sampled, Weight};

use crate::recording::wave::Wave;
use crate::time::time_zero::{SMOOTHING_S, moving_mean};

/// Velocities and displacements are compared up to this time, s.
const WINDOW_S: f64 = 0.150;
/// A difference of crush above this part is a warning: two channels are then not averaged either.
const TOO_MUCH: f64 = 0.05;
/// Pairs that get a note of their own.
const PAIR_LIMIT: usize = 20;

/// How far two accelerometers differ from contact to 150 ms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disagreement {
    /// Largest difference of the accelerations, each a 4.4 ms moving mean (about CFC 60), m/s^2.
    pub acceleration_m_per_s2: f64,
    /// Largest difference of the velocities, m/s.
    pub velocity_m_per_s: f64,
    /// Largest displacements of the two, where the speed at contact is known and both are reached, m.
    pub crush_m: Option<[f64; 2]>,
}

/// Compares two records on one grid, each without its zero level. `None` where the grids differ or there is no sample
/// after contact.
///
/// Velocity and displacement by the trapezoidal rule of the unfiltered samples. A difference of zero level of 0.1 g
/// alone is 0.1 m/s and 5 mm after 0.1 s.
pub fn compare(one: &Sampled, other: &Sampled, zeros: [f64; 2], v0_m_per_s: Option<f64>) -> Option<Disagreement> {
    let dt = one.dt_s();
    let shift = (other.t0_s() - one.t0_s()) / dt;
    if (other.dt_s() / dt - 1.0).abs() > 1e-9 || (shift - shift.round()).abs() > 1e-3 {
        return None;
    }
    let mut acceleration: f64 = 0.0;
    let half = (SMOOTHING_S / dt / 2.0) as usize;
    let smooth = [moving_mean(one.samples(), half), moving_mean(other.samples(), half)];
    let start = [one.index_at_or_after(0.0), other.index_at_or_after(0.0)];
    let n = (0..2)
        .map(|c| [one, other][c].index_at_or_after(WINDOW_S).saturating_sub(start[c]))
        .min()
        .filter(|n| *n >= 2)?;
    for k in 0..n {
        let at = |c: usize| smooth[c][start[c] + k] - zeros[c];
        acceleration = acceleration.max((at(0) - at(1)).abs());
    }
    let raw = |c: usize, k: usize| [one, other][c].samples()[start[c] + k] - zeros[c];
    let mut velocity: f64 = 0.0;
    let mut v = [v0_m_per_s.unwrap_or(0.0); 2];
    let mut x = [0.0_f64; 2];
    let mut crush: [Option<f64>; 2] = [None; 2];
    for k in 1..n {
        for c in 0..2 {
            let before = v[c];
            v[c] += 0.5 * dt * (raw(c, k - 1) + raw(c, k));
            x[c] += 0.5 * dt * (before + v[c]);
            if crush[c].is_none() && v[c] <= 0.0 {
                crush[c] = Some(x[c]);
            }
        }
        velocity = velocity.max((v[0] - v[1]).abs());
    }
    let crush_m = v0_m_per_s.and(crush[0].zip(crush[1]).map(|(a, b)| [a, b]));
    Some(Disagreement { acceleration_m_per_s2: acceleration, velocity_m_per_s: velocity, crush_m })
}

/// Notes on all pairs of accelerations with data whose codes differ by redundancy alone, or by left and right along x
/// on the vehicle. `same_place` tells the ids that serve as the pulse.
pub fn check(
    channels: &[Channel],
    waves: &[Wave],
    same_place: &[String],
    speed_m_per_s: Option<f64>,
    notes: &mut Notes,
) {
    let mut groups: BTreeMap<String, Vec<(&Channel, &Wave)>> = BTreeMap::new();
    for wave in waves.iter().filter(|w| w.quantity == QuantityKind::Acceleration) {
        let Some(channel) = channels.iter().find(|c| c.id == wave.id) else { continue };
        let Some((code, _)) = channel.code.as_deref().and_then(|c| IsoCode::parse(c).ok()) else { continue };
        groups.entry(place_key(&code, same_place.contains(&wave.id))).or_default().push((channel, wave));
    }
    let mut pairs = 0;
    for members in groups.values() {
        let Some(((first, wave), others)) = members.split_first() else { continue };
        for (other, other_wave) in others {
            pairs += 1;
            if pairs <= PAIR_LIMIT {
                let speed = first.initial_velocity_m_per_s.map(f64::abs).filter(|v| *v > 0.0).or(speed_m_per_s);
                let speed = speed.filter(|_| same_place.contains(&first.id));
                note_pair([first, other], [wave, other_wave], speed, notes);
            }
        }
    }
    if pairs > PAIR_LIMIT {
        notes.info(format!("{} further pairs of sensors at one place are not compared", pairs - PAIR_LIMIT));
    }
}

/// The code without redundancy, filter class, and, at places that serve as the pulse, without its side.
fn place_key(code: &IsoCode, as_pulse: bool) -> String {
    let fine = code.fine_locations().map(|part| match part {
        "RD" | "__" => "00",
        "LE" | "RI" if as_pulse => "00",
        part => part,
    });
    let axis = code.axis().map_or_else(|| "0".to_owned(), |a| a.to_string());
    format!("{}{}{}{}{axis}", code.object(), code.position(), code.main_location(), fine.concat())
}

fn note_pair(channels: [&Channel; 2], waves: [&Wave; 2], speed: Option<f64>, notes: &mut Notes) {
    let zeros = waves.map(|w| w.quality.pre_event.map_or(0.0, |p| p.zero_level));
    let names = format!("channels {} and {}", channels[0].id, channels[1].id);
    let what = if channels[0].redundant == channels[1].redundant { "left and right" } else { "redundant" };
    let Some(difference) = compare(&waves[0].samples, &waves[1].samples, zeros, speed) else {
        notes.info(format!(
            "{names} ({what}) are not compared: their time grids differ, or there is nothing after contact"
        ));
        return;
    };
    let mut text = format!(
        "{names} ({what}) differ by at most {:.2} g (4.4 ms mean) and {:.2} m/s up to 150 ms",
        difference.acceleration_m_per_s2 / G,
        difference.velocity_m_per_s
    );
    let mut warn = false;
    if let Some([a, b]) = difference.crush_m {
        let part = (a - b).abs() / a.abs().max(b.abs()).max(f64::MIN_POSITIVE);
        text.push_str(&format!(", by {:.1} % of dynamic crush ({:.0} and {:.0} mm)", 100.0 * part, 1e3 * a, 1e3 * b));
        warn = part > TOO_MUCH;
    }
    if warn {
        notes.concern(About::Pulse, Weight::Marked, format!("{text}: one of them may be wrong"));
    } else {
        notes.info(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_shows_in_every_figure() {
        // Constant -200 m/s^2 from 15 m/s: t_m = 75 ms, C = v0^2/2a = 0.5625 m; 10 % less gives 0.625 m.
        let wave =
            |a: f64| Sampled::new(-0.01, 1e-4, (0..2000).map(|k| if k < 100 { 0.0 } else { a }).collect()).unwrap();
        let difference = compare(&wave(-200.0), &wave(-180.0), [0.0; 2], Some(15.0)).unwrap();
        assert!((difference.acceleration_m_per_s2 - 20.0).abs() < 1e-9);
        // 20 m/s^2 over 149.9 ms.
        assert!((difference.velocity_m_per_s - 20.0 * 0.1499).abs() < 1e-9);
        let [a, b] = difference.crush_m.unwrap();
        // The maximum is taken at a sample: v there is below 200*1e-4 m/s, so x is short by less than 1e-6 m.
        assert!((a - 0.5625).abs() < 2e-6 && (b - 0.625).abs() < 2e-6, "{a} {b}");
        let offset = compare(&wave(-200.0), &wave(-200.0), [0.0, 0.0], None).unwrap();
        assert_eq!((offset.velocity_m_per_s, offset.crush_m), (0.0, None));
    }

    #[test]
    fn other_grids_are_not_compared() {
        let wave = |t0, dt| Sampled::new(t0, dt, vec![1.0; 100]).unwrap();
        assert!(compare(&wave(0.0, 1e-3), &wave(0.0, 2e-3), [0.0; 2], None).is_none());
        assert!(compare(&wave(0.0, 1e-3), &wave(0.0004, 1e-3), [0.0; 2], None).is_none());
        assert!(compare(&wave(-1.0, 1e-3), &wave(-1.0, 1e-3), [0.0; 2], None).is_none());
        assert!(compare(&wave(0.0, 1e-3), &wave(-0.01, 1e-3), [0.0; 2], None).is_some());
    }
}
