//! Sled pulses typed as words: a family, its peak and its times.

use crumple_lumped::CrashPulse;
use crumple_signal::value::{Acceleration, Time};
use crumple_stage::Usage;

/// What is to be typed.
const EXPECTED: &str = "half-sine PEAK DURATION, as in \"half-sine 20g 90ms\", or triangle PEAK TIME-OF-PEAK DURATION, \
                        as in \"triangle 24g 35ms 100ms\"";

/// The pulse of the barrier that a text names, positive in the direction of crush; `None` where its first word is no
/// family, so that it is the id of a waveform. Errors: values without unit, missing or without meaning.
pub fn pulse_of(text: &str) -> anyhow::Result<Option<CrashPulse>> {
    let mut words = text.split_whitespace();
    let family = words.next().unwrap_or_default();
    let values: Vec<&str> = words.collect();
    let refused = |problem: String| Usage::new(format!("pulse {text:?}: {problem}")).hint(EXPECTED);
    let peak = |word: &str| word.parse::<Acceleration>().map(Acceleration::si).map_err(|e| refused(e.to_string()));
    let time = |word: &str| word.parse::<Time>().map(Time::si).map_err(|e| refused(e.to_string()));
    let pulse = match (family, values.as_slice()) {
        ("half-sine", [of, lasting]) => CrashPulse::HalfSine { peak_m_per_s2: peak(of)?, duration_s: time(lasting)? },
        ("triangle", [of, at, lasting]) => CrashPulse::triangle(peak(of)?, time(at)?, time(lasting)?)
            .map_err(|_| refused("its peak is not between its start and its end".to_owned()))?,
        ("half-sine" | "triangle", _) => return Err(refused(format!("{} values", values.len())).into()),
        _ => return Ok(None),
    };
    pulse.check().map_err(|error| refused(error.to_string()))?;
    Ok(Some(pulse))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_are_read_with_their_units() {
        let half_sine = CrashPulse::HalfSine { peak_m_per_s2: 20.0 * 9.80665, duration_s: 0.09 };
        assert_eq!(pulse_of("half-sine 20g 90ms").unwrap(), Some(half_sine));
        let triangle = CrashPulse::Lines(vec![(0.0, 0.0), (0.035, 240.0), (0.1, 0.0)]);
        assert_eq!(pulse_of("triangle 240m/s^2 35ms 0.1s").unwrap(), Some(triangle));
        assert_eq!(pulse_of("sled").unwrap(), None);
    }

    #[test]
    fn what_is_no_pulse_is_refused_with_an_example() {
        for text in
            ["half-sine 20g", "half-sine 20 90ms", "half-sine 20g 0ms", "triangle 20g 90ms 40ms", "half-sine nan g 1s"]
        {
            let error = pulse_of(text).unwrap_err();
            let usage = error.downcast_ref::<Usage>().unwrap();
            assert!(usage.to_string().contains(text), "{usage}");
        }
    }
}
