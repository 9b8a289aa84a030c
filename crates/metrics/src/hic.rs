//! Head injury criterion and its relatives on a resultant, and the pruned search for the worst window.

use crumple_signal::{Acceleration, STANDARD_GRAVITY_M_PER_S2, Signal};

use crate::metric::definitions::{HIC, HIC15, HIC36, HICD};
use crate::sums::in_samples;
use crate::{Definition, Metric};

/// Longest window of HIC15, s.
pub const HIC15_WINDOW_S: f64 = 0.015;

/// Longest window of HIC36, s.
pub const HIC36_WINDOW_S: f64 = 0.036;

/// Head injury criterion: largest `(t2 - t1)·(mean of a in g)^2.5` over all pairs of samples with `t1 < t2 <= t1 + W`
/// (inclusive); its window is on the signal's own axis.
///
/// The mean is `(V(t2) - V(t1))/(t2 - t1)` with V the cumulative trapezoid; a negative mean counts as 0. Exact over the
/// samples, like trying all pairs, but by pruning: see [`hic_all_pairs`] and `docs/metrics.md`, which agree to 1e-12.
/// Between samples the criterion is higher by at most about 2e-4 of itself at 10 kHz. Several windows of equal value
/// (a square pulse): one of them is reported. The input is a resultant at CFC 1000. `window_s` of 15 or 36 ms give
/// HIC15 and HIC36.
pub fn hic(resultant: &Signal<Acceleration>, window_s: f64) -> Metric {
    worst_window(resultant, window_s, pruned)
}

/// [`hic`] by trying every pair: time grows with samples times window. The yardstick of [`hic`].
pub fn hic_all_pairs(resultant: &Signal<Acceleration>, window_s: f64) -> Metric {
    worst_window(resultant, window_s, all_pairs)
}

/// The criterion with the window in which it is reached, by a search over pairs of samples.
fn worst_window(resultant: &Signal<Acceleration>, window_s: f64, search: fn(&[f64], usize) -> Best) -> Metric {
    let definition = definition(window_s);
    let (a, dt) = (resultant.samples(), resultant.dt_s());
    if a.len() < 2 {
        return Metric::absent(definition, "the record has fewer than two samples");
    }
    if !(window_s.is_finite() && window_s > 0.0) {
        return Metric::absent(definition, "the window is not a positive time");
    }
    let longest = in_samples(window_s, dt).map_or(0, |(whole, _)| whole).min(a.len() - 1);
    if longest == 0 {
        return Metric::absent(definition, &format!("the window of {window_s} s is shorter than a sampling interval"));
    }
    let best = search(a, longest);
    // The search works in m/s² and samples.
    let value = dt * best.value / STANDARD_GRAVITY_M_PER_S2.powf(2.5);
    if best.value == 0.0 {
        return Metric::with_value(definition, 0.0)
            .over(resultant.t0_s(), resultant.end_s())
            .remarked("no window has a positive mean");
    }
    Metric::with_value(definition, value).over(resultant.time_s(best.start), resultant.time_s(best.end))
}

fn definition(window_s: f64) -> &'static Definition {
    if (window_s - HIC15_WINDOW_S).abs() < 1e-12 {
        &HIC15
    } else if (window_s - HIC36_WINDOW_S).abs() < 1e-12 {
        &HIC36
    } else {
        &HIC
    }
}

/// HIC(d) = 0.75446·HIC36 + 166.4 of a free-motion headform, FMVSS 201; its window is that of HIC36.
pub fn hic_d(resultant: &Signal<Acceleration>) -> Metric {
    let hic36 = hic(resultant, HIC36_WINDOW_S);
    let metric = Metric::of(&HICD, hic36.value.map(hic_d_of), hic36.definition.trim_start_matches("absent: "));
    Metric { window: hic36.window, ..metric }
}

/// HIC(d) of a known HIC36.
pub fn hic_d_of(hic36: f64) -> f64 {
    0.75446 * hic36 + 166.4
}

// The pair of samples with the largest `d^2.5/n^1.5`, d the change of V (in sampling intervals) over n intervals.
//
// With V the cumulative trapezoid in sampling intervals T, HIC over the samples i < j is
// `(j - i) T ((V_j - V_i)/((j - i) g))^2.5`: apart from constants `d^2.5/n^1.5`. A window that starts or ends between
// two samples can be better by some 1e-4 at 10 kHz; definitions in use are over samples.

/// The best pair; value 0 if no pair has a positive mean.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Best {
    /// `d^2.5/n^1.5`.
    value: f64,
    /// First sample.
    start: usize,
    /// Last sample.
    end: usize,
}

const NONE: Best = Best { value: 0.0, start: 0, end: 0 };

/// Samples of a block at the bottom of the search.
const LEAF: usize = 4;

/// `d^2.5/n^1.5` of a positive change d over n intervals: grows with d, falls with n.
fn criterion(d: f64, n: usize) -> f64 {
    let mean = d / n as f64;
    d * mean * mean.sqrt()
}

/// The changes of V: cumulative trapezoid in units of the sampling interval.
fn cumulative(a: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut v = Vec::with_capacity(a.len());
    v.push(0.0);
    v.extend(a.windows(2).map(|pair| {
        sum += (pair[0] + pair[1]) / 2.0;
        sum
    }));
    v
}

/// Every pair.
fn all_pairs(a: &[f64], longest: usize) -> Best {
    let v = cumulative(a);
    let mut best = NONE;
    for i in 0..v.len() {
        for j in i + 1..v.len().min(i + longest + 1) {
            consider(&v, i, j, &mut best);
        }
    }
    best
}

#[inline]
fn consider(v: &[f64], i: usize, j: usize, best: &mut Best) {
    let d = v[j] - v[i];
    // An infinite change would make every later comparison false; it is passed on and ends as "not computable".
    if d > 0.0 {
        let value = criterion(d, j - i);
        if value > best.value {
            *best = Best { value, start: i, end: j };
        }
    }
}

/// The same maximum by branch and bound, chunk by chunk: memory of a few windows, whatever the length of the record.
///
/// Starts and ends are taken in blocks of 4·2^k samples. For a start in block I and an end in block J,
/// `d <= max V(J) - min V(I)` and `n >= first(J) - last(I)`, and the criterion grows with d and falls with n: their
/// criterion bounds all pairs of (I, J). Also, the mean is at most the largest a from I to J and n at most their span
/// and the longest window, which bounds it by `n·a^2.5`. A pair of blocks whose bound does not exceed the best value
/// seen by more than rounding is passed over with all its pairs of samples; the others are split in four.
fn pruned(a: &[f64], longest: usize) -> Best {
    let chunk = (8 * longest).max(4096);
    let mut best = NONE;
    let mut from = 0;
    while from + 1 < a.len() {
        // Starts in from..from+chunk; the ends reach one window further.
        let to = a.len().min(from + chunk + longest);
        let part = &a[from..to];
        let mut best_of_part = Best { value: best.value, ..NONE };
        if exceeds(bound_of_peak(part, longest), best.value) {
            Search::new(part, longest).run(&mut best_of_part);
        }
        if best_of_part.value > best.value {
            best = Best { value: best_of_part.value, start: from + best_of_part.start, end: from + best_of_part.end };
        }
        from += chunk;
    }
    best
}

/// Bounds and values have roundings of some 1e-15 of themselves. What is passed over is better by less than this share,
/// so that equal windows of a plateau are tried once.
const EQUAL: f64 = 2e-13;

/// Whether a bound is above the best value by more than rounding.
fn exceeds(bound: f64, best: f64) -> bool {
    bound > best * (1.0 + EQUAL)
}

/// No window has a mean above the largest sample or a length above the longest.
fn bound_of_peak(a: &[f64], longest: usize) -> f64 {
    let peak = largest(a).max(0.0);
    criterion(peak * longest as f64, longest)
}

/// Largest sample; minus infinity without any.
fn largest(a: &[f64]) -> f64 {
    // Four independent maxima: the loop waits for none.
    let mut lanes = [f64::NEG_INFINITY; 4];
    let (blocks, rest) = a.as_chunks::<4>();
    for block in blocks {
        for (lane, &value) in lanes.iter_mut().zip(block) {
            *lane = if value > *lane { value } else { *lane };
        }
    }
    rest.iter().chain(&lanes).fold(f64::NEG_INFINITY, |m, &value| if value > m { value } else { m })
}

/// What is known of one block of samples.
#[derive(Debug, Clone, Copy)]
struct Block {
    v_low: f64,
    v_high: f64,
    a_high: f64,
}

/// One chunk with its pyramid of blocks.
struct Search {
    v: Vec<f64>,
    /// Level 0 has blocks of [`LEAF`] samples, every level above twice as many.
    levels: Vec<Vec<Block>>,
    longest: usize,
}

impl Search {
    fn new(a: &[f64], longest: usize) -> Self {
        let v = cumulative(a);
        let leaf = |(v, a): (&[f64], &[f64])| {
            let (mut low, mut high) = (v[0], v[0]);
            for &value in v {
                low = if value < low { value } else { low };
                high = if value > high { value } else { high };
            }
            Block { v_low: low, v_high: high, a_high: a.iter().fold(a[0], |m, &a| if a > m { a } else { m }) }
        };
        let mut levels = vec![v.chunks(LEAF).zip(a.chunks(LEAF)).map(leaf).collect::<Vec<Block>>()];
        let mut size = LEAF;
        while 2 * size <= longest {
            size *= 2;
            let merge = |pair: &[Block]| {
                let (first, last) = (pair[0], pair[pair.len() - 1]);
                Block {
                    v_low: first.v_low.min(last.v_low),
                    v_high: first.v_high.max(last.v_high),
                    a_high: first.a_high.max(last.a_high),
                }
            };
            let above = levels[levels.len() - 1].chunks(2).map(merge).collect();
            levels.push(above);
        }
        Self { v, levels, longest }
    }

    fn run(&self, best: &mut Best) {
        self.prime(best);
        let top = self.levels.len() - 1;
        let (size, blocks) = (LEAF << top, self.levels[top].len());
        // A window reaches this many blocks ahead.
        let reach = self.longest.div_ceil(size);
        for start in 0..blocks {
            for end in start..blocks.min(start + reach + 1) {
                let a_high = self.levels[top][start..=end]
                    .iter()
                    .fold(0.0, |m, block| if block.a_high > m { block.a_high } else { m });
                self.descend(top, start, end, a_high, best);
            }
        }
    }

    /// A good value to prune with: some lengths at coarse steps.
    fn prime(&self, best: &mut Best) {
        let step = (self.longest / 8).max(1);
        for eighths in 1..=8 {
            let length = (self.longest * eighths / 8).max(1);
            for i in (0..self.v.len().saturating_sub(length)).step_by(step) {
                consider(&self.v, i, i + length, best);
            }
        }
    }

    /// Tries all pairs of a block of starts and a block of ends that may be better; no sample between is above
    /// `a_high`.
    fn descend(&self, level: usize, start: usize, end: usize, a_high: f64, best: &mut Best) {
        let (bound, a_high) = self.bound(level, start, end, a_high);
        if !exceeds(bound, best.value) {
            return;
        }
        if level == 0 {
            let (from, to) = (start * LEAF, ((start + 1) * LEAF).min(self.v.len()));
            for i in from..to {
                let last = ((end + 1) * LEAF).min(self.v.len()).min(i + self.longest + 1);
                for j in (end * LEAF).max(i + 1)..last {
                    consider(&self.v, i, j, best);
                }
            }
            return;
        }
        let below = self.levels[level - 1].len();
        for start in 2 * start..(2 * start + 2).min(below) {
            for end in (2 * end).max(start)..(2 * end + 2).min(below) {
                self.descend(level - 1, start, end, a_high, best);
            }
        }
    }

    /// No pair with a start in one block and an end in the other exceeds this; and the largest sample among them, 0 at
    /// least.
    fn bound(&self, level: usize, start: usize, end: usize, a_high: f64) -> (f64, f64) {
        let size = LEAF << level;
        let (from, to) = (&self.levels[level][start], &self.levels[level][end]);
        // Nothing lies between the same or neighbouring blocks.
        let a_high = if end - start <= 1 { from.a_high.max(to.a_high).max(0.0) } else { a_high };
        // Intervals between the last sample of one and the first of the other.
        let shortest = ((end - start) * size).saturating_sub(size - 1).max(1);
        let d = to.v_high - from.v_low;
        if shortest > self.longest || d <= 0.0 {
            return (0.0, a_high);
        }
        let span = ((end - start + 1) * size - 1).min(self.longest);
        let (by_change, by_peak) = (criterion(d, shortest), criterion(a_high * span as f64, span));
        (if by_peak < by_change { by_peak } else { by_change }, a_high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(level_g: f64) -> Signal<Acceleration> {
        let a = (0..1001).map(|k| if (100..=300).contains(&k) { level_g * STANDARD_GRAVITY_M_PER_S2 } else { 0.0 });
        Signal::new(0.0, 1e-4, a.collect()).unwrap()
    }

    #[test]
    fn a_square_pulse_follows_the_formula() {
        let exact = 60.0_f64.powf(2.5) * 0.015;
        let metric = hic(&square(60.0), HIC15_WINDOW_S);
        // The running sum of 1001 samples rounds by 1.1e-13 of it at most; the power takes that 2.5 times.
        let rounding = 2.5 * 1001.0 * f64::EPSILON / 2.0;
        assert!((metric.value.unwrap() / exact - 1.0).abs() < rounding);
        let window = metric.window.unwrap();
        // Two multiples of 1e-4 s below 0.03 s, each rounded twice.
        assert!((window.to_s - window.from_s - 0.015).abs() < 4.0 * 0.03 * f64::EPSILON);
        assert_eq!(metric.id, "hic15-fmvss208");
        // 420.8 of it is the HIC36, rounded as above.
        let hic_d_exact = 0.75446 * 60.0_f64.powf(2.5) * 0.02 + 166.4;
        assert!((hic_d(&square(60.0)).value.unwrap() - hic_d_exact).abs() < 421.0 * rounding);
    }

    #[test]
    fn windows_and_records_without_a_pair_are_absent() {
        assert!(hic(&Signal::new(0.0, 1e-4, vec![1.0]).unwrap(), 0.015).value.is_none());
        assert!(hic(&Signal::new(0.0, 0.1, vec![1.0; 9]).unwrap(), 0.015).value.is_none());
        assert_eq!(hic(&Signal::new(0.0, 1e-4, vec![-1.0; 9]).unwrap(), 0.015).value, Some(0.0));
        // Overflow is no number.
        assert!(hic(&Signal::new(0.0, 1e-4, vec![1e300; 9]).unwrap(), 0.015).value.is_none());
    }

    #[test]
    fn no_pair_of_two_blocks_exceeds_their_bound() {
        let share = |k: usize, stream: f64| (k as f64 * stream).fract();
        for number in 1..40_usize {
            let longest = [1, 3, 9, 17, 40, 100][number % 6];
            let n = 20 + 13 * number % 170;
            let level = 2.0 * share(number, 0.324_718) - 1.0;
            let a: Vec<f64> = (0..n).map(|k| share(k + number, 0.618_034) - level).collect();
            let search = Search::new(&a, longest);
            for level in 0..search.levels.len() {
                let (size, blocks) = (LEAF << level, search.levels[level].len());
                for (start, end) in (0..blocks).flat_map(|start| (start..blocks).map(move |end| (start, end))) {
                    let between = start * size..n.min((end + 1) * size);
                    let a_high = a[between].iter().copied().fold(0.0, f64::max);
                    let (bound, high) = search.bound(level, start, end, a_high);
                    let mut best = NONE;
                    for i in start * size..n.min((start + 1) * size) {
                        for j in (i + 1).max(end * size)..n.min((end + 1) * size).min(i + longest + 1) {
                            consider(&search.v, i, j, &mut best);
                        }
                    }
                    // Roundings of some 1e-15, as `exceeds` allows for.
                    assert!(bound >= best.value * (1.0 - EQUAL), "{number} {level} {start} {end}: {bound} {best:?}");
                    assert!(high >= a_high || end - start > 1, "{high} {a_high}");
                }
            }
        }
    }

    #[test]
    fn a_bound_is_exceeded_by_more_than_rounding_alone() {
        for best in [1e-3, 1.0, 1e6] {
            assert!(exceeds(best * (1.0 + 1e-12), best) && exceeds(best, 0.0));
            assert!(!exceeds(best, best) && !exceeds(best * (1.0 + 1e-13), best) && !exceeds(0.9 * best, best));
        }
        // A record of one value: once the longest window is seen nothing is left to try.
        let a = vec![8.0; 5000];
        let mut best = NONE;
        Search::new(&a, 100).run(&mut best);
        assert_eq!((best.end - best.start, best.start), (100, 0));
    }

    #[test]
    fn blocks_find_what_all_pairs_find() {
        // A deterministic mixture of scales, signs and plateaus; lengths that fill no block evenly.
        let mut state = 1_u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.3
        };
        for (n, longest) in [(2, 1), (7, 3), (100, 99), (1000, 1), (1000, 37), (5000, 150), (9001, 360), (9001, 4)] {
            let white: Vec<f64> = (0..n).map(|_| noise()).collect();
            let smooth: Vec<f64> = (0..n).map(|k| (k as f64 * 0.01).sin() * 50.0).collect();
            let flat = vec![3.0; n];
            for a in [white, smooth, flat] {
                let (all, fast) = (all_pairs(&a, longest), pruned(&a, longest));
                // The sums of a chunk start at its own first sample: other roundings, some 1e-15 of V.
                assert!((fast.value / all.value - 1.0).abs() < 1e-12, "{n} {longest}: {fast:?} {all:?}");
                assert!(fast.end - fast.start <= longest);
            }
        }
    }
}
