//! Low-pass filters of two poles, written anew: truths do not go through the filter that is on trial.

use std::f64::consts::{PI, SQRT_2};

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
