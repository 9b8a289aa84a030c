//! Butterworth low-pass filters of any order: design into sections, run over a record.

use std::f64::consts::{PI, SQRT_2};

use serde::{Deserialize, Serialize};

use crate::FilterError;
use crate::zero_phase::{Recursion, largest_root};

/// Lowest cut-off over the sampling rate: below it the rounding of the coefficients moves the gain by more than 1e-6.
const LOWEST_RATIO: f64 = 1e-5;
/// Highest order offered. The overshoot after a jump grows with the order: 4 % for order 2 in one pass, 19 % for 12.
pub const HIGHEST_ORDER: usize = 12;

/// a0, a1, a2, b1, b2 of `y[i] = a0·x[i] + a1·x[i-1] + a2·x[i-2] + b1·y[i-1] + b2·y[i-2]`. A section of first order
/// has a2 = b2 = 0.
pub type Section = [f64; 5];

/// How the filter is run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// Forward and backward: no phase, twice the attenuation of one pass; the cut-off is that of both passes.
    #[default]
    Zero,
    /// Forward only, as an instrument does: events come late.
    Causal,
}

impl Phase {
    /// The name used in artifacts.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::Causal => "causal",
        }
    }
}

/// A Butterworth low-pass filter in the words of whoever asks for it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Butterworth {
    /// Frequency at which the filter as run leaves 1/√2 of the amplitude (-3.01 dB), Hz.
    pub cutoff_hz: f64,
    /// Poles of one pass.
    pub order: usize,
    /// How it is run.
    pub phase: Phase,
}

/// A Butterworth filter for one sampling interval: sections of second order, run one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// What was asked for.
    pub asked: Butterworth,
    /// Sampling interval, s.
    pub dt_s: f64,
    /// The sections of one pass, run in this order: n/2 rounded up for order n, the least damped first and that of
    /// first order last.
    pub sections: Vec<Section>,
}

impl Butterworth {
    /// Designs the filter by the bilinear transform of the analogue prototype, prewarped so that the cut-off is exact.
    ///
    /// Prototype poles `-sin θ ± j·cos θ`, `θ = π(2k - 1)/(2n)`. For [`Phase::Zero`] the prototype is widened by
    /// `(√2 - 1)^(-1/(2n))`, so that two passes together have -3.01 dB at the cut-off; for n = 2 that is the factor of
    /// SAE J211-1. Oppenheim & Schafer, *Discrete-Time Signal Processing*, 7.2 and 7.3.
    ///
    /// Gain as run, with `u = tan(π·f·T)/tan(π·fc·T)`: `1/√(1 + u^(2n))` for one pass, `1/(1 + (√2 - 1)·u^(2n))` for
    /// both ways. Sections, not one polynomial, because the coefficients of a polynomial of order 12 lose their digits
    /// at low cut-offs. The gain at the cut-off is exact to 1e-9 for cut-offs from 0.2 % of the rate on.
    ///
    /// # Errors
    /// An order outside 1 to 12; a cut-off below 1e-5 of the sampling rate, from half of it on, or no number.
    pub fn design(self, dt_s: f64) -> Result<Design, FilterError> {
        let (n, cutoff_hz, rate_hz) = (self.order, self.cutoff_hz, 1.0 / dt_s);
        if !(1..=HIGHEST_ORDER).contains(&n) {
            return Err(FilterError::Order { order: n });
        }
        // A NaN is not inside either.
        if !(LOWEST_RATIO * rate_hz..0.5 * rate_hz).contains(&cutoff_hz) || cutoff_hz <= 0.0 {
            return Err(FilterError::Cutoff { cutoff_hz, rate_hz });
        }
        let widened = match self.phase {
            Phase::Zero => (SQRT_2 - 1.0).powf(-1.0 / (2.0 * n as f64)),
            Phase::Causal => 1.0,
        };
        let w = (PI * cutoff_hz * dt_s).tan() * widened;
        // Twice the damping ratio of the prototype's pole pairs, the least damped pair first.
        let damping = (1..=n / 2).map(|k| 2.0 * (PI * (2 * k - 1) as f64 / (2 * n) as f64).sin());
        let mut sections: Vec<Section> = damping.map(|q| second_order(w, q)).collect();
        if n % 2 == 1 {
            let d = 1.0 + w;
            sections.push([w / d, w / d, 0.0, (1.0 - w) / d, 0.0]);
        }
        Ok(Design { asked: self, dt_s, sections })
    }
}

/// `w²/(s² + q·w·s + w²)` through `s = (1 - z⁻¹)/(1 + z⁻¹)`.
fn second_order(w: f64, q: f64) -> Section {
    let d = 1.0 + q * w + w * w;
    let a0 = w * w / d;
    [a0, 2.0 * a0, a0, 2.0 * (1.0 - w * w) / d, (-1.0 + q * w - w * w) / d]
}

impl Design {
    /// Samples after which what the filter remembers has fallen to 1e-6: `ln(1e-6)/ln r`, r the largest magnitude of a
    /// pole. About `3.1/(fc·T)` for order 2 run forward only.
    pub fn memory_samples(&self) -> usize {
        let slowest = self.sections.iter().map(|&[.., b1, b2]| largest_root(b1, b2)).fold(0.0, f64::max);
        // A float-to-integer cast saturates, and of nothing is nothing.
        (1e-6_f64.ln() / slowest.max(1e-300).ln()).ceil() as usize
    }
}

/// Shortest extension, samples, as long as the record has them.
const SHORTEST_EXTENSION: usize = 100;

/// Samples mirrored at each end: what the filter remembers to 1e-6, but at least 100 and never more than the record
/// has; none for a causal filter.
pub fn sections_extension(samples: usize, design: &Design) -> usize {
    match design.asked.phase {
        Phase::Causal => 0,
        Phase::Zero => design.memory_samples().max(SHORTEST_EXTENSION).min(samples.saturating_sub(1)),
    }
}

/// Subtracts a level, then runs the sections of a Butterworth filter one after the other.
///
/// Each section starts as if the first sample had been there for ever, so a constant leaves no transient. Zero phase:
/// both ends are extended by point reflection first, all sections run forward, then all backward. Causal: forward
/// only; events come late by the group delay of the filter, `1/(2π·fc·sin(π/(2n)))` for slow changes through a low-pass
/// of order n, which is about `0.1·n/fc` (2.25 ms for order 2 at 100 Hz).
///
/// Memory: the record and both extensions; the sections work in place. Every design is stable, so finite samples give
/// finite results but for overflow.
pub fn run_sections(samples: &[f64], level: f64, design: &Design) -> Vec<f64> {
    let n = samples.len();
    let Some((first, last)) = samples.first().zip(samples.last()) else { return Vec::new() };
    let (first, last) = (first - level, last - level);
    let added = sections_extension(n, design);
    let mut work = Vec::with_capacity(n + 2 * added);
    work.extend(samples[1..=added].iter().rev().map(|x| 2.0 * first - (x - level)));
    work.extend(samples.iter().map(|x| x - level));
    work.extend(samples[n - 1 - added..n - 1].iter().rev().map(|x| 2.0 * last - (x - level)));
    let run = |work: &mut [f64], section, start, backward| {
        let [a0, a1, a2, b1, b2] = section;
        // Gain at frequency 0; the denominator of a stable filter is not zero there.
        let rest = start * (a0 + a1 + a2) / (1.0 - b1 - b2);
        let mut pass = Recursion::behind(section, [start], [rest]);
        let work = work.as_chunks_mut::<1>().0;
        if backward { pass.run::<true>(work) } else { pass.run::<false>(work) }
    };
    for section in &design.sections {
        let start = work[0];
        run(&mut work, *section, start, false);
    }
    if design.asked.phase == Phase::Zero {
        for section in &design.sections {
            let start = work[work.len() - 1];
            run(&mut work, *section, start, true);
        }
        work.copy_within(added..added + n, 0);
        work.truncate(n);
    }
    work
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cfc, CfcMode, Coefficients};

    #[test]
    fn two_passes_of_second_order_at_cfc_over_0_6_are_the_sae_filter() {
        let asked = Butterworth { cutoff_hz: 100.0, order: 2, phase: Phase::Zero };
        let sae = Coefficients::new(Cfc::Cfc60, CfcMode::SaeReflect, 1e-4).to_array();
        for (coefficient, expected) in asked.design(1e-4).unwrap().sections[0].iter().zip(sae) {
            // SAE prewarps at 2.0775·CFC = 124.65 Hz, this design at the cut-off: ((π·124.65·T)² - (π·100·T)²)/3 in the
            // frequency, 1.8e-4, twice that in a0.
            assert!((coefficient - expected).abs() < 4e-4 * expected.abs(), "{coefficient} {expected}");
        }
    }

    #[test]
    fn refuses_orders_and_frequencies_that_make_no_filter() {
        let error = |cutoff_hz, order| {
            Butterworth { cutoff_hz, order, phase: Phase::Causal }.design(1e-4).unwrap_err().to_string()
        };
        assert_eq!(error(100.0, 0), "order 0 is not offered, an order from 1 to 12 is needed");
        assert_eq!(error(5000.0, 2), "cut-off 5000 Hz does not lie between 0.1 Hz and half the sampling rate, 5000 Hz");
        assert!(error(f64::NAN, 2).starts_with("cut-off NaN Hz"));
    }
}
