//! Methods as papers print them, for reproduction and comparison.

use std::fmt;
use std::str::FromStr;

use crumple_lumped::{Complex, DoubleSpringMassDamper, Model, Nonlinear1, Nonlinear2};
use crumple_numerics::estimation::minimise::StopReason;
use crumple_numerics::estimation::minimise::interior_point::{Evaluated, InteriorPoint, Program, interior_point};
use crumple_numerics::estimation::minimise::levenberg_marquardt::Response;
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_signal::{Displacement, Note, Notes, Signal};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::candidate::{Candidate, Fit, Method};
use crate::closed_form::MaxwellExponents;
use crate::error::{SolveError, positive};
use crate::fit::nonlinear::{KNOTS, coordinates, parts};
use crate::fit::problem::{AtCrush, Problem, SingleMassFitOptions};
use crate::matching::{Identified, Matched, PrintedPolynomial, Quartic};
use crate::parameters::Map;

/// Least squares of `y = intercept + slope x`, as `(intercept, slope)`. Sums are taken about the mean, which avoids
/// cancellation.
fn line(x: &[f64], y: impl Fn(usize) -> f64) -> (f64, f64) {
    let n = x.len() as f64;
    let mean_x = x.iter().sum::<f64>() / n;
    let mean_y = (0..x.len()).map(&y).sum::<f64>() / n;
    let power: f64 = x.iter().map(|x| (x - mean_x).powi(2)).sum();
    let product: f64 = x.iter().enumerate().map(|(k, x)| (x - mean_x) * (y(k) - mean_y)).sum();
    let slope = product / power;
    (mean_y - slope * mean_x, slope)
}

/// `(k2, c2)` with `m2 s² + c2 s + k2 = C` in the sense of least squares (ERA paper, equations 19 to 22, with the
/// transposed matrix that the print leaves out).
///
/// **Not a method to use.** An amplitude is known up to one factor for each exponent, so metres are set equal to N/m
/// here; of the result 99.97 % is `m2` times the straight line through `s²`. From the exponents alone
/// [`CoefficientMatching`](crumple_lumped::CoefficientMatching) gives every model there is.
pub fn rear_from_amplitudes(exponents_per_s: &[f64], amplitudes_m: &[f64], m2_kg: f64) -> (f64, f64) {
    line(exponents_per_s, |k| amplitudes_m[k] - m2_kg * exponents_per_s[k].powi(2))
}

/// `(k1, c1)`, N/m and N·s/m, with `m1 s² + (c1 + c2) s + k1 + k2 = (c2 s + k2)²/(m2 s² + c2 s + k2)` at every
/// exponent `s`, in the sense of least squares (ERA paper, equations 6 and 23 to 25). Exact where the exponents are
/// poles of such a model; as they are not, dampers and springs can come out negative.
pub fn front_from_amplitudes(exponents_per_s: &[f64], m1_kg: f64, m2_kg: f64, (k2, c2): (f64, f64)) -> (f64, f64) {
    line(exponents_per_s, |k| {
        let s = exponents_per_s[k];
        let coupling = c2 * s + k2;
        coupling * coupling / (m2_kg * s * s + coupling) - m1_kg * s * s - coupling
    })
}

// The curve fit of the ERA paper as a method: for reproduction, and labelled so in every candidate.

/// Springs and dampers of the double model from four real exponents and amplitudes of the displacement, by equations 17
/// to 25 of the ERA paper.
///
/// **For reproduction, not for use.** The amplitude relation `C_1k = m2 s_k² + c2 s_k + k2` holds up to one unknown
/// factor for each exponent, so metres are set equal to N/m and the equations are no consequence of the model; the
/// amplitudes are those of the compartment, used as if they were the chassis's; and the model found does not have the
/// exponents it was found from. Coefficient matching of the same four exponents finds every model that does.
///
/// Errors: masses that are not positive, exponents that coincide.
pub fn curve_fit_of_the_paper(
    id: &str,
    exponents_per_s: &[f64; 4],
    amplitudes_m: &[f64; 4],
    m1_kg: f64,
    m2_kg: f64,
    index: usize,
) -> Result<Candidate, SolveError> {
    let (k2, c2) = rear_from_amplitudes(exponents_per_s, amplitudes_m, m2_kg);
    let (k1, c1) = front_from_amplitudes(exponents_per_s, m1_kg, m2_kg, (k2, c2));
    let model =
        DoubleSpringMassDamper { m1_kg, m2_kg, k1_n_per_m: k1, k2_n_per_m: k2, c1_n_s_per_m: c1, c2_n_s_per_m: c2 };
    model.check()?;
    let [_, t, u, v, w] = model.characteristic_polynomial();
    // How far each exponent is from a root of the model it led to: p(s) over the sum of its parts.
    let miss = exponents_per_s
        .iter()
        .map(|s| {
            let terms = [s.powi(4), t * s.powi(3), u * s * s, v * s, w];
            terms.iter().sum::<f64>().abs() / terms.iter().map(|x| x.abs()).sum::<f64>()
        })
        .fold(0.0, f64::max);
    let notes = vec![
        Note::warning(format!(
            "as the ERA paper prints it (equations 17 to 25, proper least squares), from {id}; for reproduction, not \
             for use"
        )),
        Note::info(
            "equations 19 to 25 are not a consequence of the model: an amplitude is known up to one factor for each \
             exponent, so metres are set equal to N/m, and nearly all of k2 and c2 is m2 times a straight line through \
             s²",
        ),
        Note::info(format!(
            "the model does not have the exponents it was made from: its characteristic polynomial misses zero there \
             by up to {:.1} % of its parts; coefficient-matching of the same exponents finds every model that has them",
            100.0 * miss
        )),
    ];
    Ok(Candidate::new(Model::DoubleSpringMassDamper(model), Method::CurveFit, index, notes))
}

// The firefly search of the single-mass paper for the second nonlinear model, in its own units and in the unit box.

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

impl FromStr for FireflyUnits {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = [Self::Physical, Self::Unit].into_iter().find(|units| units.to_string() == text);
        known.ok_or_else(|| format!("unknown units {text:?}, expected physical or unit"))
    }
}

impl fmt::Display for FireflyUnits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Physical => "physical",
            Self::Unit => "unit",
        })
    }
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

impl SingleMassFitOptions {
    /// Firefly search for the ten parameters of the second nonlinear model.
    ///
    /// Each firefly moves towards every brighter one, `x_i += beta0 exp(-gamma r²)(x_j - x_i) + alpha (random - 1/2)
    /// range`, with `gamma = 1/sqrt(L)` and `L` the length of the box's diagonal (single-mass paper, section 5.5; Yang
    /// 2009). A model without a response is dark. The same seed gives the same result on every machine.
    ///
    /// A population search ends near a minimum, not in it: [`fit_as_measured`](crate::fit_as_measured) is better by
    /// orders of magnitude and faster. Errors: as that fit.
    pub fn firefly_nonlinear2(
        &self,
        displacement: &Signal<Displacement>,
        search: &FireflyOptions,
    ) -> Result<FireflyResult, SolveError> {
        positive("mass_kg", self.mass_kg)?;
        let v0 = positive("impact_speed_m_per_s", self.impact_speed_m_per_s)?;
        let crush = positive("crush_m", self.crush_m)?;
        let usual = FireflyOptions::default();
        let searches =
            search.fireflies.saturating_mul(search.generations).div_ceil(usual.fireflies * usual.generations);
        let observed = self.observed(displacement)?.limited(searches);
        let c = COEFFICIENT;
        let range = [c, c, c, crush, c, c, c, c, v0, v0];
        let build = |p: &[f64; 10]| model_at(p, &range, self);
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
        let mut swarm: Vec<[f64; 10]> =
            (0..search.fireflies).map(|_| std::array::from_fn(|_| random.uniform())).collect();
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
}

// The Maxwell model from an identified sum of exponentials, as the single-mass paper does it.

/// Exponent of the constant over the slowest of the others: above this a decaying one is remarked and a growing one
/// refused.
const CONSTANT: f64 = 0.01;

/// The Maxwell model whose displacement `x = C1 + e^(a t) (...)` has these exponents, 1/s: a real one for the constant
/// and a conjugate pair, or three real ones (single-mass paper, equations 18 to 25).
///
/// The real exponent nearest zero is that of the constant, which the model has at exactly zero; how far it is from
/// there is remarked, and the other two give spring and damper in closed form. Amplitudes play no part: impact speed
/// and start of the record are not used, so a model of the right exponents may still miss the motion. The relative
/// error of `k` is the sum of those of both exponents.
///
/// Errors: another number of exponents, none of them real, a mass that is not positive, an exponent that does not decay
/// (its spring or damper would be negative).
pub fn maxwell_from_sum(id: &str, exponents: &[Complex], mass_kg: f64, index: usize) -> Result<Candidate, SolveError> {
    let count = exponents.len();
    if count != 3 {
        return Err(SolveError::Value {
            name: "number of exponents of the sum",
            value: count as f64,
            expected: "3: one real and a conjugate pair, or three real ones",
        });
    }
    let real = |k: &usize| exponents[*k].im == 0.0;
    let Some(constant) =
        (0..count).filter(real).min_by(|i, j| exponents[*i].re.abs().total_cmp(&exponents[*j].re.abs()))
    else {
        return Err(SolveError::Value {
            name: "number of real exponents of the sum",
            value: 0.0,
            expected: "1 or 3: the model has a constant",
        });
    };
    let rest: Vec<Complex> = (0..count).filter(|k| *k != constant).map(|k| exponents[k]).collect();
    let (a, b) = (rest[0], rest[1]);
    let exponents_of_the_motion = if a.im == 0.0 && b.im == 0.0 {
        MaxwellExponents::Real { a_per_s: 0.5 * (a.re + b.re), b_per_s: 0.5 * (a.re - b.re) }
    } else {
        MaxwellExponents::Complex { a_per_s: 0.5 * (a.re + b.re), b_rad_per_s: a.im }
    };
    let slowest = a.re.abs().min(b.re.abs());
    let near_zero = exponents[constant].re;
    if !near_zero.is_finite() || near_zero > CONSTANT * slowest {
        return Err(SolveError::Value {
            name: "real exponent nearest zero",
            value: near_zero,
            expected: "0, that of the constant, or at most a hundredth of the slowest other: the motion grows without \
                end",
        });
    }
    let model = exponents_of_the_motion.model(mass_kg)?;
    let kind = match exponents_of_the_motion {
        MaxwellExponents::Complex { a_per_s, b_rad_per_s } => {
            format!("{a_per_s:.4} ± {:.4} i 1/s, complex: the mass swings", b_rad_per_s.abs())
        }
        MaxwellExponents::Real { .. } => format!("{:.4} and {:.4} 1/s, real: the mass creeps", a.re, b.re),
    };
    let mut notes = vec![Note::info(format!("from the exponents of {id}: {kind}; amplitudes are not used"))];
    notes.push(if near_zero.abs() > CONSTANT * slowest {
        Note::warning(format!(
            "the exponent taken for the constant is {near_zero:.4} 1/s, 0 in the model, and not small beside \
             {slowest:.4} 1/s: this is hardly the motion of a Maxwell model"
        ))
    } else {
        Note::info(format!("the exponent taken for the constant is {near_zero:.3e} 1/s, 0 in the model"))
    });
    Ok(Candidate::new(Model::Maxwell(model), Method::ClosedForm, index, notes))
}

// The first nonlinear model by the method of its paper: an interior point with side constraints.

/// Names of the free parameters, in the order of `x`.
const NAMES: [&str; 6] =
    ["k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m", "c3_n_s_per_m", "v_thresh_m_per_s"];

/// Knots of the damper that the method starts from, shares of the impact speed. Springs and dampers start in the
/// middle of their range.
const KNEES: [f64; 5] = [0.1, 0.25, 0.4, 0.6, 0.8];

/// The objective in squared hundredths of the crush, so that the method's tolerance of 1e-8 is far below a
/// millimetre.
const OBJECTIVE: f64 = 1e4;

/// Largest violation of the conditions on crush and speed that is accepted, relative.
const FEASIBLE: f64 = 1e-7;

/// The program: `x` holds `k1, k2, c1, c2, c3` over `m (v0/C)²` and `m v0/C`, and the knot over `v0`. The Hessian is
/// that of Gauss and Newton.
struct SideConstraints<'a> {
    /// The misfit of the displacement in units of the crush.
    problem: Problem<'a>,
    /// The conditions at dynamic crush.
    at_crush: AtCrush,
}

impl Program for SideConstraints<'_> {
    /// Objective, conditions at dynamic crush and their derivatives, from two simulations with sensitivities.
    fn evaluate(&self, x: &DVector<f64>) -> Option<Evaluated> {
        let (problem, x) = (&self.problem, x.as_slice());
        let (mut residuals, mut columns) = (DVector::zeros(problem.rows()), DMatrix::zeros(problem.rows(), 6));
        if !(problem.residuals(x, residuals.as_mut_slice()) && problem.sensitivities(x, &mut columns)) {
            return None;
        }
        let places = problem.coordinates.places(&[1, 2, 3, 4, 5, 6]);
        let (conditions, derivatives) = self.at_crush.conditions(&problem.coordinates.structure(x)?, &places)?;
        let slope = |j: usize| problem.coordinates.free[j].slope(x[j]);
        Some(Evaluated {
            f: OBJECTIVE * residuals.norm_squared(),
            gradient: columns.tr_mul(&residuals) * (2.0 * OBJECTIVE),
            hessian: columns.tr_mul(&columns) * (2.0 * OBJECTIVE),
            c: DVector::from_row_slice(&conditions),
            jacobian: DMatrix::from_fn(2, 6, |i, j| slope(j) * derivatives[j][i]),
        })
    }
}

impl SingleMassFitOptions {
    /// Fits the first nonlinear model as the paper does: interior point with `k1 <= k2`, `c1 >= c2 >= c3`, `x(t_m) =
    /// C`, `v(t_m) = 0` as constraints (single-mass paper, section 4.1).
    ///
    /// Begun from five knees of the damper, the best feasible end is taken. Reaches the same point as
    /// [`fit_nonlinear1`](Self::fit_nonlinear1), whose start is a better one. Errors: as that fit; also where no end
    /// meets the constraints.
    pub fn interior_point_nonlinear1(
        &self,
        displacement: &Signal<Displacement>,
    ) -> Result<(Nonlinear1, Fit), SolveError> {
        self.check()?;
        let observed = self.observed(displacement)?;
        let ((k, c), v0) = (self.units(), self.impact_speed_m_per_s);
        let free: Vec<(usize, Map)> = (1..).zip([k, k, c, c, c, v0].map(Map::Share)).collect();
        let coordinates = coordinates(parts(self).template, &free);
        let problem = Problem { unit: self.crush_m, ..Problem::new(&coordinates, &observed, 0.0) };
        let program = SideConstraints { problem, at_crush: AtCrush::new(self) };
        #[rustfmt::skip]
    let g = DMatrix::from_row_slice(7, 6, &[
        1.0,  0.0, 0.0,  0.0,  0.0, 0.0, // k1 >= 0
        -1.0, 1.0, 0.0,  0.0,  0.0, 0.0, // k2 >= k1
        0.0,  0.0, 1.0, -1.0,  0.0, 0.0, // c1 >= c2
        0.0,  0.0, 0.0,  1.0, -1.0, 0.0, // c2 >= c3
        0.0,  0.0, 0.0,  0.0,  1.0, 0.0, // c3 >= 0
        0.0,  0.0, 0.0,  0.0,  0.0, 1.0,
        0.0,  0.0, 0.0,  0.0,  0.0, -1.0,
    ]);
        let h = DVector::from_vec(vec![0.0, 0.0, 0.0, 0.0, 0.0, -KNOTS.0, KNOTS.1]);
        let ends: Vec<Option<InteriorPoint>> = KNEES
            .par_iter()
            .map(|knee| {
                let start = DVector::from_vec(vec![0.4, 0.9, 0.8, 0.3, 0.05, *knee]);
                interior_point(&program, &start, (&g, &h))
            })
            .collect();
        let evaluations = ends.iter().flatten().map(|end| end.evaluations).sum();
        let best = ends
            .into_iter()
            .flatten()
            .filter(|end| end.infeasibility <= FEASIBLE)
            .min_by(|a, b| a.f.total_cmp(&b.f))
            .ok_or(SolveError::NoFit { starts: KNEES.len() })?;
        let gaps = &g * &best.x + &h;
        // What makes two equal, or zero, holds the first of the two.
        let of_gap = [0, 1, 2, 3, 4, 5, 5];
        let active_bounds = (0..7).filter(|i| gaps[*i] < 1e-6).map(|i| NAMES[of_gap[i]].to_owned()).collect();
        let rmse = (best.f / OBJECTIVE / observed.rows() as f64).sqrt() * self.crush_m;
        let fit =
            Fit::of_waves(&observed, &[rmse], Vec::new(), (best.iterations, evaluations, best.stop), active_bounds);
        match coordinates.model(best.x.as_slice()) {
            Some(Model::Nonlinear1(model)) => Ok((model, fit)),
            _ => Err(SolveError::NoFit { starts: KNEES.len() }),
        }
    }
}

// The equations of the transfer-function paper as typed there, for reproduction.

/// The printed denominator `s^4 + 35.7 s^3 + 6024 s^2 + 185000 s + 414600`.
const PRINTED: [f64; 4] = [35.7, 6024.0, 185_000.0, 414_600.0];

/// A fifth of the printed 1422 kg.
const FIFTH_KG: f64 = 284.4;

/// Four fifths of it.
const FOUR_FIFTHS_KG: f64 = 1137.6;

/// What is typed for the smaller mass on the right of the first equation.
const TYPED_KG: f64 = 284.6;

/// The solutions that the paper lists, from its printed polynomial: for reproduction only.
///
/// In the first of the four equations 284.6 kg is typed for 284.4 kg, which is to say that the coefficient of `s^3` is
/// `284.6/284.4` times the printed one. Both splits of the mass: one fifth in front, then four fifths. Candidates are
/// numbered from `first_index`; each says that it is a reproduction.
pub fn match_as_the_paper_typed(first_index: usize, notes: &mut Notes) -> Result<Vec<Matched>, SolveError> {
    let splits = [
        ("tfest-paper/one-fifth-in-front", FIFTH_KG, FOUR_FIFTHS_KG),
        ("tfest-paper/four-fifths-in-front", FOUR_FIFTHS_KG, FIFTH_KG),
    ];
    let [t, u, v, w] = PRINTED;
    let mut results: Vec<Matched> = Vec::new();
    for (id, m1_kg, m2_kg) in splits {
        let typed = t * TYPED_KG / FIFTH_KG;
        let identified = Identified {
            id: id.to_owned(),
            quartic: Quartic::Coefficients([typed, u, v, w]),
            numerator: None,
            source: "printed denominator of the transfer-function paper as typed for its solver,",
            realised: None,
            spread: None,
            delay_s: 0.0,
        };
        let first = first_index + results.iter().map(|matched| matched.candidates.len()).sum::<usize>();
        let mut matched = identified.matched(m1_kg, m2_kg, first, notes)?;
        let label = "for reproduction only: 284.6 kg stands for 284.4 kg in the first right-hand side, as in the \
            paper, which lists k1 and c2 exchanged (its solver answers in the order c1, c2, k1, k2)";
        matched.remarks.push(label.to_owned());
        for candidate in &mut matched.candidates {
            candidate.notes.push(Note::info(label));
        }
        results.push(matched);
    }
    notes.push(PrintedPolynomial {});
    Ok(results)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_lumped::Maxwell;

    const S: [f64; 4] = [-7.754, -6.238, -9.603, -10.87];
    const C: [f64; 4] = [-253.6, 83.75, 333.0, -163.2];

    #[test]
    fn gives_the_rear_of_the_papers_first_case_and_says_what_it_is() {
        let candidate = curve_fit_of_the_paper("exponentials-4", &S, &C, 291.0, 582.0, 1).unwrap();
        let p = candidate.model.parameters();
        // Printed with 5 and 4 digits; the front, recomputed from the printed formulas, is negative.
        assert!((p["k2_n_per_m"] - 40731.0).abs() < 0.5 && (p["c2_n_s_per_m"] - 9952.0).abs() < 0.5, "{p:?}");
        assert!(p["k1_n_per_m"] < 0.0 && !candidate.model.is_physical());
        assert_eq!(candidate.id(), "double-spring-mass-damper/curve-fit/1");
        assert!(candidate.notes[0].to_string().starts_with("warning: as the ERA paper prints it"));
    }

    #[test]
    fn coinciding_exponents_are_an_error() {
        assert!(curve_fit_of_the_paper("x", &[-5.0; 4], &C, 291.0, 582.0, 1).is_err());
    }

    fn exponents(model: &Maxwell) -> [Complex; 3] {
        // r² + (k/c) r + k/m = 0.
        let a = -0.5 * model.stiffness_n_per_m / model.damping_n_s_per_m;
        let square = Complex::new(a * a - model.stiffness_n_per_m / model.mass_kg, 0.0);
        let root = square.sqrt();
        [a + root, Complex::new(0.0, 0.0), a - root]
    }

    #[test]
    fn spring_and_damper_come_back_from_complex_and_from_real_exponents() {
        // Critical at sqrt(k m)/2 = 31,225 N·s/m.
        for damping_n_s_per_m in [60_000.0, 25_000.0] {
            let model = Maxwell { mass_kg: 1300.0, stiffness_n_per_m: 3e6, damping_n_s_per_m };
            let candidate = maxwell_from_sum("exponentials-3", &exponents(&model), 1300.0, 1).unwrap();
            let p = candidate.model.parameters();
            // Ten roundings.
            assert!((p["stiffness_n_per_m"] / 3e6 - 1.0).abs() < 1e-13, "{p:?}");
            assert!((p["damping_n_s_per_m"] / damping_n_s_per_m - 1.0).abs() < 1e-13, "{p:?}");
            assert_eq!(candidate.id(), "maxwell/closed-form/1");
        }
    }

    #[test]
    fn growing_exponents_and_other_forms_are_refused_with_the_reason() {
        let refused = |list: &[(f64, f64)]| {
            let list: Vec<Complex> = list.iter().map(|(re, im)| Complex::new(*re, *im)).collect();
            maxwell_from_sum("x", &list, 900.0, 1).unwrap_err().to_string()
        };
        let growing = refused(&[(0.0, 0.0), (2.0, 30.0), (2.0, -30.0)]);
        assert!(growing.contains("slowest exponent of the fit is 2"), "{growing}");
        let real = refused(&[(-1e-3, 0.0), (0.5, 0.0), (-30.0, 0.0)]);
        assert!(real.contains("slowest exponent of the fit is 0.5"), "{real}");
        let constant = refused(&[(5.0, 0.0), (-20.0, 30.0), (-20.0, -30.0)]);
        assert!(constant.contains("grows without end"), "{constant}");
        assert!(refused(&[(-20.0, 30.0), (-20.0, -30.0)]).contains("expected 3"));
    }

    #[test]
    fn a_constant_that_decays_is_remarked() {
        let list = [(-5.0, 0.0), (-20.0, 30.0), (-20.0, -30.0)].map(|(re, im)| Complex::new(re, im));
        let candidate = maxwell_from_sum("x", &list, 900.0, 1).unwrap();
        assert!(
            candidate.notes[1].to_string().starts_with("warning: the exponent taken for the constant is -5"),
            "{:?}",
            candidate.notes
        );
    }
}
