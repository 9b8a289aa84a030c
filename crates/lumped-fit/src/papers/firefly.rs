//! The firefly search of the single-mass paper for the second nonlinear model, in its own units and in the unit box.

use crumple_lumped::{Model, Nonlinear2};
use crumple_numerics::estimation::minimise::StopReason;
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_signal::{Displacement, Signal};

use crate::error::positive;
use crate::fit::options::SingleMassFitOptions;
use crate::{Fit, SolveError};

/// Units in which distances between fireflies are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FireflyUnits {
    /// As printed: N/m, N·s/m, m and m/s side by side. The attraction `exp(-gamma r²)` of two fireflies that differ by
    /// a thousandth of one stiffness range is below the smallest number, so every firefly walks at random.
    Physical,
    /// Every variable over its range: the attraction acts.
    #[default]
    Unit,
}

/// Constants of the search; the defaults are the printed ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FireflyOptions {
    /// Units of distance.
    pub units: FireflyUnits,
    /// Fireflies.
    pub fireflies: usize,
    /// Generations.
    pub generations: usize,
    /// First width of the random step, in units of the range; halves every 500 generations.
    pub alpha: f64,
    /// Attraction at no distance (`beta0` of the paper); 0 leaves the random walk alone.
    pub beta0: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for FireflyOptions {
    fn default() -> Self {
        Self { units: FireflyUnits::Unit, fireflies: 40, generations: 500, alpha: 0.005, beta0: 1.0, seed: 1 }
    }
}

/// The best firefly, its fit, and how strongly fireflies attracted each other.
#[derive(Debug, Clone, PartialEq)]
pub struct FireflyResult {
    /// The model.
    pub model: Nonlinear2,
    /// The fit.
    pub fit: Fit,
    /// Attraction at the mean squared distance of the first generation: zero means a random walk.
    pub attraction: f64,
}

/// Upper bound of the coefficients as printed (Table 4), N/m and N·s/m; knots reach up to crush and impact speed.
const COEFFICIENT: f64 = 1e6;

/// The model at a place of the unit box: every variable times its range, order `k1 k2 k3 x1 c1 c2 c3 c4 v1 v2`. The
/// two knots of the damper are put in rising order, each with its value.
fn model_at(p: &[f64; 10], range: &[f64; 10], options: &SingleMassFitOptions) -> Nonlinear2 {
    let x: [f64; 10] = std::array::from_fn(|i| p[i] * range[i]);
    let ((v1, c2), (v2, c3)) = if x[8] <= x[9] { ((x[8], x[5]), (x[9], x[6])) } else { ((x[9], x[6]), (x[8], x[5])) };
    Nonlinear2 {
        mass_kg: options.mass_kg,
        k1_n_per_m: x[0],
        k2_n_per_m: x[1],
        k3_n_per_m: x[2],
        x1_m: x[3],
        c1_n_s_per_m: x[4],
        c2_n_s_per_m: c2,
        c3_n_s_per_m: c3,
        c4_n_s_per_m: x[7],
        v1_m_per_s: v1,
        v2_m_per_s: v2,
        crush_m: options.crush_m,
        v0_m_per_s: options.impact_speed_m_per_s,
    }
}

/// Firefly search for the ten parameters of the second nonlinear model.
///
/// Each firefly moves towards every brighter one,
/// `x_i += beta0 exp(-gamma r²)(x_j - x_i) + alpha (random - 1/2) range`, with `gamma = 1/sqrt(L)` and `L` the length
/// of the box's diagonal (single-mass paper, section 5.5; Yang 2009). A model without a response is dark. The same seed
/// gives the same result on every machine.
///
/// A population search ends near a minimum, not in it: [`fit_as_measured`](crate::fit_as_measured) is better by orders
/// of magnitude and faster. Errors: as that fit.
pub fn firefly_nonlinear2(
    displacement: &Signal<Displacement>,
    options: &SingleMassFitOptions,
    search: &FireflyOptions,
) -> Result<FireflyResult, SolveError> {
    positive("mass_kg", options.mass_kg)?;
    let v0 = positive("impact_speed_m_per_s", options.impact_speed_m_per_s)?;
    let crush = positive("crush_m", options.crush_m)?;
    let observed = options.observed(displacement)?;
    let c = COEFFICIENT;
    let range = [c, c, c, crush, c, c, c, c, v0, v0];
    let build = |p: &[f64; 10]| model_at(p, &range, options);
    let mut evaluations = 0;
    let mut cost = |p: &[f64; 10]| -> f64 {
        evaluations += 1;
        let misfit = observed.misfit(&Model::Nonlinear2(build(p)));
        misfit.map_or(f64::INFINITY, |misfit| misfit.iter().map(|x| x * x).sum())
    };
    let mut random = RandomNumbers::seeded(search.seed);
    // Positions are shares of the range; distances in the units asked for.
    let scale: [f64; 10] = match search.units {
        FireflyUnits::Physical => range,
        FireflyUnits::Unit => [1.0; 10],
    };
    let length = scale.iter().map(|s| s * s).sum::<f64>().sqrt();
    let gamma = length.sqrt().recip();
    let attraction = |a: &[f64; 10], b: &[f64; 10]| {
        let square: f64 = (0..10).map(|i| ((a[i] - b[i]) * scale[i]).powi(2)).sum();
        search.beta0 * (-gamma * square).exp()
    };
    let mut swarm: Vec<[f64; 10]> = (0..search.fireflies).map(|_| std::array::from_fn(|_| random.uniform())).collect();
    let mut costs: Vec<f64> = swarm.iter().map(&mut cost).collect();
    let mut pairs = 0.0;
    let mut pulled = 0.0;
    for i in 0..swarm.len() {
        for j in 0..i {
            pulled += attraction(&swarm[i], &swarm[j]);
            pairs += 1.0;
        }
    }
    let mut alpha = search.alpha;
    let delta = 0.5_f64.powf(1.0 / 500.0);
    let first = costs.iter().zip(&swarm).min_by(|a, b| a.0.total_cmp(b.0));
    let mut best = first.map_or((f64::INFINITY, [0.5; 10]), |(cost, place)| (*cost, *place));
    for _ in 0..search.generations {
        for i in 0..swarm.len() {
            for j in 0..swarm.len() {
                if costs[j] < costs[i] {
                    let pull = attraction(&swarm[i], &swarm[j]);
                    let target = swarm[j];
                    for (x, t) in swarm[i].iter_mut().zip(target) {
                        *x = (*x + pull * (t - *x) + alpha * (random.uniform() - 0.5)).clamp(0.0, 1.0);
                    }
                }
            }
        }
        for (i, p) in swarm.iter().enumerate() {
            costs[i] = cost(p);
            if costs[i] < best.0 {
                best = (costs[i], *p);
            }
        }
        alpha *= delta;
    }
    if !best.0.is_finite() {
        return Err(SolveError::NoFit { starts: search.fireflies });
    }
    Ok(FireflyResult {
        model: build(&best.1),
        fit: Fit::of_waves(
            &observed,
            &[(best.0 / observed.rows() as f64).sqrt()],
            Vec::new(),
            (u32::try_from(search.generations).unwrap_or(u32::MAX), evaluations, StopReason::IterationLimit),
            Vec::new(),
        ),
        attraction: if pairs > 0.0 { pulled / pairs } else { 0.0 },
    })
}
