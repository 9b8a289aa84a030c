//! Where an element loads, unloads and stands open, by its measured deflection.

/// What an element does at a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Phase {
    /// On its curve.
    Loading,
    /// On its way out of, or back to, the deflection `turn_m`: force there less `k_u (turn - d)`.
    Elastic {
        /// Largest deflection before.
        turn_m: f64,
    },
    /// Without force.
    Open,
}

/// The phase of every sample.
///
/// `set_below`: permanent set below a turn, for a deflection at a turn; what is below it stands open. `None`: unknown
/// yet, then nothing after a turn counts as open until the deflection has come back by `first_guess_m`.
///
/// The turn lies between two samples, where the rate passes zero: a parabola of the rate by rates and accelerations
/// at both, and the deflection from there.
pub(super) fn phases(
    dt_s: f64,
    deflection_m: &[f64],
    rate_m_per_s: &[f64],
    second_m_per_s2: &[f64],
    set_below: impl Fn(f64) -> f64,
) -> Vec<Phase> {
    let mut phases = Vec::with_capacity(deflection_m.len());
    let mut turn: Option<f64> = None;
    for (k, &d) in deflection_m.iter().enumerate() {
        let left = k > 0 && rate_m_per_s[k] < 0.0 && rate_m_per_s[k - 1] >= 0.0;
        let loading_before = matches!(phases.last(), None | Some(Phase::Loading));
        if left && loading_before && d > 0.0 {
            let at = |j: usize| (deflection_m[j], rate_m_per_s[j], second_m_per_s2[j]);
            turn = Some(turning_point(dt_s, at(k - 1), at(k)));
        }
        phases.push(match turn {
            _ if d <= 0.0 => Phase::Open,
            Some(turn_m) if d < turn_m => {
                if d <= set_below(turn_m) {
                    Phase::Open
                } else {
                    Phase::Elastic { turn_m }
                }
            }
            _ => Phase::Loading,
        });
    }
    phases
}

/// The largest value between two samples of which value, first and second derivative are known: of the polynomial of
/// the fifth degree through both, where its slope is zero.
fn turning_point(h: f64, (x0, v0, a0): (f64, f64, f64), (x1, v1, a1): (f64, f64, f64)) -> f64 {
    let (c3, c4, c5) = {
        // Of x1 - x0 - v0 h - a0 h²/2 and its derivatives at the end.
        let p = x1 - x0 - v0 * h - 0.5 * a0 * h * h;
        let q = (v1 - v0 - a0 * h) * h;
        let r = (a1 - a0) * h * h;
        (10.0 * p - 4.0 * q + 0.5 * r, -15.0 * p + 7.0 * q - r, 6.0 * p - 3.0 * q + 0.5 * r)
    };
    let slope = |s: f64| v0 * h + s * (a0 * h * h + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)));
    let (mut low, mut high) = (0.0, 1.0);
    // Halved to the last bit of the place.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if slope(middle) > 0.0 { low = middle } else { high = middle }
    }
    let s = 0.5 * (low + high);
    x0 + s * (v0 * h + s * (0.5 * a0 * h * h + s * (c3 + s * (c4 + s * c5))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swing_turns_where_its_cosine_does() {
        let (omega, dt) = (20.0_f64, 5e-4);
        let t = |k: usize| k as f64 * dt;
        let d: Vec<f64> = (0..300).map(|k| 0.6 * (omega * t(k)).sin()).collect();
        let w: Vec<f64> = (0..300).map(|k| 0.6 * omega * (omega * t(k)).cos()).collect();
        let a: Vec<f64> = d.iter().map(|d| -omega * omega * d).collect();
        let phases = phases(dt, &d, &w, &a, |turn| turn - 0.02);
        let turn = phases.iter().find_map(|p| match p {
            Phase::Elastic { turn_m } => Some(*turn_m),
            _ => None,
        });
        // The sixth derivative times h⁶/720/64: 1e-17.
        assert!((turn.unwrap() - 0.6).abs() < 1e-14);
        assert_eq!(phases[10], Phase::Loading);
        // Open from 0.58 m on, until the end: it does not come back.
        assert_eq!(phases[190], Phase::Open);
        assert_eq!(*phases.last().unwrap(), Phase::Open);
    }
}
