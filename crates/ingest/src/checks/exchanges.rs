//! Mass and speed that may be exchanged or off by a unit or a decimal point: what is asked, what is noted.
//!
//! A sample that stands alone: a lost decimal point, a wrong exponent, a spike of the wire.
//!
//! `-17.358` without its point is a thousand times as large as the samples beside it. A filter spreads such a sample
//! over its neighbours, and the integral keeps it for good, so it is found before either.

use crumple_metrics::{Exchange, Plausibility, number_typed};
use crumple_signal::value::Time;
use crumple_signal::{About, Note, Notes, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G, Sampled, Weight, remarks};

use crate::recording::content::ReadChannel;
use crate::{IngestSettings, Place, Result, Sign, refuse};

/// An answer to the question: what is typed, and what it sets.
pub struct Answer {
    /// As typed, `--unit g`.
    pub flag: String,
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

/// Factor of a unit of speed to m/s.
fn to_m_per_s(unit: &str) -> f64 {
    match unit {
        "mph" => 0.447_04,
        "km/h" => 1.0 / 3.6,
        _ => 1.0,
    }
}

/// At most three decimals.
fn short(number: f64) -> f64 {
    (number * 1e3).round() / 1e3
}

/// What is asked. `flag`: the answer that mends it; `None` where no flag does.
pub fn question(plausibility: &Plausibility, flag: Option<&str>, speed_m_per_s: f64) -> Option<Note> {
    let (exchange, impact) = match plausibility {
        Plausibility::After(exchange, impact) => (*exchange, impact),
        Plausibility::AfterAnyOf(exchanges) => {
            let changes = exchanges.iter().map(|exchange| name(*exchange).to_owned()).collect();
            return Some(SeveralExchanges { changes }.into());
        }
        Plausibility::Consistent | Plausibility::Inconsistent => return None,
    };
    let flag = flag.map(str::to_owned);
    let (crush_m, restitution) = (impact.crush_m, (impact.change - 1.0).max(0.0));
    let peak_g = impact.peak_m_per_s2 / G;
    if let Some((number, unit)) = meant_speed(exchange, speed_m_per_s) {
        let meant_m_per_s = number * to_m_per_s(unit);
        return Some(OtherSpeed { meant_m_per_s, unit, speed_m_per_s, crush_m, restitution, peak_g, flag }.into());
    }
    let (unit, time_factor) = match exchange {
        Exchange::Unit(factor) => (Some(if factor > 1.0 { "g" } else { "m/s^2" }), None),
        Exchange::Time(factor) => (None, Some(factor)),
        Exchange::Speed(_) | Exchange::Polarity => (None, None),
    };
    let (what, impact_speed_m_per_s) = (name(exchange), impact.impact_speed_m_per_s);
    Some(Exchanged { what, unit, time_factor, impact_speed_m_per_s, crush_m, restitution, peak_g, flag }.into())
}

fn name(exchange: Exchange) -> &'static str {
    match exchange {
        Exchange::Unit(_) => "the unit",
        Exchange::Speed(_) => "the impact speed",
        Exchange::Time(_) => "the unit of time",
        Exchange::Polarity => "the sign",
    }
}

/// The question whether something else is meant: what the pulse does then, with crush, restitution and peak, and what
/// to do if so.
fn asked(if_so: &str, [crush_m, restitution, peak_g]: [f64; 3], ask: &str, what: &str, flag: Option<&str>) -> String {
    let figures = format!("crush {:.0} mm, restitution {restitution:.2}, peak {peak_g:.0} g", 1e3 * crush_m);
    let answer = flag.map_or_else(|| format!("correct {what} in the file"), |flag| format!("add {flag}"));
    format!("{if_so} ({figures}): {ask} If so, {answer}")
}

/// Samples on either side that a sample is compared with.
const BESIDE: usize = 3;
/// A sample this many times as large as any beside it is noted.
const NOTED: f64 = 8.0;
/// A sample this many times as large is no measurement: the pulse is refused.
const REFUSED: f64 = 99.0;
/// Smaller samples do no harm: 5 g, or 5 m/s.
const SMALLEST: [f64; 2] = [5.0 * G, 5.0];
/// No accelerometer measures more, nor does a vehicle move faster: 200,000 g, 1 km/s.
const LARGEST: [f64; 2] = [2e5 * G, 1e3];
const NAMED: usize = 5;

/// A sample that its neighbours do not bear out.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Lone {
    index: usize,
    value: f64,
    /// The largest magnitude beside it.
    beside: f64,
    /// Power of ten that brings the sample among its neighbours.
    power: Option<i32>,
}

impl Lone {
    /// The value that fits those beside it, in a unit of this factor to SI.
    fn meant(&self, factor: f64) -> Option<f64> {
        self.power.map(|power| self.value / factor / 10_f64.powi(power))
    }
}

/// Refuses a pulse with a sample that cannot be one, and notes those that hardly can.
pub fn check(file: &str, pulse: &ReadChannel, notes: &mut Notes) -> Result<()> {
    let Some((wave, lone, unit)) = lone_samples(pulse) else { return Ok(()) };
    let id = &pulse.channel.id;
    let largest = limits(pulse.channel.quantity).map_or(f64::INFINITY, |(_, largest)| largest);
    let is_refused = |lone: &&Lone| lone.value.abs() > largest || lone.value.abs() > REFUSED * lone.beside;
    if let Some(lone) = lone.iter().find(is_refused) {
        let place = match &pulse.lines {
            Some(lines) => Place::line(file, lines.of_row(lone.index)),
            None => Place::file(file),
        };
        return refuse(
            place.in_column(id.clone()),
            format!(
                "{} {}",
                words(lone, wave, unit),
                if lone.power.is_some() { "(a lost decimal point?)" } else { "" }
            )
            .trim_end()
            .to_owned(),
            "samples that follow each other",
            "correct that sample, or export the record again",
        );
    }
    if !lone.is_empty() {
        let few: Vec<String> = lone.iter().take(NAMED).map(|lone| words(lone, wave, unit)).collect();
        notes.push(StrayOfPulse { id: id.clone(), count: lone.len(), samples: few.join("; ") });
    }
    Ok(())
}

/// Warns of such samples in channels beside the pulse.
pub fn check_others<'a>(others: impl Iterator<Item = &'a ReadChannel>, notes: &mut Notes) {
    for other in others {
        let Some((wave, lone, unit)) = lone_samples(other) else { continue };
        let Some(first) = lone.iter().max_by(|a, b| (a.value.abs() / a.beside).total_cmp(&(b.value.abs() / b.beside)))
        else {
            continue;
        };
        let (factor, unit) = unit;
        notes.push(Stray {
            id: other.channel.id.clone(),
            count: lone.len(),
            sample: first.index + 1,
            time_s: wave.time_s(first.index),
            value: first.value / factor,
            beside: first.beside / factor,
            meant: first.meant(factor),
            unit,
        });
    }
}

/// Smallest and largest magnitude of a sample that is looked at and believed.
fn limits(quantity: QuantityKind) -> Option<(f64, f64)> {
    match quantity {
        QuantityKind::Acceleration => Some((SMALLEST[0], LARGEST[0])),
        QuantityKind::Velocity => Some((SMALLEST[1], LARGEST[1])),
        _ => None,
    }
}

fn lone_samples(read: &ReadChannel) -> Option<(&Sampled, Vec<Lone>, (f64, &'static str))> {
    let quantity = read.channel.quantity;
    let (smallest, largest) = limits(quantity)?;
    let unit = if quantity == QuantityKind::Acceleration { (G, "g") } else { (1.0, "m/s") };
    let wave = read.wave.as_ref()?;
    Some((wave, find(wave.samples(), smallest, largest), unit))
}

fn words(lone: &Lone, wave: &Sampled, (factor, unit): (f64, &str)) -> String {
    let [value, beside] = [lone.value, lone.beside].map(|x| x / factor);
    reading(lone.index + 1, wave.time_s(lone.index), [value, beside], lone.meant(factor), unit)
}

/// A sample, its time, its value and the largest beside it, and the value that would fit.
fn reading(sample: usize, time_s: f64, [value, beside]: [f64; 2], meant: Option<f64>, unit: &str) -> String {
    let number = |x: f64| if x.abs() < 1e5 { format!("{x:.3}") } else { format!("{x:e}") };
    let meant = meant.map_or_else(String::new, |meant| format!(", {} {unit} would fit", number(meant)));
    format!(
        "sample {sample} at {:.3} ms is {} {unit}, those beside it are at most {} {unit}{meant}",
        1e3 * time_s,
        number(value),
        number(beside)
    )
}

/// Samples of at least `smallest` magnitude that are [`NOTED`] times as large as the three on either side, or larger
/// than `largest`.
fn find(samples: &[f64], smallest: f64, largest: f64) -> Vec<Lone> {
    let n = samples.len();
    let mut lone = Vec::new();
    for index in 0..n {
        let value = samples[index];
        let magnitude = value.abs();
        // The next sample settles nearly all of them.
        let next = if index + 1 < n { samples[index + 1] } else { samples[index.saturating_sub(1)] };
        if magnitude < smallest || (magnitude < NOTED * next.abs() && magnitude <= largest) {
            continue;
        }
        let (before, after) =
            (&samples[index.saturating_sub(BESIDE)..index], &samples[index + 1..n.min(index + 1 + BESIDE)]);
        if before.len() + after.len() < BESIDE {
            continue;
        }
        let beside = before.iter().chain(after).fold(0.0_f64, |largest, x| largest.max(x.abs()));
        if magnitude < NOTED * beside && magnitude <= largest {
            continue;
        }
        let mean = before.iter().chain(after).sum::<f64>() / (before.len() + after.len()) as f64;
        let power = (magnitude / mean.abs()).log10().round();
        let power = Some(power as i32).filter(|p| {
            let meant = value / 10_f64.powi(*p);
            (1..=300).contains(p) && (meant - mean).abs() <= 0.5 * mean.abs()
        });
        lone.push(Lone { index, value, beside, power });
    }
    lone
}

remarks! {
    /// Remarks of what may be exchanged, and of samples that stand alone.
    pub REMARKS;

    /// Impact speed and pulse do not fit together; another unit of the pulse, unit of time or sign would fit.
    CR165 Exchanged {
        what: &'static str, unit: Option<&'static str>, time_factor: Option<f64>, impact_speed_m_per_s: f64,
        crush_m: f64, restitution: f64, peak_g: f64, flag: Option<String>
    }
    bears on (About::Pulse, Weight::Decisive)
    decided "The pulse must change the velocity by 1 to 1.3 times the impact speed (more below 50 km/h). It does not, \
             and it does after this exchange and no other, with crush, peak and duration of a car."
    means "If the answer is yes, all results are wrong until it is corrected."
    remedy "look into the test report; if it is so, type the flag of the sentence or correct the file"
    says {
        let from = format!("{:.1} km/h", 3.6 * impact_speed_m_per_s);
        let (if_so, ask) = match (unit, time_factor) {
            (Some(unit), _) => {
                (format!("in {unit} this pulse stops the car from {from}"), format!("is the unit {unit}?"))
            }
            (None, Some(factor)) => {
                let (times, longer) = (factor.max(1.0 / factor), if *factor < 1.0 { "shorter" } else { "longer" });
                let if_so = format!("with times {times:.0} times {longer} this pulse stops the car from {from}");
                (if_so, "is the unit of time another one?".to_owned())
            }
            (None, None) => (
                format!("with the other sign this pulse stops the car from {from}"),
                "is deceleration positive in this file?".to_owned(),
            ),
        };
        asked(&if_so, [*crush_m, *restitution, *peak_g], &ask, what, flag.as_deref())
    };

    /// Impact speed and pulse do not fit together; the speed in another unit would fit.
    CR166 OtherSpeed {
        meant_m_per_s: f64, unit: &'static str, speed_m_per_s: f64, crush_m: f64, restitution: f64, peak_g: f64,
        flag: Option<String>
    }
    bears on (About::ImpactSpeed, Weight::Decisive)
    decided "The pulse must change the velocity by 1 to 1.3 times the impact speed (more below 50 km/h). It does not, \
             and it does with the typed number in m/s, km/h or mph, with crush, peak and duration of a car."
    means "If the answer is yes, crush, energy and models are wrong until it is corrected. Delta-v holds."
    remedy "look into the test report; if it is so, type the flag of the sentence or correct the file"
    says {
        let speed = format!("{} {unit}", short(meant_m_per_s / to_m_per_s(unit)));
        let if_so = format!("from {speed} this pulse stops the car");
        let ask = format!("is the impact speed {speed}, not {:.1} km/h?", 3.6 * speed_m_per_s);
        asked(&if_so, [*crush_m, *restitution, *peak_g], &ask, "the impact speed", flag.as_deref())
    };

    /// Impact speed and pulse do not fit together; each of several changes would fit.
    CR167 SeveralExchanges { changes: Vec<String> }
    bears on (About::Pulse, Weight::Decisive)
    decided "The pulse must change the velocity by 1 to 1.3 times the impact speed (more below 50 km/h). It does after \
             any one of these changes, with crush, peak and duration of a car."
    means "One of them is wrong, and all results with it."
    remedy "compare unit, impact speed, unit of time and sign with the test report"
    says format!(
        "impact speed and pulse do not fit together: check {}; each of these changes would fit a car",
        changes.join(", ")
    );

    /// The pulse has single samples that their neighbours do not bear out.
    CR168 StrayOfPulse { id: String, count: usize, samples: String }
    bears on (About::Pulse, Weight::Slight)
    decided "A sample of 5 g (5 m/s) or more is 8 times as large as any of the three on either side. From 99 times on, \
             or above 200,000 g (1 km/s), the pulse is refused."
    means "The filter spreads such a sample over its neighbours, and velocity and crush keep it."
    remedy "correct these samples in the file, or export the record again"
    says format!(
        "the pulse, channel {id}, has {count} stand-alone sample{} (a lost decimal point, a spike?), which peak and \
         velocity keep: {samples}",
        if *count == 1 { "" } else { "s" }
    );

    /// A channel beside the pulse has single samples that their neighbours do not bear out.
    CR169 Stray {
        id: String, count: usize, sample: usize, time_s: f64, value: f64, beside: f64, meant: Option<f64>,
        unit: &'static str
    }
    bears on (About::Channel(id.clone()), Weight::Slight)
    decided "A sample of 5 g (5 m/s) or more is 8 times as large as any of the three on either side, or larger than \
             200,000 g (1 km/s). The sentence has the worst one."
    means "Peak and integral of this channel keep the sample. The pulse is not touched."
    remedy "correct the sample in the file before you use this channel"
    says format!(
        "channel {id} has {count} stand-alone sample{} (a lost decimal point, a spike?): {}",
        if *count == 1 { "" } else { "s" },
        reading(*sample, *time_s, [*value, *beside], *meant, unit)
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn half_sine() -> Vec<f64> {
        let at = |k: i32| {
            if (500..1400).contains(&k) { -(f64::from(k - 500) * std::f64::consts::PI / 900.0).sin() } else { 0.0 }
        };
        (0..2500).map(|k| 30.0 * G * at(k)).collect()
    }

    #[test]
    fn a_lost_decimal_point_is_found_with_the_value_that_fits() {
        assert_eq!(find(&half_sine(), SMALLEST[0], LARGEST[0]), []);
        for power in [1, 2, 3, 15] {
            let mut samples = half_sine();
            samples[800] *= 10_f64.powi(power);
            let lone = find(&samples, SMALLEST[0], LARGEST[0]);
            assert_eq!(lone.iter().map(|l| (l.index, l.power)).collect::<Vec<_>>(), [(800, Some(power))]);
        }
    }

    #[test]
    fn a_steep_front_and_the_ends_of_a_record_are_no_lone_samples() {
        let mut step = vec![0.0; 100];
        step.extend([-20.0 * G; 100]);
        assert_eq!(find(&step, SMALLEST[0], LARGEST[0]), []);
        assert_eq!(find(&[100.0 * G, 0.0], SMALLEST[0], LARGEST[0]), []);
        let mut end = half_sine();
        end[2499] = 1e9;
        assert_eq!(find(&end, SMALLEST[0], LARGEST[0]).len(), 1);
        // Two beside each other are larger than anything measured.
        end[2498] = -1e9;
        assert_eq!(find(&end, SMALLEST[0], LARGEST[0]).len(), 2);
    }
}
