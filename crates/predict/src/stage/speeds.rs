//! Speeds as a person types them: one by one, or as a range.

use crumple_signal::value::Speed;
use crumple_stage::Usage;

/// Speeds of a range at most.
const MOST: f64 = 1000.0;

/// `64 km/h`, or a range with both ends and a step: `20..80/5 km/h`, `20km/h..80km/h/5km/h`. The unit of a range may
/// stand once; one without any is in km/h, the second thing returned says so. SI, rising.
///
/// Errors: a number without unit, a speed that is not positive, a step that leads nowhere.
pub fn speeds(text: &str) -> Result<(Vec<f64>, bool), Usage> {
    let Some((low, rest)) = text.split_once("..") else { return Ok((vec![positive(speed(text)?)?], false)) };
    let wrong = || {
        Usage::new(format!("{text:?} is no range of speeds")).hint("both ends and a step: 20..80/5 km/h, with its unit")
    };
    // A unit has a stroke of its own: the last stroke with a number behind it divides end and step.
    let strokes = rest.match_indices('/').map(|(at, _)| (&rest[..at], &rest[at + 1..]));
    let is_number = |text: &str| text.trim_start().starts_with(|c: char| c.is_ascii_digit() || c == '.');
    let (high, step) = strokes.rev().find(|(_, step)| is_number(step)).ok_or_else(wrong)?;
    let units: Vec<&str> = [low, high, step].into_iter().map(unit).filter(|unit| !unit.is_empty()).collect();
    let stated = units.first().copied();
    let with_unit = |text: &str| {
        let unit = if unit(text).is_empty() { stated.unwrap_or("km/h") } else { "" };
        speed(&format!("{} {unit}", text.trim()))
    };
    let (low, high, step) = (positive(with_unit(low)?)?, positive(with_unit(high)?)?, positive(with_unit(step)?)?);
    let count = ((high - low) / step + 1e-9).floor();
    if !(0.0..MOST).contains(&count) {
        return Err(wrong());
    }
    Ok(((0..=count as usize).map(|k| low + k as f64 * step).collect(), stated.is_none()))
}

/// What stands behind the number.
fn unit(text: &str) -> &str {
    text.trim().trim_start_matches(|c: char| c.is_ascii_digit() || ".+-".contains(c)).trim()
}

fn speed(text: &str) -> Result<f64, Usage> {
    let speed: Speed = text.trim().parse().map_err(|error| Usage::new(format!("speed {text:?}: {error}")))?;
    Ok(speed.si())
}

fn positive(speed: f64) -> Result<f64, Usage> {
    if speed > 0.0 && speed.is_finite() {
        return Ok(speed);
    }
    Err(Usage::new(format!("an impact at {speed} m/s is none, expected a positive speed")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn km_per_h(text: &str) -> Vec<f64> {
        speeds(text).unwrap().0.iter().map(|v| (v * 3.6 * 1e6).round() / 1e6).collect()
    }

    #[test]
    fn a_range_has_its_unit_once_or_everywhere() {
        assert_eq!(km_per_h("64km/h"), [64.0]);
        for text in ["20..30/5 km/h", "20km/h..30km/h/5km/h", "20 .. 30 km/h / 5", "20..30/5"] {
            assert_eq!(km_per_h(text), [20.0, 25.0, 30.0], "{text}");
        }
        assert_eq!(km_per_h("10..12/1 m/s"), [36.0, 39.6, 43.2]);
        assert_eq!(km_per_h("20..33/5 km/h").len(), 3);
        assert!(speeds("20..30/5").unwrap().1 && !speeds("20..30/5 km/h").unwrap().1);
    }

    #[test]
    fn what_is_no_speed_is_refused() {
        for text in ["64", "0 km/h", "-5 km/h", "20..30 km/h", "30..20/5 km/h", "20..30/0 km/h", "20..1e9/1 m/s", ".."]
        {
            assert!(speeds(text).is_err(), "{text}");
        }
    }
}
