//! Both passes of a channel filter over one record or several side by side, and what happens at their ends: for a
//! record, and for a model that is seen as the record was.

use std::f64::consts::{PI, SQRT_2};

use crate::{Cfc, CfcMode, Coefficients, FilterError};

/// A second-order difference equation on its way through N records side by side:
/// `y[i] = a0·x[i] + a1·x[i-1] + a2·x[i-2] + b1·y[i-1] + b2·y[i-2]`.
///
/// Direct form I: the state is the last two inputs and the last two outputs, so a pass can be interrupted between
/// blocks and continued with the same bits. Five products a sample; that `y[i]` needs `y[i-1]` sets the speed. Each
/// record is computed for itself, so that its bits do not depend on the others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Recursion<const N: usize> {
    /// a0, a1, a2, b1, b2.
    coefficients: [f64; 5],
    x1: [f64; N],
    x2: [f64; N],
    y1: [f64; N],
    y2: [f64; N],
    /// Samples yet to come whose output is the one before them.
    held: usize,
    /// Samples yet to come before the next look at the state ([`Self::flush`]), counted over interruptions.
    until_look: usize,
}

/// Samples between two looks at the state of a recursion: a look costs what a sample costs, so under 1 % of the pass,
/// and the state is subnormal for at most so many samples.
const SAMPLES_A_LOOK: usize = 256;

impl<const N: usize> Recursion<N> {
    /// Behind inputs and outputs that were the same for ever.
    #[inline(always)]
    pub(crate) fn behind(coefficients: [f64; 5], input: [f64; N], output: [f64; N]) -> Self {
        Self { coefficients, x1: input, x2: input, y1: output, y2: output, held: 0, until_look: SAMPLES_A_LOOK }
    }

    /// Before a pass whose first two outputs are `start`.
    #[inline(always)]
    fn starting(coefficients: [f64; 5], start: [f64; N]) -> Self {
        Self { held: 2, ..Self::behind(coefficients, start, start) }
    }

    /// Replaces samples by outputs, from the last to the first if `BACKWARD`. Plain loops: closures would not be
    /// compiled for the vectors of the caller.
    #[inline(always)]
    pub(crate) fn run<const BACKWARD: bool>(&mut self, samples: &mut [[f64; N]]) {
        let count = samples.len();
        let held = self.held.min(count);
        self.held -= held;
        for k in 0..held {
            let sample = &mut samples[if BACKWARD { count - 1 - k } else { k }];
            (self.x2, self.x1) = (self.x1, std::mem::replace(sample, self.y1));
        }
        let mut samples = if BACKWARD { &mut samples[..count - held] } else { &mut samples[held..] };
        while !samples.is_empty() {
            let count = self.until_look.min(samples.len());
            let (stretch, rest) = if BACKWARD {
                let (rest, stretch) = samples.split_at_mut(samples.len() - count);
                (stretch, rest)
            } else {
                samples.split_at_mut(count)
            };
            self.run_stretch::<BACKWARD>(stretch);
            self.until_look -= count;
            if self.until_look == 0 {
                self.flush();
            }
            samples = rest;
        }
    }

    /// Sets the state of each record to zero where all of it is subnormal (below 2.2e-308).
    ///
    /// Behind a pulse the state decays until rounding stops it, at the smallest number over `1 - b1 - b2`: at most
    /// 1e-314 for the lowest cut-off, and -5e-322 for CFC 60 at 10 kHz. Each product with it takes a processor tens of
    /// times longer, for as long as the zeros last.
    ///
    /// An input that follows is zero, then the outputs differ by what the recursion makes of 2.2e-308, at most 1e-303;
    /// or it is above 1e-280, then products with such a state are lost in the rounding of the sum, and after two
    /// samples the state is the same. So outputs above 1e-290 keep their bits.
    #[inline(always)]
    fn flush(&mut self) {
        self.until_look = SAMPLES_A_LOOK;
        for lane in 0..N {
            let state = [&mut self.x1[lane], &mut self.x2[lane], &mut self.y1[lane], &mut self.y2[lane]];
            if state.iter().all(|value| value.abs() < f64::MIN_POSITIVE) {
                state.into_iter().for_each(|value| *value = 0.0);
            }
        }
    }

    /// [`Self::run`] over samples between two looks at the state.
    #[inline(always)]
    fn run_stretch<const BACKWARD: bool>(&mut self, samples: &mut [[f64; N]]) {
        let [a0, a1, a2, b1, b2] = self.coefficients;
        if N == 1 {
            let mut state = [self.x1[0], self.x2[0], self.y1[0], self.y2[0]];
            run_one::<BACKWARD>(samples.as_flattened_mut(), a0, a1, a2, b1, b2, &mut state);
            (self.x1[0], self.x2[0], self.y1[0], self.y2[0]) = (state[0], state[1], state[2], state[3]);
            return;
        }
        let Self { mut x1, mut x2, mut y1, mut y2, .. } = *self;
        let count = samples.len();
        for k in 0..count {
            let sample = &mut samples[if BACKWARD { count - 1 - k } else { k }];
            let x = *sample;
            for lane in 0..N {
                // Summed in the order of the standard's equation: another order gives other last digits.
                sample[lane] = a0 * x[lane] + a1 * x1[lane] + a2 * x2[lane] + b1 * y1[lane] + b2 * y2[lane];
            }
            (x2, x1) = (x1, x);
            (y2, y1) = (y1, *sample);
        }
        *self = Self { x1, x2, y1, y2, ..*self };
    }
}

/// The same of one record, with every number by itself: arrays of one, and coefficients side by side in memory, would
/// be packed into vectors whose parts wait for each other, at twice the time.
#[inline(never)]
fn run_one<const BACKWARD: bool>(
    samples: &mut [f64],
    a0: f64,
    a1: f64,
    a2: f64,
    b1: f64,
    b2: f64,
    state: &mut [f64; 4],
) {
    let [mut x1, mut x2, mut y1, mut y2] = *state;
    let count = samples.len();
    for k in 0..count {
        let sample = &mut samples[if BACKWARD { count - 1 - k } else { k }];
        let x = *sample;
        let y = a0 * x + a1 * x1 + a2 * x2 + b1 * y1 + b2 * y2;
        *sample = y;
        (x2, x1) = (x1, x);
        (y2, y1) = (y1, y);
    }
    *state = [x1, x2, y1, y2];
}

/// Magnitude of the larger root of `z² - b1·z - b2`: how much of it a recursion keeps from one sample to the next.
pub(crate) fn largest_root(b1: f64, b2: f64) -> f64 {
    let square = b1 * b1 + 4.0 * b2;
    if square < 0.0 { (-b2).sqrt() } else { 0.5 * (b1.abs() + square.sqrt()) }
}

/// Samples of which the mean starts a pass.
const START_SAMPLES: usize = 10;
/// Shortest extension, samples, as long as the record has them.
const SHORTEST_EXTENSION: usize = 100;
/// Shortest extension, s.
const EXTENSION_S: f64 = 0.01;
/// Fewest samples: with 3 mirrored on either side they are the ten that start a pass.
const FEWEST_SAMPLES: usize = 4;
/// Samples between two reports of progress.
const BLOCK: usize = 1 << 16;
/// Share to which a filter's memory has to fall before it is neglected: 1e-10 of 1000 m/s² over 10 ms moves no
/// displacement by 1e-11 m.
const FORGOTTEN: f64 = 1e-10;

/// Told how many samples have gone through a pass since the last call. Work on a record of n samples is 2·n of them.
pub type Report<'a> = &'a (dyn Fn(u64) + Sync);

/// A filter of second order that is run forward and backward over a record: no phase, so events keep their times (ISO
/// 6487, SAE J211).
///
/// Both ends are first extended by point reflection about the end sample, `2·x[0] - x[i]` and `2·x[N-1] - x[N-1-i]`;
/// each pass starts from the mean of the first ten samples it meets, the recursion from the third. Without an extension
/// each pass starts from rest, so a record that is not at rest at its ends is wrong there: half the first sample is
/// missing.
///
/// The filter spreads a jump over about ±10 ms at CFC 60, to both sides. Rounding: about 1e-13 of the largest sample.
/// ISO 6487 Annex A; SAE J211-1 Appendix C leaves the ends to the user. The ends are the part where implementations
/// differ. The point reflection keeps value and slope of the record across its end; a reflection about zero keeps
/// neither. Zero-phase routines that add nine samples unless told otherwise differ from this by up to 1 g at the ends
/// of a ringing pulse at CFC 60.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoPassFilter {
    /// a0, a1, a2, b1, b2 of `y[i] = a0·x[i] + a1·x[i-1] + a2·x[i-2] + b1·y[i-1] + b2·y[i-2]`.
    pub coefficients: [f64; 5],
    /// Samples mirrored through the end points before filtering; 0: started from rest.
    pub samples_added: usize,
}

impl TwoPassFilter {
    /// Filters N records of one length in their place. Fewer than four samples stay as they are.
    #[inline(always)]
    pub fn run<const N: usize>(&self, records: &mut [[f64; N]], report: Report<'_>) {
        let count = records.len();
        if count < FEWEST_SAMPLES {
            return;
        }
        let added = self.samples_added.min(count - 1);
        let (first, last) = (records[0], records[count - 1]);
        // The extensions are short and apart from the records, so that nothing of their length is moved.
        let mut left = vec![[0.0; N]; added];
        let mut right = vec![[0.0; N]; added];
        for k in 1..=added {
            for lane in 0..N {
                left[added - k][lane] = 2.0 * first[lane] - records[k][lane];
                right[k - 1][lane] = 2.0 * last[lane] - records[count - 1 - k][lane];
            }
        }
        let of_all = |skipped: usize, records: &[[f64; N]], left: &[[f64; N]], right: &[[f64; N]]| {
            if added == 0 { [0.0; N] } else { mean(left.iter().chain(records).chain(right).skip(skipped)) }
        };
        let mut pass = Recursion::starting(self.coefficients, of_all(0, records, &left, &right));
        pass.run::<false>(&mut left);
        for block in records.chunks_mut(BLOCK) {
            pass.run::<false>(block);
            report(block.len() as u64);
        }
        pass.run::<false>(&mut right);

        let skipped = (count + 2 * added).saturating_sub(START_SAMPLES);
        // What the second pass makes of the left extension is never looked at.
        let mut pass = Recursion::starting(self.coefficients, of_all(skipped, records, &left, &right));
        pass.run::<true>(&mut right);
        for block in records.rchunks_mut(BLOCK) {
            pass.run::<true>(block);
            report(block.len() as u64);
        }
    }

    /// One record filtered, of which nothing is cut off.
    pub fn filtered(&self, record: &[f64]) -> Vec<f64> {
        let mut filtered = record.to_vec();
        self.run(filtered.as_chunks_mut::<1>().0, &|_| ());
        filtered
    }

    /// The same filter, each pass started from rest.
    #[must_use]
    pub fn from_rest(self) -> Self {
        Self { samples_added: 0, ..self }
    }

    /// Samples after which a pass has forgotten its input: as many as its slowest pole takes to fall to 1e-10. At least
    /// the two inputs that an output depends on; without limit where a pole does not decay.
    pub fn memory_samples(&self) -> usize {
        let [.., b1, b2] = self.coefficients;
        let largest = largest_root(b1, b2);
        if largest == 0.0 {
            return 2;
        }
        let samples = (FORGOTTEN.ln() / largest.ln()).ceil();
        if largest < 1.0 && samples.is_finite() { samples.max(2.0) as usize } else { usize::MAX }
    }

    /// Noise bandwidth of both passes, Hz: `3 pi sqrt(2)/16` of the frequency that each was designed for, `tan(pi f T)
    /// = w` with `a0/b1 = w²/(2 - 2 w²)`; 104.1 Hz for CFC 60 after ISO 6487.
    ///
    /// Of two Butterworth passes of second order: the integral of `1/(1 + (f/f0)^4)²` over the frequency.
    pub fn noise_bandwidth_hz(&self, dt_s: f64) -> f64 {
        let [a0, _, _, b1, _] = self.coefficients;
        let ratio = a0 / b1;
        let w = (2.0 * ratio / (1.0 + 2.0 * ratio)).sqrt();
        3.0 * PI * SQRT_2 / 16.0 * w.atan() / (PI * dt_s)
    }

    /// Autocorrelation of white noise after both passes by lag in samples, from 1 at lag 0, and the sum of squares of
    /// the response to an impulse. `None` for a filter that does not forget.
    pub fn noise_autocorrelation(&self) -> Option<(Vec<f64>, f64)> {
        let memory = self.memory_samples();
        if memory == usize::MAX {
            return None;
        }
        let middle = 2 * memory + 2;
        let mut impulse = vec![0.0; 2 * middle + 1];
        impulse[middle] = 1.0;
        let response = self.from_rest().filtered(&impulse);
        let energy: f64 = response.iter().map(|h| h * h).sum();
        // Both passes together are symmetric in time: once more through them is the autocorrelation.
        let twice = self.from_rest().filtered(&response);
        let lags: Vec<f64> = twice[middle..=middle + memory].iter().map(|r| r / energy).collect();
        lags.iter().all(|r| r.is_finite()).then_some((lags, energy))
    }
}

/// Arithmetic mean of up to ten, the state from which a pass starts.
#[inline(always)]
fn mean<'a, const N: usize>(samples: impl Iterator<Item = &'a [f64; N]>) -> [f64; N] {
    let (mut sum, mut count) = ([-0.0; N], 0.0);
    for sample in samples.take(START_SAMPLES) {
        for lane in 0..N {
            sum[lane] += sample[lane];
        }
        count += 1.0;
    }
    sum.map(|sum| sum / count)
}

/// Samples mirrored at each end: 10 ms, but at least 100, and never more than the record has to mirror:
/// `min(max(round(0.01/T), 100), N - 1)`; 0 for `sae_zero_state`.
///
/// What a pass remembers of its start decays as `e^(-2π·CFC·κ·t/√2)`: over 10 ms to about 0.4 % at CFC 60 and 6e-8 at
/// CFC 180.
pub fn samples_added(samples: usize, coefficients: &Coefficients) -> usize {
    if !coefficients.mode().extends() {
        return 0;
    }
    // A float-to-integer cast saturates, so a tiny interval ends at the length of the record.
    ((EXTENSION_S / coefficients.dt_s()).round() as usize).max(SHORTEST_EXTENSION).min(samples.saturating_sub(1))
}

/// Subtracts the zero level, then filters forward and backward ([`TwoPassFilter`]). Memory: the result.
///
/// # Errors
/// Fewer than four samples. Samples near the end of the range of numbers give infinities here, which the caller has to
/// look for.
pub fn filter_both_ways(
    samples: &[f64],
    zero_level: f64,
    coefficients: &Coefficients,
) -> Result<Vec<f64>, FilterError> {
    let mut output = Vec::new();
    filter_both_ways_into(samples, zero_level, coefficients, &mut output, &|_| ())?;
    Ok(output)
}

/// [`filter_both_ways`] into a buffer whose memory is used again, with a report of progress: every sample is told
/// twice, once a pass. `output` is cleared first and has the length of `samples` afterwards.
pub fn filter_both_ways_into(
    samples: &[f64],
    zero_level: f64,
    coefficients: &Coefficients,
    output: &mut Vec<f64>,
    report: Report<'_>,
) -> Result<(), FilterError> {
    if samples.len() < FEWEST_SAMPLES {
        return Err(FilterError::TooShort { samples: samples.len() });
    }
    output.clear();
    output.reserve_exact(samples.len());
    output.extend(samples.iter().map(|x| x - zero_level));
    let samples_added = samples_added(samples.len(), coefficients);
    let filter = TwoPassFilter { coefficients: coefficients.to_array(), samples_added };
    filter.run(output.as_chunks_mut::<1>().0, report);
    Ok(())
}

/// Samples through a channel frequency class after ISO 6487, as a laboratory filters them. `None` for fewer than four
/// samples or a rate below 8.4 times the class.
pub fn through_class(samples: &[f64], dt_s: f64, cfc: Cfc) -> Option<Vec<f64>> {
    let design_hz = cfc.frequency_hz() * CfcMode::Iso6487.frequency_factor();
    (design_hz * dt_s < 0.25)
        .then(|| filter_both_ways(samples, 0.0, &Coefficients::new(cfc, CfcMode::Iso6487, dt_s)))?
        .ok()
}

/// Samples through the phaseless four-pole low-pass of the classes with another design frequency: each pass leaves 1/√2
/// there, both 1/2. `None` for fewer than four samples or a frequency from a quarter of the sampling rate on.
pub fn phaseless_low_pass(samples: &[f64], dt_s: f64, design_hz: f64) -> Option<Vec<f64>> {
    let is_usable = design_hz > 0.0 && design_hz * dt_s < 0.25;
    is_usable.then(|| filter_both_ways(samples, 0.0, &Coefficients::designed(design_hz, CfcMode::Iso6487, dt_s)))?.ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_is_ten_milliseconds_a_hundred_samples_or_the_record() {
        let added = |samples, dt_s, mode| samples_added(samples, &Coefficients::new(Cfc::Cfc60, mode, dt_s));
        assert_eq!(added(5000, 1e-4, CfcMode::Iso6487), 100);
        assert_eq!(added(5000, 5e-5, CfcMode::Iso6487), 200);
        assert_eq!(added(5000, 1e-3, CfcMode::SaeReflect), 100);
        assert_eq!(added(51, 1e-4, CfcMode::Iso6487), 50);
        assert_eq!(added(51, 1e-300, CfcMode::Iso6487), 50);
        assert_eq!(added(5000, 1e-4, CfcMode::SaeZeroState), 0);
    }

    #[test]
    fn four_samples_are_enough_and_three_are_refused() {
        let coefficients = Coefficients::new(Cfc::Cfc60, CfcMode::Iso6487, 1e-4);
        let error = filter_both_ways(&[1.0; 3], 0.0, &coefficients).unwrap_err();
        assert_eq!(
            error.to_string(),
            "3 samples are too few for a channel frequency class filter, at least 4 are needed"
        );
        for y in filter_both_ways(&[7.0; 4], 2.0, &coefficients).unwrap() {
            // DC gain 1, and the start state is the constant itself: rounding only.
            assert!((y - 5.0).abs() < 1e-12, "{y}");
        }
    }

    /// The definition, word for word: one long extended record, two passes over all of it.
    fn as_written(samples: &[f64], zero_level: f64, c: &Coefficients) -> Vec<f64> {
        let (n, added) = (samples.len(), samples_added(samples.len(), c));
        let x: Vec<f64> = samples.iter().map(|x| x - zero_level).collect();
        let mut work: Vec<f64> = (1..=added).rev().map(|i| 2.0 * x[0] - x[i]).collect();
        work.extend(&x);
        work.extend((1..=added).map(|i| 2.0 * x[n - 1] - x[n - 1 - i]));
        for is_backward in [false, true] {
            // The mean is summed in the order of the record, so that both have the same rounding.
            let mut first: Vec<f64> = work.iter().take(START_SAMPLES).copied().collect();
            if is_backward {
                first.reverse();
            }
            let start = if added > 0 { first.iter().sum::<f64>() / START_SAMPLES as f64 } else { 0.0 };
            let x = std::mem::take(&mut work);
            work.extend([start; 2]);
            for i in 2..x.len() {
                let sum = c.a0 * x[i] + c.a1 * x[i - 1] + c.a2 * x[i - 2];
                work.push(sum + c.b1 * work[i - 1] + c.b2 * work[i - 2]);
            }
            work.reverse();
        }
        work[added..added + n].to_vec()
    }

    #[test]
    fn blocks_and_separate_extensions_change_no_bit() {
        for mode in [CfcMode::Iso6487, CfcMode::SaeReflect, CfcMode::SaeZeroState] {
            let c = Coefficients::new(Cfc::Cfc180, mode, 1e-4);
            for n in [4, 5, 7, 99, 101, 350, BLOCK + 3, 2 * BLOCK + 2] {
                let samples: Vec<f64> = (0..n).map(|k| 40.0 * (0.05 * k as f64).sin() + (k % 7) as f64).collect();
                let filtered = filter_both_ways(&samples, 0.3, &c).unwrap();
                assert_eq!(filtered, as_written(&samples, 0.3, &c), "{n} {mode:?}");
            }
        }
    }

    /// Both passes without a look at the state.
    fn never_flushed(samples: &[f64], c: &Coefficients) -> Vec<f64> {
        let mut output = as_written(samples, 0.0, c);
        output.iter_mut().filter(|y| y.abs() <= 1e-290).for_each(|y| *y = 0.0);
        output
    }

    #[test]
    fn a_flushed_state_changes_no_bit_above_1e_290() {
        // Pulses from -1e3 to 1e3 in zeros, the second long after the state of the first has been flushed. The sign of
        // a zero is none of the bits that count.
        for (cfc, dt_s) in [(Cfc::Cfc60, 1e-4), (Cfc::Cfc1000, 1e-4), (Cfc::Cfc180, 1e-5), (Cfc::Cfc60, 1e-3)] {
            for mode in [CfcMode::Iso6487, CfcMode::SaeReflect, CfcMode::SaeZeroState] {
                let c = Coefficients::new(cfc, mode, dt_s);
                let pulse = |k: usize| if k % 40_000 < 300 { 1e3 * (0.7 * (k % 40_000) as f64).sin() } else { 0.0 };
                let samples: Vec<f64> = (0..100_000).map(pulse).collect();
                let mut filtered = filter_both_ways(&samples, 0.0, &c).unwrap();
                let flushed = filtered[20_000..25_000].iter().filter(|y| **y == 0.0).count();
                assert!(dt_s < 1e-4 || flushed > 4_000, "{flushed} zeros of {cfc} at {dt_s} s: no state was flushed");
                filtered.iter_mut().filter(|y| y.abs() <= 1e-290).for_each(|y| *y = 0.0);
                let differ = filtered.iter().zip(never_flushed(&samples, &c)).position(|(y, z)| *y != z);
                assert_eq!(differ, None, "{cfc} {mode:?} {dt_s}");
            }
        }
    }

    #[test]
    fn looks_at_the_state_do_not_depend_on_interruptions() {
        let c = Coefficients::new(Cfc::Cfc180, CfcMode::Iso6487, 1e-4).to_array();
        let samples: Vec<[f64; 1]> = (0..20_000).map(|k| [if k < 30 { 5.0 } else { 0.0 }]).collect();
        let run = |piece: usize| {
            let mut samples = samples.clone();
            let mut pass = Recursion::behind(c, [0.0], [0.0]);
            samples.chunks_mut(piece).for_each(|piece| pass.run::<false>(piece));
            samples.as_flattened().iter().map(|y| y.to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(run(97), run(20_000));
        // Nor on the records beside it: one that never rests stands in the other lane.
        let mut both: Vec<[f64; 2]> = samples.iter().enumerate().map(|(k, [x])| [*x, (k % 9) as f64]).collect();
        let mut pass = Recursion::behind(c, [0.0; 2], [0.0; 2]);
        pass.run::<false>(&mut both);
        assert!(both.iter().map(|y| y[0].to_bits()).eq(run(97)));
    }

    #[test]
    fn progress_adds_up_to_two_passes() {
        let done = std::sync::atomic::AtomicU64::new(0);
        let samples = vec![1.0; BLOCK + 17];
        let c = Coefficients::new(Cfc::Cfc60, CfcMode::Iso6487, 1e-4);
        let add = |amount| {
            done.fetch_add(amount, std::sync::atomic::Ordering::Relaxed);
        };
        filter_both_ways_into(&samples, 0.0, &c, &mut Vec::new(), &add).unwrap();
        assert_eq!(done.into_inner(), 2 * samples.len() as u64);
    }

    fn memory(poles: [f64; 2]) -> usize {
        let [p, q] = poles;
        TwoPassFilter { coefficients: [1.0, 0.0, 0.0, p + q, -p * q], samples_added: 0 }.memory_samples()
    }

    #[test]
    fn a_filter_forgets_as_its_slowest_pole_decays() {
        // ln 1e-10 / ln 0.9 = 218.5; the roots are exact to a rounding.
        assert_eq!([memory([0.9, 0.5]), memory([0.9, 0.0]), memory([-0.9, 0.5])], [219; 3]);
        assert_eq!(memory([0.0, 0.0]), 2);
        assert_eq!([memory([1.0, 0.5]), memory([1.2, 0.1]), memory([f64::NAN, 0.1])], [usize::MAX; 3]);
        // A complex pair of magnitude 0.9.
        let pair = TwoPassFilter { coefficients: [1.0, 0.0, 0.0, 1.2, -0.81], samples_added: 0 };
        assert_eq!(pair.memory_samples(), 219);
    }

    #[test]
    fn a_class_falls_to_half_power_at_its_frequency_over_0_6() {
        // Each pass of second order is 1/(1 + (f/f0)^4)^(1/2) with f0 = 1.25 f at f = CFC/0.6: both leave
        // 1/(1 + 1.25^-4) = 0.7094, 3 dB within what the bilinear transform shifts at 10 kHz, 1e-3.
        let sine: Vec<f64> = (0..20_000).map(|k| (2.0 * PI * 100.0 * f64::from(k) * 1e-4).sin()).collect();
        let out = through_class(&sine, 1e-4, Cfc::Cfc60).unwrap();
        let gain = out[9_000..11_000].iter().fold(0.0, |m: f64, y| m.max(y.abs()));
        assert!((gain - 1.0 / (1.0 + 1.25_f64.powi(-4))).abs() < 1e-3, "{gain}");
    }

    #[test]
    fn passes_a_constant_and_halves_its_frequency() {
        let flat = phaseless_low_pass(&[3.0; 50], 1e-3, 13.0).unwrap();
        // Gain 1 at rest. The feedback multiplies rounding by 1/(4 a0) = 160 at most: two passes of five products of 3,
        // each half of 4e-16.
        assert!(flat.iter().all(|y| (y - 3.0).abs() < 1e-12));
        let sine: Vec<f64> = (0..20_000).map(|k| (2.0 * PI * 13.0 * f64::from(k) * 1e-3).sin()).collect();
        let out = phaseless_low_pass(&sine, 1e-3, 13.0).unwrap();
        // Phaseless, gain 1/2; what starts at the ends has died out, 520 time constants away. Left is the rounding of
        // the argument, some 1e-13 at 900 rad, and of two passes, 160 times 1e-15.
        assert!((9_000..11_000).all(|k| (out[k] - 0.5 * sine[k]).abs() < 1e-12));
        assert!(
            phaseless_low_pass(&[1.0; 3], 1e-3, 13.0).is_none() && phaseless_low_pass(&[1.0; 30], 0.1, 13.0).is_none()
        );
    }

    #[test]
    fn the_bandwidth_is_that_of_the_class() {
        // CFC 60 at 10 kHz by ISO 6487: designed for 60 Hz times 25/12 = 125 Hz; a0 is given to six digits, which is
        // 1e-4 Hz in the frequency.
        let coefficients = [0.001_460_32, 0.002_920_64, 0.001_460_32, 1.889_033, -0.894_874];
        let filter = TwoPassFilter { coefficients, samples_added: 0 };
        let expected = 3.0 * PI * SQRT_2 / 16.0 * 125.0;
        assert!((filter.noise_bandwidth_hz(1e-4) - expected).abs() < 0.02, "{}", filter.noise_bandwidth_hz(1e-4));
    }
}
