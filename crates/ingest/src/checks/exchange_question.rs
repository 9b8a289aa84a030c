//! The question for a unit, a speed, a time or a sign that was taken for another one, with the flag that mends it.

use crumple_metrics::{Exchange, Impact, Plausibility, number_typed};
use crumple_signal::value::Time;
use crumple_signal::{About, STANDARD_GRAVITY_M_PER_S2 as G};

use crate::{IngestSettings, Sign};

/// An answer to the question: what is typed, and what it sets.
pub struct Answer {
    /// As typed, `--unit g`.
    pub flag: String,
    /// The settings with it.
    pub settings: IngestSettings,
}

/// The answers that may mend an exchange, the likelier first. Which of them does is for the reader of the file to try:
/// a format that states its units heeds no `--unit`.
pub fn answers(exchange: Exchange, flags: &IngestSettings, speed_m_per_s: f64) -> Vec<Answer> {
    let answer = |flag: String, set: &dyn Fn(&mut IngestSettings)| {
        let mut settings = flags.clone();
        set(&mut settings);
        Answer { flag, settings }
    };
    let unit = |unit: &'static str| answer(format!("--unit {unit}"), &|s| s.unit = Some(unit.to_owned()));
    let time_unit =
        |unit: &'static str| answer(format!("--time-unit {unit}"), &|s| s.time_unit = Some(unit.to_owned()));
    match exchange {
        Exchange::Unit(factor) if factor > 1.0 => vec![unit("g")],
        Exchange::Unit(_) => vec![unit("m/s^2")],
        Exchange::Speed(_) => meant_speed(exchange, speed_m_per_s)
            .map(|(number, unit)| format!("{number}{unit}"))
            .and_then(|typed| Some((typed.parse().ok()?, typed)))
            .map(|(speed, typed)| answer(format!("--impact-speed {typed}"), &|s| s.impact_speed = Some(speed)))
            .into_iter()
            .collect(),
        Exchange::Time(factor) => match flags.sample_time {
            Some(interval) => {
                let interval = Time::from_si(factor * interval.si());
                vec![answer(format!("--sample-time {}us", short(1e6 * interval.si())), &|s| {
                    s.sample_time = Some(interval);
                })]
            }
            None if factor < 1.0 => vec![time_unit("ms"), time_unit("us")],
            None => vec![time_unit("s"), time_unit("ms")],
        },
        Exchange::Polarity => {
            let sign = if flags.sign == Some(Sign::Flip) { Sign::Keep } else { Sign::Flip };
            let word = if sign == Sign::Keep { "keep" } else { "flip" };
            vec![answer(format!("--sign {word}"), &|s| s.sign = Some(sign))]
        }
    }
}

/// The speed that is meant, in the unit in which it was typed: of 35 mph read as 35 km/h the number 35 and mph.
fn meant_speed(exchange: Exchange, speed_m_per_s: f64) -> Option<(f64, &'static str)> {
    let Exchange::Speed(factor) = exchange else { return None };
    let number = short(number_typed(exchange, speed_m_per_s)?);
    let unit = if factor > 2.0 {
        "m/s"
    } else if factor > 1.0 {
        "mph"
    } else {
        "km/h"
    };
    Some((number, unit))
}

/// At most three decimals.
fn short(number: f64) -> f64 {
    (number * 1e3).round() / 1e3
}

/// What is asked, and what it concerns. `flag`: the answer that mends it; `None` where no flag does.
pub fn question(plausibility: &Plausibility, flag: Option<&str>, speed_m_per_s: f64) -> Option<(About, String)> {
    let (exchange, impact) = match plausibility {
        Plausibility::After(exchange, impact) => (*exchange, impact),
        Plausibility::AfterAnyOf(exchanges) => {
            let names: Vec<&str> = exchanges.iter().map(|exchange| name(*exchange)).collect();
            let text = format!(
                "impact speed and pulse do not fit together: check {}; each of these changes would fit a car",
                names.join(", ")
            );
            return Some((About::Pulse, text));
        }
        Plausibility::Consistent | Plausibility::Inconsistent => return None,
    };
    let from = format!("{:.1} km/h", 3.6 * impact.impact_speed_m_per_s);
    let speed =
        meant_speed(exchange, speed_m_per_s).map(|(number, unit)| format!("{number} {unit}")).unwrap_or_default();
    let (about, if_so, ask) = match exchange {
        Exchange::Unit(factor) if factor > 1.0 => {
            (About::Pulse, format!("in g this pulse stops the car from {from}"), "is the unit g?".to_owned())
        }
        Exchange::Unit(_) => {
            (About::Pulse, format!("in m/s^2 this pulse stops the car from {from}"), "is the unit m/s^2?".to_owned())
        }
        Exchange::Speed(_) => (
            About::ImpactSpeed,
            format!("from {speed} this pulse stops the car"),
            format!("is the impact speed {speed}, not {:.1} km/h?", 3.6 * speed_m_per_s),
        ),
        Exchange::Time(factor) => (
            About::Pulse,
            format!(
                "with times 1000 times {} this pulse stops the car from {from}",
                if factor < 1.0 { "shorter" } else { "longer" }
            ),
            "is the unit of time another one?".to_owned(),
        ),
        Exchange::Polarity => (
            About::Pulse,
            format!("with the other sign this pulse stops the car from {from}"),
            "is deceleration positive in this file?".to_owned(),
        ),
    };
    let answer = flag.map_or_else(|| format!("correct {} in the file", name(exchange)), |flag| format!("add {flag}"));
    Some((about, format!("{if_so} ({}): {ask} If so, {answer}", figures(impact))))
}

/// What an exchange is of, in words.
fn name(exchange: Exchange) -> &'static str {
    match exchange {
        Exchange::Unit(_) => "the unit",
        Exchange::Speed(_) => "the impact speed",
        Exchange::Time(_) => "the unit of time",
        Exchange::Polarity => "the sign",
    }
}

/// Crush, rebound and peak of an impact.
fn figures(impact: &Impact) -> String {
    format!(
        "crush {:.0} mm, restitution {:.2}, peak {:.0} g",
        1e3 * impact.crush_m,
        (impact.change - 1.0).max(0.0),
        impact.peak_m_per_s2 / G
    )
}
