//! The sensitivity of a channel as a person states it: what its volts or counts are of a quantity.

use std::fmt;
use std::str::FromStr;

use crumple_signal::unit::{signal_unit, without_brackets};
use crumple_signal::{About, Notes, QuantityKind, Sampled, Weight, remarks};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::recording::content::{Fitness, ReadChannel};
use crate::recording::settings::select;
use crate::{Result, refuse, refuse_channel};

/// How a number without a unit is called.
const COUNTS: [&str; 7] = ["", "count", "counts", "lsb", "bit", "digit", "digits"];
/// What is said where a scale cannot be read.
const FORM: &str = "CHANNEL=SENSITIVITY, such as ch2=50mV/g, ax=16384/g, ch1=2.5V/kN or a=0.5g/V; the reading at zero \
    behind @: ch2=50mV/g@2.5V; several by commas";

/// What to add where a channel may be the reading of a sensor.
pub fn of_sensor(id: &str) -> String {
    format!("add --scale \"{id}=50mV/g\" with the sensitivity of its sensor (counts: {id}=16384/g)")
}

/// The scales of some channels.
#[derive(Debug, Clone, PartialEq)]
pub struct Scales {
    text: String,
    each: Vec<Scale>,
}

/// `q = factor·(x - zero)`, `x` in V or as read.
#[derive(Debug, Clone, PartialEq)]
struct Scale {
    channel: String,
    words: String,
    quantity: QuantityKind,
    factor: f64,
    zero: f64,
    /// Whether it is of volts, not of numbers without a unit.
    of_volts: bool,
}

impl FromStr for Scales {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let each = text.split(',').map(|part| Scale::parse(part).ok_or_else(|| format!("{part:?} is no {FORM}")));
        Ok(Self { text: text.to_owned(), each: each.collect::<std::result::Result<_, _>>()? })
    }
}

impl fmt::Display for Scales {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Serialize for Scales {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Scales {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(de::Error::custom)
    }
}

/// A number and what stands behind it.
fn number(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let is_of_number = |(k, c): (usize, char)| {
        c.is_ascii_digit() || ".+-".contains(c) || (c == 'e' && text[k + 1..].starts_with(|c: char| "+-".contains(c)))
    };
    let end = text.char_indices().find(|at| !is_of_number(*at)).map_or(text.len(), |(k, _)| k);
    let value: f64 = text[..end].parse().ok()?;
    value.is_finite().then_some((value, text[end..].trim()))
}

/// The factor to V, or 1 of a count, and whether it is of volts.
fn of_reading(unit: &str) -> Option<(f64, bool)> {
    if COUNTS.contains(&unit.to_lowercase().as_str()) {
        return Some((1.0, false));
    }
    signal_unit(unit).filter(|(kind, _)| *kind == QuantityKind::Voltage).map(|(_, factor)| (factor, true))
}

/// What one of the reading is of a quantity, from so much above for so much below a slash: the factor, the quantity,
/// and whether the reading is in volts.
fn ratio(above: &str, below: &str) -> Option<(f64, QuantityKind, bool)> {
    let (value, above) = number(above).filter(|(value, _)| *value != 0.0)?;
    let below = without_brackets(below.trim());
    let measured = |unit: &str| signal_unit(unit).filter(|(kind, _)| *kind != QuantityKind::Voltage);
    // So much of the reading for one of the quantity.
    if let (Some((to_si, of_volts)), Some((quantity, factor))) = (of_reading(above), measured(below)) {
        return Some((factor / (value * to_si), quantity, of_volts));
    }
    // So much of the quantity for one of the reading.
    let (to_si, of_volts) = of_reading(below)?;
    let (quantity, factor) = measured(without_brackets(above))?;
    Some((value * factor / to_si, quantity, of_volts))
}

impl Scale {
    fn parse(text: &str) -> Option<Self> {
        let (channel, words) = text.split_once('=').map(|(name, rest)| (name.trim(), rest.trim()))?;
        let (sensitivity, zero) = words.split_once('@').unwrap_or((words, "0"));
        // `5mV/(m/s^2)` has two slashes.
        let parts = sensitivity.match_indices('/').map(|(at, _)| (&sensitivity[..at], &sensitivity[at + 1..]));
        let (factor, quantity, of_volts) = parts.into_iter().find_map(|(above, below)| ratio(above, below))?;
        let (zero, of_zero) = number(zero)?;
        let zero = match of_reading(of_zero)? {
            (_, volts) if volts != of_volts && zero != 0.0 => return None,
            (to_si, _) => zero * to_si,
        };
        let (channel, words) = (channel.to_owned(), words.to_owned());
        let scale = Self { channel, words, quantity, factor, zero, of_volts };
        (factor.is_finite() && !scale.channel.is_empty()).then_some(scale)
    }
}

impl Scales {
    /// Makes the quantities of the channels that are named; a scale of volts serves a voltage or numbers without a
    /// unit, one of counts the latter.
    pub fn apply(&self, file: &str, channels: &mut [ReadChannel], notes: &mut Notes) -> Result<()> {
        for scale in &self.each {
            let wanted = &scale.channel;
            let selected = select(channels, wanted);
            let ids: Vec<&str> = channels.iter().take(12).map(|read| read.channel.id.as_str()).collect();
            let [k] = selected.as_slice() else {
                let found = format!("--scale {wanted}={} means {} channels", scale.words, selected.len());
                let hint = "name one: --list prints them";
                return refuse_channel(file, found, format!("one of {}", ids.join(", ")), hint);
            };
            let read = &mut channels[*k];
            let taken_as = (scale.of_volts && read.channel.quantity == QuantityKind::Other).then_some("V");
            let is_fit = match read.channel.quantity {
                QuantityKind::Other => true,
                QuantityKind::Voltage => scale.of_volts,
                _ => false,
            };
            let Some(wave) = read.wave.take().filter(|_| is_fit) else {
                let quantity = read.channel.quantity;
                let found =
                    format!("channel {} is of quantity {quantity}, --scale {} does not fit it", wanted, scale.words);
                let expected = "volts for a sensitivity in volts, numbers without a unit for one in counts";
                return refuse(file, found, expected, "leave --scale away for this channel");
            };
            let (t0_s, dt_s) = (wave.t0_s(), wave.dt_s());
            let samples = wave.into_samples().into_iter().map(|x| scale.factor * (x - scale.zero)).collect();
            let scaled = Sampled::new(t0_s, dt_s, samples).or_else(|error| {
                refuse(file, format!("channel {wanted}: {error}"), "finite numbers", "check the sensitivity of --scale")
            })?;
            read.wave = Some(scaled);
            read.channel.quantity = scale.quantity;
            read.fitness = Fitness::of_only(scale.quantity, "the only acceleration");
            let (id, quantity) = (read.channel.id.clone(), scale.quantity.to_string());
            notes.push(Scaled { id, quantity, scale: scale.words.clone(), taken_as });
        }
        Ok(())
    }
}

remarks! {
    /// Remarks of sensitivities.
    pub REMARKS;

    /// A channel in volts or counts became a quantity.
    CR112 Scaled { id: String, quantity: String, scale: String, taken_as: Option<&'static str> }
    bears on (About::Channel(id.clone()), Weight::None)
    decided "--scale states the sensitivity of the sensor, and behind @ what it reads at zero."
    means "A wrong sensitivity makes the channel wrong by the same factor, and delta-v and crush with it."
    remedy "compare the sensitivity with the calibration sheet of the sensor"
    says {
        let taken_as =
            taken_as.map_or_else(String::new, |unit| format!("; its numbers state no unit and are taken as {unit}"));
        format!("channel {id}: {quantity} by --scale {scale}{taken_as}")
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_signal::{Channel, STANDARD_GRAVITY_M_PER_S2 as G};

    fn factor(text: &str) -> (f64, f64) {
        let scale = Scale::parse(text).unwrap();
        (scale.factor, scale.zero)
    }

    #[test]
    fn sensitivities_either_way_round() {
        let near = |(factor, zero): (f64, f64), expected: (f64, f64)| {
            assert!((factor / expected.0 - 1.0).abs() < 1e-12 && (zero - expected.1).abs() < 1e-12, "{factor} {zero}");
        };
        near(factor("ch2=50mV/g"), (G / 0.05, 0.0));
        near(factor("ch2 = 50 mV/g @ 2.5 V"), (G / 0.05, 2.5));
        near(factor("ax=16384/g"), (G / 16384.0, 0.0));
        near(factor("ax=16384 LSB/g@-12"), (G / 16384.0, -12.0));
        near(factor("a=0.5g/V"), (0.5 * G, 0.0));
        near(factor("ch2=5mV/(m/s^2)"), (1.0 / 5e-3, 0.0));
        near(factor("ch2=5mV/m/s^2"), (1.0 / 5e-3, 0.0));
        near(factor("ch2=20 m/s^2/V"), (20.0, 0.0));
        near(factor("f=2mV/kN"), (1e3 / 2e-3, 0.0));
        near(factor("ax=4e-3g/LSB"), (4e-3 * G, 0.0));
        for wrong in [
            "ch2",
            "ch2=",
            "ch2=50mV",
            "ch2=50/V",
            "=50mV/g",
            "ch2=0mV/g",
            "ch2=50mV/g@3kN",
            "ch2=50mV/g@2500",
            "a=1g/g",
        ] {
            assert!(Scale::parse(wrong).is_none(), "{wrong}");
        }
    }

    #[test]
    fn volts_become_accelerations_and_the_rest_is_refused() {
        let read = |quantity| ReadChannel {
            wave: Some(Sampled::new(0.0, 1e-3, vec![2.5, 2.55]).unwrap()),
            ..ReadChannel::new(Channel::new("ch2", quantity))
        };
        let scales: Scales = "ch2=50mV/g@2.5V".parse().unwrap();
        let mut channels = [read(QuantityKind::Voltage)];
        scales.apply("a.csv", &mut channels, &mut Notes::new()).unwrap();
        assert_eq!(channels[0].channel.quantity, QuantityKind::Acceleration);
        let samples = channels[0].wave.as_ref().unwrap().samples();
        assert!(samples[0] == 0.0 && (samples[1] - G).abs() < 1e-9, "{samples:?}");
        let mut twice = [read(QuantityKind::Acceleration)];
        assert!(scales.apply("a.csv", &mut twice, &mut Notes::new()).is_err());
        let unknown: Scales = "ch9=50mV/g".parse().unwrap();
        assert!(unknown.apply("a.csv", &mut [read(QuantityKind::Voltage)], &mut Notes::new()).is_err());
    }
}
