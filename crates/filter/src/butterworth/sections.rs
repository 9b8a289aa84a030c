//! Runs the sections of a Butterworth filter over a record, both ways or forward.

use crate::butterworth::design::{Design, Section};
use crate::butterworth::pass::Phase;
use crate::recursion::second_order::Recursion;

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
    for section in &design.sections {
        let start = work[0];
        run(work.iter_mut(), section, start);
    }
    if design.asked.phase == Phase::Zero {
        for section in &design.sections {
            let start = work[work.len() - 1];
            run(work.iter_mut().rev(), section, start);
        }
        work.copy_within(added..added + n, 0);
        work.truncate(n);
    }
    work
}

/// Runs one section over samples in the order given, in place. Before the first of them the input was `start` for ever,
/// so the output was `start` times the gain at 0 Hz, `(a0 + a1 + a2)/(1 - b1 - b2)`.
fn run<'a>(samples: impl Iterator<Item = &'a mut f64>, section: &Section, start: f64) {
    let [a0, a1, a2, b1, b2] = *section;
    // Gain at frequency 0; the denominator of a stable filter is not zero there.
    let rest = start * (a0 + a1 + a2) / (1.0 - b1 - b2);
    let mut state = Recursion::new(*section, [start; 2], rest);
    state.in_place(samples);
}
