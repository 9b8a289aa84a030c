//! The measurement of a test: what lies between the motion of a mass and the numbers of its record.

use std::f64::consts::{PI, SQRT_2};
use std::fmt::Write as _;

use crumple_numerics::estimation::random::RandomNumbers;
use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;

/// Sample interval of the motions that are measured, s.
pub(crate) const FINE_S: f64 = 1e-5;
/// Sample intervals of records, s: 10 to 20 kHz.
const INTERVALS_S: [f64; 4] = [1e-4, 8e-5, 6.25e-5, 5e-5];
/// Corner of the anti-alias filter, Hz.
const ANTI_ALIAS_HZ: f64 = 1650.0;
/// How far time zero of the record may be from contact, s.
const TRIGGER_S: f64 = 1e-4;
/// How far the stated impact speed may be off: 0.1 km/h.
const SPEED_M_PER_S: f64 = 0.1 / 3.6;
/// How far the zero level may be off, g.
const ZERO_LEVEL_G: f64 = 0.5;
/// The range of the digitiser over the largest value of the pulse.
const RANGE: f64 = 2.0;
/// The end of a motion that is not recorded: there the filter without phase has no wave to look ahead at, s.
const END_S: f64 = 0.005;

/// What errs in a made test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Errors {
    /// Noise, zero level and steps of the digitiser alone: trigger and stated speed are right, the filter has no phase.
    Few,
    /// Trigger, stated speed and the delay of a filter too.
    Laboratory,
    /// The same, and the mount of every sensor rings.
    Ringing,
}

/// A mount that rings from contact on: it adds a decaying sine to what its sensor measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ring {
    frequency_hz: f64,
    /// Over the peak of the pulse.
    share: f64,
    decay_s: f64,
}

impl Ring {
    /// 60 to 250 Hz, 5 to 15 % of the peak, down to 1/e after 10 to 30 ms: what stands in a compartment's pulse behind
    /// CFC 60 and after it.
    pub fn drawn(random: &mut RandomNumbers) -> Self {
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        Self { frequency_hz: between(60.0, 250.0), share: between(0.05, 0.15), decay_s: between(0.01, 0.03) }
    }

    /// The motion with the ring, from contact on in steps of [`FINE_S`].
    pub fn added_to(&self, acceleration: &[f64]) -> Vec<f64> {
        let peak = acceleration.iter().fold(0.0_f64, |peak, a| peak.max(a.abs()));
        let ring = |k: usize| {
            let time_s = k as f64 * FINE_S;
            self.share * peak * (-time_s / self.decay_s).exp() * (2.0 * PI * self.frequency_hz * time_s).sin()
        };
        acceleration.iter().enumerate().map(|(k, a)| a + ring(k)).collect()
    }
}

/// How one test is measured, the same for all of its sensors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Measurement {
    /// Sample interval of the record, s.
    interval_s: f64,
    /// What is recorded before time zero, s: 20 to 100 ms.
    before_s: f64,
    /// Contact on the clock of the record, s.
    contact_s: f64,
    /// Whether the anti-alias filter is causal, of four poles; else two poles both ways.
    is_causal: bool,
    /// Resolution of the digitiser: 12 to 16 bit.
    bits: i32,
    /// What the speed of the impact is above the stated one, m/s.
    pub speed_error_m_per_s: f64,
}

impl Measurement {
    /// Draws a measurement. A `clean` one has a trigger and a stated speed without error and a filter without phase.
    pub fn drawn(random: &mut RandomNumbers, clean: bool) -> Self {
        let errors = if clean { 0.0 } else { 1.0 };
        let interval_s = INTERVALS_S[random.below(INTERVALS_S.len())];
        let before_s = (0.02 + 0.08 * random.uniform()) / interval_s;
        Self {
            interval_s,
            before_s: before_s.round() * interval_s,
            contact_s: errors * TRIGGER_S * (2.0 * random.uniform() - 1.0),
            is_causal: random.below(2) == 0 && !clean,
            bits: [12, 13, 14, 15, 16][random.below(5)],
            speed_error_m_per_s: errors * SPEED_M_PER_S * (2.0 * random.uniform() - 1.0),
        }
    }

    /// The record as CSV below its `head`: time and one column a sensor, its name and its acceleration, m/s², from
    /// contact on in steps of [`FINE_S`].
    ///
    /// Each sensor behind the anti-alias filter of 1650 Hz, with white noise of 0.5 to 1 % of its peak and a zero level
    /// off by up to 0.5 g, digitised over twice its peak.
    pub fn csv(&self, head: &str, sensors: &[(&str, &[f64])], random: &mut RandomNumbers) -> String {
        let mut csv = format!("{head}time_s");
        let mut columns: Vec<Vec<f64>> = Vec::new();
        for (name, acceleration) in sensors {
            let _infallible = write!(csv, ",{name} (g)");
            columns.push(self.digitised(acceleration, random));
        }
        csv.push('\n');
        for k in 0..columns.first().map_or(0, Vec::len) {
            let _infallible = write!(csv, "{:.7}", k as f64 * self.interval_s - self.before_s);
            columns.iter().for_each(|column| {
                let _infallible = write!(csv, ",{}", column[k]);
            });
            csv.push('\n');
        }
        csv
    }

    /// What the digitiser gives of an acceleration, g, at the instants of the record.
    fn digitised(&self, acceleration: &[f64], random: &mut RandomNumbers) -> Vec<f64> {
        let filtered = self.sampled(acceleration);
        let peak = filtered.iter().fold(0.0_f64, |peak, a| peak.max(a.abs())) / G;
        let noise = (0.005 + 0.005 * random.uniform()) * peak;
        let zero_level = ZERO_LEVEL_G * (2.0 * random.uniform() - 1.0);
        let step = 2.0 * RANGE * peak / 2.0_f64.powi(self.bits);
        let measured = |a: &f64| ((a / G + zero_level + noise * random.normal()) / step).round() * step + 0.0;
        filtered.iter().map(measured).collect()
    }

    /// The acceleration behind the anti-alias filter at the instants of the record, m/s²; linear between its samples,
    /// which errs by 0.13 % of what it has at 1650 Hz.
    fn sampled(&self, acceleration: &[f64]) -> Vec<f64> {
        let rest = ((self.before_s + 2.0 * TRIGGER_S) / FINE_S).ceil();
        let wave = std::iter::repeat_n(0.0, rest as usize).chain(acceleration.iter().copied());
        let filtered = if self.is_causal {
            let [first, second] = LowPass::four_poles(ANTI_ALIAS_HZ);
            second.forward(first.forward(wave, FINE_S).into_iter(), FINE_S)
        } else {
            LowPass::two_poles(ANTI_ALIAS_HZ).both_ways(wave, FINE_S)
        };
        let recorded_s = self.before_s + acceleration.len() as f64 * FINE_S - END_S;
        let at = |k: usize| {
            let place = rest + (k as f64 * self.interval_s - self.before_s - self.contact_s) / FINE_S;
            let (first, share) = (place.floor(), place.fract());
            filtered[first as usize] * (1.0 - share) + filtered[first as usize + 1] * share
        };
        (0..=(recorded_s / self.interval_s) as usize).map(at).collect()
    }
}

/// Two poles by the bilinear transform. A wave is at rest before its first sample and after its last one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LowPass {
    frequency_hz: f64,
    /// Twice the damping ratio.
    damping: f64,
}

impl LowPass {
    /// Two poles after Butterworth.
    pub fn two_poles(frequency_hz: f64) -> Self {
        Self { frequency_hz, damping: SQRT_2 }
    }

    /// A channel frequency class, to be passed both ways: `2 pi 2.0775 class` rad/s (SAE J211-1, Appendix C).
    pub fn of_class(class: f64) -> Self {
        Self::two_poles(2.0775 * class)
    }

    /// Four poles after Butterworth as two filters in a row: damping ratios `sin(pi/8)` and `sin(3 pi/8)`.
    pub fn four_poles(frequency_hz: f64) -> [Self; 2] {
        [PI / 8.0, 3.0 * PI / 8.0].map(|angle| Self { frequency_hz, damping: 2.0 * angle.sin() })
    }

    /// The wave, samples `dt_s` apart, behind the filter.
    pub fn forward(self, wave: impl Iterator<Item = f64>, dt_s: f64) -> Vec<f64> {
        let wa = (PI * self.frequency_hz * dt_s).tan();
        let scale = 1.0 + self.damping * wa + wa * wa;
        let a = wa * wa / scale;
        let b = [-2.0 * (wa * wa - 1.0) / scale, (-1.0 + self.damping * wa - wa * wa) / scale];
        let (mut x, mut y) = ([0.0; 2], [0.0; 2]);
        wave.map(|sample| {
            let out = a * (sample + 2.0 * x[0] + x[1]) + b[0] * y[0] + b[1] * y[1];
            (x, y) = ([sample, x[0]], [out, y[0]]);
            out
        })
        .collect()
    }

    /// Largest deceleration behind CFC 60, m/s², of a motion from contact on, samples `dt_s` apart, with 50 ms of rest
    /// before it.
    pub fn peak_of_class_60(acceleration: &[f64], dt_s: f64) -> f64 {
        let rest = std::iter::repeat_n(0.0, (0.05 / dt_s).round() as usize);
        let filtered = Self::of_class(60.0).both_ways(rest.chain(acceleration.iter().copied()), dt_s);
        filtered.iter().fold(0.0, |peak, a| peak.max(-a))
    }

    /// The wave behind the filter forwards and backwards, so without phase. At a jump of the wave's end, the last
    /// `2 / frequency` mean nothing.
    pub fn both_ways(self, wave: impl Iterator<Item = f64>, dt_s: f64) -> Vec<f64> {
        let mut both = self.forward(self.forward(wave, dt_s).into_iter().rev(), dt_s);
        both.reverse();
        both
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The instant, s on the clock of the record, at which half of a step at contact is reached.
    fn middle_s(measurement: &Measurement) -> f64 {
        let step = vec![100.0; 5000];
        let sampled = measurement.sampled(&step);
        let after = sampled.iter().position(|a| *a >= 50.0).unwrap_or_default();
        let share = (50.0 - sampled[after - 1]) / (sampled[after] - sampled[after - 1]);
        (after as f64 - 1.0 + share) * measurement.interval_s - measurement.before_s
    }

    #[test]
    fn a_causal_filter_and_a_late_trigger_move_the_record() {
        let mut random = RandomNumbers::seeded(7);
        let clean = Measurement { interval_s: 5e-5, ..Measurement::drawn(&mut random, true) };
        assert_eq!((clean.contact_s, clean.speed_error_m_per_s, clean.is_causal), (0.0, 0.0, false));
        // The step lies between two samples of the motion.
        assert!((middle_s(&clean) + 0.5 * FINE_S).abs() < 1e-6, "{}", middle_s(&clean));
        let late = Measurement { contact_s: 8e-5, ..clean };
        assert!((middle_s(&late) - middle_s(&clean) - 8e-5).abs() < 2e-6);
        // The step response of four poles after Butterworth reaches a half at 2.61 / omega within 10 %.
        let causal = Measurement { is_causal: true, ..clean };
        let delay = middle_s(&causal) - middle_s(&clean);
        assert!((delay - 2.52e-4).abs() < 2.5e-5, "{delay}");
    }

    #[test]
    fn a_ring_starts_at_contact_and_is_gone_after_the_pulse() {
        let mut random = RandomNumbers::seeded(3);
        for _ in 0..50 {
            let ring = Ring::drawn(&mut random);
            let rung = ring.added_to(&[vec![-100.0; 5000], vec![0.0; 15_000]].concat());
            assert_eq!(rung[0], -100.0, "{ring:?}");
            let most = rung[..5000].iter().fold(0.0_f64, |most, a| most.max((a + 100.0).abs()));
            // A quarter of a period is at most 4.2 ms, of a decay of at least 10 ms: exp(-0.42) is left.
            assert!((3.2..15.0).contains(&most), "{most} {ring:?}");
            // After 0.2 s: exp(-6.6) of 15.
            assert!(rung[20_000 - 1].abs() < 0.03, "{ring:?}");
        }
    }

    #[test]
    fn drawn_measurements_keep_their_ranges_and_half_of_them_are_causal() {
        let mut random = RandomNumbers::seeded(8);
        let drawn: Vec<Measurement> = (0..400).map(|_| Measurement::drawn(&mut random, false)).collect();
        for one in &drawn {
            assert!((0.0199..0.1001).contains(&one.before_s) && (12..=16).contains(&one.bits), "{one:?}");
            assert!(one.contact_s.abs() <= TRIGGER_S && one.speed_error_m_per_s.abs() <= SPEED_M_PER_S, "{one:?}");
        }
        // Five standard deviations of 400 throws of a coin.
        let causal = drawn.iter().filter(|one| one.is_causal).count();
        assert!((150..=250).contains(&causal), "{causal}");
    }

    #[test]
    fn noise_and_zero_level_of_a_record_are_those_of_a_laboratory() {
        let mut random = RandomNumbers::seeded(9);
        let measurement = Measurement { bits: 16, ..Measurement::drawn(&mut random, false) };
        let record = measurement.digitised(&vec![-300.0; 5000], &mut random);
        let rest = &record[..(0.9 * measurement.before_s / measurement.interval_s) as usize];
        let mean = rest.iter().sum::<f64>() / rest.len() as f64;
        let deviation = (rest.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / rest.len() as f64).sqrt();
        let peak = 300.0 / G;
        // Noise of 0.5 to 1 % of a peak that the filter passes by up to 11 %; 300 samples tell its deviation to 10 %.
        assert!(mean.abs() < 0.52 && (0.0045..0.0125).contains(&(deviation / peak)), "{mean} {}", deviation / peak);
    }

    /// Gain, dB, and the delay of a slow wave, s, after the transient.
    fn gain_and_delay(filtered: &dyn Fn(&[f64]) -> Vec<f64>, frequency_hz: f64, dt_s: f64) -> (f64, f64) {
        let omega = std::f64::consts::TAU * frequency_hz;
        let samples = 8 * (1.0 / frequency_hz / dt_s).round() as usize;
        let wave: Vec<f64> = (0..2 * samples).map(|k| (omega * k as f64 * dt_s).sin()).collect();
        let filtered = filtered(&wave);
        let projected = |quadrature: fn(f64) -> f64| -> f64 {
            let whole = samples / 2..samples / 2 + samples;
            whole.clone().map(|k| filtered[k] * quadrature(omega * k as f64 * dt_s)).sum::<f64>() * 2.0
                / whole.len() as f64
        };
        let (sine, cosine) = (projected(f64::sin), projected(f64::cos));
        (20.0 * sine.hypot(cosine).log10(), (-cosine).atan2(sine) / omega)
    }

    /// -3 dB at 100 Hz for CFC 60 in both passes, by what the class is defined by; 1 dB of tolerance in ISO 6487.
    #[test]
    fn class_60_halves_the_power_at_100_hz() {
        let class = |wave: &[f64]| LowPass::of_class(60.0).both_ways(wave.iter().copied(), 1e-4);
        let (gain, delay) = gain_and_delay(&class, 100.0, 1e-4);
        assert!((gain + 3.0).abs() < 1.0, "{gain}");
        assert!(delay.abs() < 1e-6, "{delay}");
    }

    /// Butterworth: -3.01 dB at the frequency, whose bilinear warping at 20 us is 0.4 %; the delay of slow waves is the
    /// sum of twice the damping ratios over the angular frequency, 2.613 / (2 pi 1650) = 0.252 ms.
    #[test]
    fn four_poles_have_butterworths_gain_and_delay() {
        let four = |wave: &[f64]| {
            LowPass::four_poles(1650.0).iter().fold(wave.to_vec(), |wave, low| low.forward(wave.into_iter(), 2e-5))
        };
        let (gain, _) = gain_and_delay(&four, 1650.0, 2e-5);
        assert!((gain + 3.01).abs() < 0.1, "{gain}");
        let (_, delay) = gain_and_delay(&four, 50.0, 2e-5);
        assert!((delay - 2.52e-4).abs() < 2e-6, "{delay}");
    }
}
