//! L-SHADE: differential evolution that learns its own step, for problems without a structure to use.
//!
//! The box is `[0, 1]` on every axis: the caller maps it to its unknowns and thereby sets their bounds. A trial point
//! that would leave the box is put half-way between its parent and the bound, so every point evaluated lies inside. No
//! derivative is used, and a cost may be infinite or not a number in parts of the box.

use std::f64::consts::PI;

use rayon::prelude::*;

use crate::estimation::minimise::StopReason;
use crate::estimation::random::RandomNumbers;

/// Constants of the search; the defaults are those of its authors but for the number of evaluations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LShadeOptions {
    /// Evaluations after which it ends.
    pub evaluations: u64,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for LShadeOptions {
    fn default() -> Self {
        Self { evaluations: 20_000, seed: 1 }
    }
}

/// Where the search ended.
#[derive(Debug, Clone, PartialEq)]
pub struct LShadeResult {
    /// Best point of the unit box, one coordinate an axis.
    pub point: Vec<f64>,
    /// Its cost.
    pub cost: f64,
    /// Evaluations of the cost.
    pub evaluations: u64,
    /// Why the search ended.
    pub stop: StopReason,
}

/// Members at the start for each variable.
const MEMBERS_EACH: usize = 18;
/// Members at the end.
const MEMBERS_LAST: usize = 4;
/// Successful steps remembered.
const MEMORY: usize = 6;
/// Share of the best members, of which each trial moves towards one.
const BEST_SHARE: f64 = 0.11;
/// Size of the archive of replaced points, in numbers of members.
const ARCHIVE: f64 = 2.6;

/// A deviate of the Cauchy distribution, by the inverse of its distribution function.
fn cauchy(random: &mut RandomNumbers, mean: f64, width: f64) -> f64 {
    mean + width * (PI * (random.uniform() - 0.5)).tan()
}

/// A point of the population and its cost.
struct Member {
    point: Vec<f64>,
    cost: f64,
}

/// A point that would replace a member, with the constants it was made with.
struct Trial {
    point: Vec<f64>,
    scale: f64,
    crossover: f64,
}

/// Minimises `cost` over the unit box; points without a finite cost count as infinite.
///
/// Success-history adaptation with linear reduction of the population: R. Tanabe, A. Fukunaga, "Improving the search
/// performance of SHADE using linear population size reduction", CEC 2014. Trial points of a generation are drawn one
/// after the other and evaluated side by side, so the result does not depend on the number of threads. Ends near a
/// minimum, not in it.
pub fn l_shade(axes: usize, options: &LShadeOptions, cost: impl Fn(&[f64]) -> f64 + Sync) -> LShadeResult {
    let cost = |point: &[f64]| {
        let value = cost(point);
        if value.is_nan() { f64::INFINITY } else { value }
    };
    let mut random = RandomNumbers::seeded(options.seed);
    let first = (MEMBERS_EACH * axes).max(MEMBERS_LAST);
    let points: Vec<Vec<f64>> = (0..first).map(|_| (0..axes).map(|_| random.uniform()).collect()).collect();
    let costs: Vec<f64> = points.par_iter().map(|point| cost(point)).collect();
    let mut members: Vec<Member> = points.into_iter().zip(costs).map(|(point, cost)| Member { point, cost }).collect();
    let mut evaluations = first as u64;
    let mut archive: Vec<Vec<f64>> = Vec::new();
    // Means of scale and crossover; a crossover of none has died out.
    let mut memory = [(0.5, Some(0.5)); MEMORY];
    let mut oldest = 0;
    members.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let stop = loop {
        let spread = members[members.len() - 1].cost - members[0].cost;
        if spread <= 1e-15 * members[0].cost {
            break StopReason::CostConverged;
        }
        if evaluations >= options.evaluations {
            break StopReason::IterationLimit;
        }
        let trials: Vec<Trial> = (0..members.len())
            .map(|i| trial(i, &members, &archive, memory[random.below(MEMORY)], &mut random))
            .collect();
        let costs: Vec<f64> = trials.par_iter().map(|trial| cost(&trial.point)).collect();
        evaluations += trials.len() as u64;

        let mut gains = Vec::new();
        for ((member, trial), cost) in members.iter_mut().zip(trials).zip(costs) {
            if cost < member.cost {
                let gain = if member.cost.is_finite() { member.cost - cost } else { 1.0 };
                gains.push((gain, trial.scale, trial.crossover));
                archive.push(std::mem::replace(&mut member.point, trial.point));
                member.cost = cost;
            } else if cost == member.cost {
                member.point = trial.point;
            }
        }
        if !gains.is_empty() {
            memory[oldest] = successful_means(&gains, memory[oldest].1);
            oldest = (oldest + 1) % MEMORY;
        }
        let done = (evaluations as f64 / options.evaluations as f64).min(1.0);
        let wanted = first as f64 + (MEMBERS_LAST as f64 - first as f64) * done;
        members.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        members.truncate((wanted.round() as usize).max(MEMBERS_LAST));
        let most = (ARCHIVE * members.len() as f64) as usize;
        while archive.len() > most {
            let place = random.below(archive.len());
            archive.swap_remove(place);
        }
    };
    let best = members.swap_remove(0);
    LShadeResult { point: best.point, cost: best.cost, evaluations, stop }
}

/// `x + F (best - x) + F (r1 - r2)`, crossed with `x`. Members are sorted by cost.
fn trial(
    i: usize,
    members: &[Member],
    archive: &[Vec<f64>],
    (scale, crossover): (f64, Option<f64>),
    random: &mut RandomNumbers,
) -> Trial {
    let crossover = crossover.map_or(0.0, |mean| (mean + 0.1 * random.normal()).clamp(0.0, 1.0));
    let scale = loop {
        let drawn = cauchy(random, scale, 0.1);
        if drawn > 0.0 {
            break drawn.min(1.0);
        }
    };
    let best = &members[random.below(((BEST_SHARE * members.len() as f64).round() as usize).max(2))].point;
    let first = loop {
        let drawn = random.below(members.len());
        if drawn != i {
            break drawn;
        }
    };
    let second = loop {
        let drawn = random.below(members.len() + archive.len());
        if drawn != i && drawn != first {
            break members.get(drawn).map_or_else(|| &archive[drawn - members.len()], |member| &member.point);
        }
    };
    let (x, first) = (&members[i].point, &members[first].point);
    let always = random.below(x.len());
    let point = (0..x.len())
        .map(|j| {
            if j != always && random.uniform() > crossover {
                return x[j];
            }
            let moved = x[j] + scale * (best[j] - x[j]) + scale * (first[j] - second[j]);
            // Half-way to a bound it would leave by.
            if moved < 0.0 {
                0.5 * x[j]
            } else if moved > 1.0 {
                0.5 * (1.0 + x[j])
            } else {
                moved
            }
        })
        .collect();
    Trial { point, scale, crossover }
}

/// Lehmer means `sum w s² / sum w s` of scale and crossover over the trials that replaced a member, weighted by the
/// decrease of the cost. A crossover of which all were zero stays zero (`None`), as its authors have it.
fn successful_means(gains: &[(f64, f64, f64)], crossover: Option<f64>) -> (f64, Option<f64>) {
    let total: f64 = gains.iter().map(|(gain, ..)| gain).sum();
    let mean = |constant_of: &dyn Fn(&(f64, f64, f64)) -> f64| {
        let (mut squares, mut sum) = (0.0, 0.0);
        for gain in gains {
            squares += gain.0 / total * constant_of(gain).powi(2);
            sum += gain.0 / total * constant_of(gain);
        }
        if sum > 0.0 { squares / sum } else { 0.0 }
    };
    let died = crossover.is_none() || gains.iter().all(|(.., crossover)| *crossover == 0.0);
    (mean(&|gain| gain.1), if died { None } else { Some(mean(&|gain| gain.2)) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Many minima; the least is 0 at 0.3 on every axis.
    fn rastrigin(point: &[f64]) -> f64 {
        let wave = |x: f64| 10.24 * (x - 0.3);
        point.iter().map(|x| wave(*x).powi(2) + 10.0 * (1.0 - (2.0 * PI * wave(*x)).cos())).sum()
    }

    #[test]
    fn finds_the_least_of_many_minima_and_always_the_same() {
        let options = LShadeOptions { evaluations: 30_000, seed: 5 };
        let result = l_shade(6, &options, rastrigin);
        // 10.24 e^2 near the minimum: a cost of 1e-8 is 1e-5 from it.
        assert!(result.cost < 1e-8, "{result:?}");
        assert_eq!(l_shade(6, &options, rastrigin), result);
        let one = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .map(|p| p.install(|| l_shade(6, &options, rastrigin)));
        assert_eq!(one.ok(), Some(result));
    }

    #[test]
    fn a_cost_that_is_nowhere_finite_ends_all_the_same() {
        let result = l_shade(2, &LShadeOptions { evaluations: 200, seed: 1 }, |_| f64::NAN);
        assert!(result.cost.is_infinite() && result.evaluations >= 200);
    }
}
