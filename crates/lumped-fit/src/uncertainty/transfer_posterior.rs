//! What a record says of a double model while the division of its mass is not known, by way of its transfer function.
//!
//! With `S = m2 k1 + M k2`, `T = m2 c1 + M c2`, `M = m1 + m2`, the compartment's motion after an impact at `v0` is
//!
//! ```text
//! X(s) = v0 (s² + d3 s + n0) / (s⁴ + d3 s³ + n0 (1 + y) s² + d1 s + d0)
//! n0 = S/(m1 m2), d0 = k1 k2/(m1 m2), d3 = T/(m1 m2), d1 = (c1 k2 + c2 k1)/(m1 m2), y = c1 c2/S
//! ```
//!
//! The record determines `n0, d0, d3, d1` and hardly `y`, which is a few percent. In these the motion is nearly
//! straight; in springs and dampers it is not: `m2 k1` and `M k2` are the two roots of one quadratic, which meet where
//! a model is its own dual, and the dampers follow with the difference of the roots as divisor. A grid of shares, or
//! ellipses around a minimum, miss what lies there. Here the likelihood is that of the numbers, which costs nothing to
//! evaluate, and the models that have them are drawn.

use crumple_lumped::{DoubleSpringMassDamper, Model};
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_numerics::estimation::statistics::{quantile, student_95};
use nalgebra::{Cholesky, DMatrix, DVector, Matrix4, Vector4};

use crate::coordinates::Coordinates;
use crate::fit::as_measured::is_own_dual;
use crate::uncertainty::acceleration_likelihood::{AccelerationLikelihood, Ends};

/// Draws of share and noise from which walkers start, and models among them below which none do.
const DRAWS: usize = 2000;
const FEWEST: usize = 20;
/// Walkers, their sweeps, the first that is kept, and how many lie between two that are kept.
const WALKERS: usize = 200;
const SWEEPS: usize = 1100;
const FIRST_KEPT: usize = 100;
const DISTANCE: usize = 5;
/// Values of `y` between which its solutions are looked for, up to so many deviations from the best one; bisections of
/// each.
const SCANNED: u32 = 40;
const FAR: f64 = 6.0;
const BISECTIONS: usize = 24;
/// Linearisations, each at the best numbers of the one before.
const LINEARISATIONS: usize = 3;
/// Shares in front at which the response may be linearised, beside that of the fit: any one gives the same motion.
const SHARES: [f64; 4] = [0.25, 0.35, 0.5, 0.65];
/// Largest `y` of a linearisation.
const LARGEST_Y: f64 = 0.1;
/// Step of the derivatives of the numbers by the coordinates.
const STEP: f64 = 1e-6;

/// Interval, s, and number of the instants at which motions of the front are compared: up to 100 ms.
const COMPARED_DT_S: f64 = 2e-3;
const COMPARED: usize = 51;

/// `ln n0, ln d0, ln d3, ln d1`.
type Numbers = Vector4<f64>;

/// A double model by its springs and dampers: `k1, k2, c1, c2`.
type Springs = [f64; 4];

/// `ln k1, ln k2, c1, c2` and the share in front.
type Point = [f64; 5];

/// The masses `m1, m2`, kg.
type Masses = [f64; 2];

/// The numbers of the transfer function, and `y`.
fn numbers_of([m1, m2]: Masses, [k1, k2, c1, c2]: Springs) -> (Numbers, f64) {
    let (total, product) = (m1 + m2, m1 * m2);
    let sum = m2 * k1 + total * k2;
    let n0 = sum / product;
    let (d0, d3, d1) = (k1 * k2 / product, (m2 * c1 + total * c2) / product, (c1 * k2 + c2 * k1) / product);
    (Numbers::new(n0.ln(), d0.ln(), d3.ln(), d1.ln()), c1 * c2 / sum)
}

/// The springs and dampers of both duals, the one with the larger `m2 k1` first. `None` where no damper that is not
/// negative, or no spring, has these numbers.
fn springs_of([m1, m2]: Masses, numbers: &Numbers) -> Option<[Springs; 2]> {
    let (total, product) = (m1 + m2, m1 * m2);
    let [n0, d0, d3, d1] = [0, 1, 2, 3].map(|i| numbers[i].exp() * product);
    let half = 0.5 * n0;
    let square = half * half - d0 * m2 * total;
    // No number is above zero that is none.
    let root = if square > 0.0 { square.sqrt() } else { return None };
    let (u, w) = (half + root, half - root);
    // x + y = d3 and w x + u y = d1 m2 M for x = m2 c1, y = M c2.
    let mixed = d1 * m2 * total;
    let (x, y) = ((u * d3 - mixed) / (u - w), (mixed - w * d3) / (u - w));
    let found = |u: f64, w: f64, x: f64, y: f64| [u / m2, w / total, x / m2, y / total];
    (w > 0.0 && x >= 0.0 && y >= 0.0).then(|| [found(u, w, x, y), found(w, u, y, x)])
}

/// A record: its likelihood, and the change of its rows by one deviation of each uncertain input.
type Recorded<'a> = (&'a AccelerationLikelihood<'a>, &'a DMatrix<f64>);

/// The likelihood of the numbers: normal for given `y`, and normal in `y`.
struct Likelihood {
    /// Best numbers at `y = 0`, and their change with `y`.
    at_zero: Numbers,
    by_y: Numbers,
    /// Root of their covariance, and its inverse.
    root: Matrix4<f64>,
    inverse: Matrix4<f64>,
    /// Best `y` and its standard deviation.
    y: (f64, f64),
}

impl Likelihood {
    /// From the response at a model, straight in the numbers. The errors of inputs move the best numbers at a given
    /// `y`, and the best `y`; their covariance gains what they move. `None` where it is not determined.
    fn at((source, by_inputs): Recorded<'_>, coordinates: &Coordinates, theta: &[f64], scale: f64) -> Option<Self> {
        let (residuals, by_theta) = source.linear(theta)?;
        let numbers = |theta: &[f64]| {
            let (numbers, y) = of_values(&coordinates.values(theta))?;
            Some(DVector::from_iterator(5, numbers.iter().copied().chain([y])))
        };
        let mut derivatives = DMatrix::zeros(5, 5);
        for j in 0..5 {
            let moved = |step: f64| {
                let mut theta = theta.to_vec();
                theta[j] += step;
                numbers(&theta)
            };
            derivatives.set_column(j, &((moved(STEP)? - moved(-STEP)?) / (2.0 * STEP)));
        }
        let by_number = by_theta * derivatives.try_inverse()?;
        let here = numbers(theta)?;
        let residuals = DVector::from_vec(residuals) * scale;
        let of_four = by_number.columns(0, 4) * scale;
        let of_y = by_number.column(4) * scale;
        let qr = of_four.clone().qr();
        let (q, r) = (qr.q(), qr.r());
        let inverse = r.try_inverse()?;
        let (of_residuals, of_change) = (&inverse * q.tr_mul(&residuals), &inverse * q.tr_mul(&of_y));
        let beside = |column: &DVector<f64>| column - &q * q.tr_mul(column);
        let (left, left_by_y) = (beside(&residuals), beside(&of_y.into_owned()));
        let power = left_by_y.norm_squared();
        let four = |v: &DVector<f64>| Numbers::new(v[0], v[1], v[2], v[3]);
        let by_y = -four(&of_change);
        let best = four(&here) - four(&of_residuals);
        let y = (here[4] - left_by_y.dot(&left) / power, 1.0 / power.sqrt());
        let by_inputs = by_inputs * scale;
        let of_inputs = &inverse * q.tr_mul(&by_inputs);
        let y_by_inputs = by_inputs.tr_mul(&left_by_y) / power;
        let y = (y.0, y.1.hypot(y_by_inputs.norm()));
        // One error moves the numbers and `y`: where `y` is known, so is that part of the numbers.
        let with_y = &of_inputs * y_by_inputs;
        let by_known_y = four(&with_y) / (y.1 * y.1);
        let known = &with_y * with_y.transpose() / (y.1 * y.1);
        let covariance = &inverse * inverse.transpose() + &of_inputs * of_inputs.transpose() - known;
        let root = Cholesky::new(Matrix4::from_fn(|i, j| covariance[(i, j)]))?.l();
        let inverse = root.try_inverse()?;
        let finite = best.iter().chain(by_y.iter()).chain(root.iter()).all(|x| x.is_finite());
        (finite && y.0.is_finite() && y.1.is_finite()).then(|| Self {
            at_zero: best - by_y * here[4] - by_known_y * y.0,
            by_y: by_y + by_known_y,
            root,
            inverse,
            y,
        })
    }

    /// The springs and dampers of both duals whose numbers are `noise` standard deviations from the best ones at their
    /// own `y`, with that: every solution up to six deviations above the best `y`.
    fn solve(&self, masses: Masses, noise: &Numbers) -> Vec<([Springs; 2], f64)> {
        let start = self.at_zero + self.root * noise;
        let largest = self.y.0.max(0.0) + FAR * self.y.1;
        let at = |y: f64| {
            let both = springs_of(masses, &(start + self.by_y * y))?;
            Some((numbers_of(masses, both[0]).1 - y, both))
        };
        let mut found = Vec::new();
        let mut before: Option<(f64, f64)> = None;
        for k in 0..=SCANNED {
            let y = largest * f64::from(k) / f64::from(SCANNED);
            let here = at(y).map(|(excess, _)| (y, excess));
            if let (Some((low, of_low)), Some((high, of_high))) = (before, here)
                && (of_low > 0.0) != (of_high > 0.0)
            {
                let (mut low, mut high) = (low, high);
                for _ in 0..BISECTIONS {
                    let middle = 0.5 * (low + high);
                    let Some((excess, _)) = at(middle) else { break };
                    if (excess > 0.0) == (of_low > 0.0) { low = middle } else { high = middle }
                }
                let y = 0.5 * (low + high);
                found.extend(at(y).map(|(_, both)| (both, y)));
            }
            before = here;
        }
        found
    }

    /// The logarithm of the likelihood of a model, up to a constant; minus infinity for none.
    fn logarithm(&self, masses: Masses, springs: Springs) -> f64 {
        let (numbers, y) = numbers_of(masses, springs);
        let noise = self.inverse * (numbers - self.at_zero - self.by_y * y);
        let of_y = (y - self.y.0) / self.y.1;
        let logarithm = -0.5 * (noise.norm_squared() + of_y * of_y);
        if logarithm.is_nan() { f64::NEG_INFINITY } else { logarithm }
    }

    /// Density of springs, in logarithms, and dampers over that of the noise at a model.
    fn density(&self, [m1, m2]: Masses, [k1, k2, c1, c2]: Springs, y: f64) -> f64 {
        let total = m1 + m2;
        let (u, w) = (m2 * k1, total * k2);
        let (sum, damping, mixed) = (u + w, m2 * c1 + total * c2, c1 * k2 + c2 * k1);
        // By ln k1, ln k2, c1 and c2.
        let by_springs = Matrix4::new(
            u / sum,
            w / sum,
            0.0,
            0.0,
            1.0,
            1.0,
            0.0,
            0.0,
            0.0,
            0.0,
            m2 / damping,
            total / damping,
            c2 * k1 / mixed,
            c1 * k2 / mixed,
            k2 / mixed,
            k1 / mixed,
        );
        let of_y = Vector4::new(-y * u / sum, -y * w / sum, c2 / sum, c1 / sum);
        let determinant = (by_springs - self.by_y * of_y.transpose()).determinant().abs();
        let deviations = (y - self.y.0) / self.y.1;
        (-0.5 * deviations * deviations).exp() / determinant
    }
}

/// The numbers of a double model from its values in their order; `None` for one that has no logarithm.
fn of_values(values: &[f64]) -> Option<(Numbers, f64)> {
    let &[m1, m2, k1, k2, c1, c2] = values else { return None };
    let (numbers, y) = numbers_of([m1, m2], [k1, k2, c1, c2]);
    numbers.iter().all(|x| x.is_finite()).then_some((numbers, y))
}

/// The 95 % intervals of `k1, k2, c1, c2` of a double model when its share in front lies anywhere in `shares`, or is
/// known where these are one: from the 2.5th to the 97.5th percentile of what the record says.
///
/// `recorded`: the misfit with these two springs, two dampers and the mass in front free. Beforehand no share, no
/// logarithm of a spring and no damper, from zero on, is preferred. Draws of share and noise, solved for both duals,
/// are weighted as in importance sampling; near its own dual, where few of them have a model, they are too coarse, so
/// walkers start from them and move by the density itself (Goodman & Weare, Commun. Appl. Math. Comput. Sci. 5, 2010).
/// The intervals are those of the walkers whose front moves more like that of `model` than like that of its dual, see
/// [`front_beside`]. Noise counts as in Student's distribution for the degrees of freedom of its level. The
/// same bytes for any number of threads. Errors: the response is taken as straight in the numbers of the transfer
/// function; 40,000 places of 200 walkers that hang together know an end to some hundredths of the width. `None` where
/// too few draws have a model.
pub(crate) fn intervals(
    recorded: Recorded<'_>,
    coordinates: &Coordinates,
    model: &DoubleSpringMassDamper,
    shares: (f64, f64),
) -> Option<[Ends; 4]> {
    let scale = student_95(f64::INFINITY) / student_95(recorded.0.freedom());
    let total = model.m1_kg + model.m2_kg;
    let masses = |share: f64| [share * total, (1.0 - share) * total];
    let likelihood = linearised(recorded, coordinates, total, scale)?;
    let mut random = RandomNumbers::seeded(0);
    let mut draws: Vec<(Point, f64)> = Vec::with_capacity(2 * DRAWS);
    for _ in 0..DRAWS {
        let share = shares.0 + (shares.1 - shares.0) * random.uniform();
        let noise = Numbers::from_fn(|_, _| random.normal());
        for (both, y) in likelihood.solve(masses(share), &noise) {
            for springs in both {
                let weight = likelihood.density(masses(share), springs, y);
                let [k1, k2, c1, c2] = springs;
                if weight.is_finite() {
                    draws.push(([k1.ln(), k2.ln(), c1, c2, share], weight));
                }
            }
        }
    }
    let mut walkers = resampled(&draws)?;
    let density = |point: &Point| -> f64 {
        let &[k1, k2, c1, c2, share] = point;
        if !(c1 >= 0.0 && c2 >= 0.0 && shares.0 <= share && share <= shares.1) {
            return f64::NEG_INFINITY;
        }
        likelihood.logarithm(masses(share), [k1.exp(), k2.exp(), c1, c2])
    };
    let dimensions = if shares.0 < shares.1 { 5 } else { 4 };
    let mut kept = walk(&mut walkers, dimensions, &density, &mut random);
    let moves_like_model = nearer_than_its_dual(model)?;
    kept.retain(|&[k1, k2, c1, c2, share]| moves_like_model(masses(share), [k1.exp(), k2.exp(), c1, c2]));
    if kept.len() < FEWEST * DISTANCE {
        return None;
    }
    let percentiles = |i: usize| {
        let mut values: Vec<f64> = kept.iter().map(|point| if i < 2 { point[i].exp() } else { point[i] }).collect();
        values.sort_by(f64::total_cmp);
        (quantile(&values, 0.025), quantile(&values, 0.975))
    };
    Some(std::array::from_fn(percentiles))
}

/// Whether the front of a model moves more like that of `model` than like that of its dual, up to 100 ms after contact;
/// any does where `model` is its own dual, which stands for both. `None` for a model without motion.
fn nearer_than_its_dual(model: &DoubleSpringMassDamper) -> Option<impl Fn(Masses, Springs) -> bool> {
    let springs = |m: &DoubleSpringMassDamper| [m.k1_n_per_m, m.k2_n_per_m, m.c1_n_s_per_m, m.c2_n_s_per_m];
    let masses = [model.m1_kg, model.m2_kg];
    let stands_for_both = is_own_dual(&Model::DoubleSpringMassDamper(*model));
    // Motions are proportional to the impact speed.
    let response = Model::DoubleSpringMassDamper(*model).respond(1.0, COMPARED_DT_S, COMPARED).ok()?;
    let compartment = response.compartment().acceleration_m_per_s2.clone();
    let front = |springs| front_beside(&compartment, masses, springs).collect::<Vec<f64>>();
    let (of_model, of_dual) = (front(springs(model)), front(springs(&model.dual())));
    Some(move |masses, springs| {
        let nearer = |sum: f64, (here, (a, b)): (f64, (&f64, &f64))| sum + (here - b).powi(2) - (here - a).powi(2);
        stands_for_both
            || front_beside(&compartment, masses, springs).zip(of_model.iter().zip(&of_dual)).fold(0.0, nearer) >= 0.0
    })
}

/// How far the front is beside the compartment at each instant, m, from the acceleration of the compartment, which is
/// alike in all models that a record allows: `k2 u + c2 u' = m2 a`, exact for an acceleration that is straight between
/// instants.
fn front_beside(compartment: &[f64], [_, m2]: Masses, [_, k2, _, c2]: Springs) -> impl Iterator<Item = f64> {
    let (gain, decay) = (m2 / k2, k2 / c2 * COMPARED_DT_S);
    let left = (-decay).exp();
    let mean = (1.0 - left) / decay;
    compartment.windows(2).scan(0.0, move |beside, pair| {
        *beside = left * *beside + gain * (pair[1] - left * pair[0] - mean * (pair[1] - pair[0]));
        Some(*beside)
    })
}

/// As many points as walkers, drawn by their weights at equal distances of their sum; `None` for too few draws.
fn resampled(draws: &[(Point, f64)]) -> Option<Vec<Point>> {
    let sum: f64 = draws.iter().map(|(_, weight)| weight).sum();
    if draws.len() < FEWEST || !(sum > 0.0 && sum.is_finite()) {
        return None;
    }
    let (mut points, mut passed) = (Vec::with_capacity(WALKERS), 0.0);
    for (point, weight) in draws {
        passed += weight;
        while points.len() < WALKERS && (points.len() as f64 + 0.5) / WALKERS as f64 * sum <= passed {
            points.push(*point);
        }
    }
    Some(points)
}

/// The places of walkers that move by the stretches of Goodman & Weare in so many dimensions, every fifth sweep after
/// the first hundred.
fn walk(
    walkers: &mut [Point],
    dimensions: u32,
    density: &impl Fn(&Point) -> f64,
    random: &mut RandomNumbers,
) -> Vec<Point> {
    let mut densities: Vec<f64> = walkers.iter().map(density).collect();
    let mut kept = Vec::with_capacity(walkers.len() * (SWEEPS - FIRST_KEPT) / DISTANCE);
    for sweep in 0..SWEEPS {
        for k in 0..walkers.len() {
            let other = (k + 1 + (random.uniform() * (walkers.len() - 1) as f64) as usize) % walkers.len();
            let stretch = (1.0 + random.uniform()).powi(2) / 2.0;
            let (from, to) = (walkers[other], walkers[k]);
            let moved: Point = std::array::from_fn(|i| from[i] + stretch * (to[i] - from[i]));
            let there = density(&moved);
            if random.uniform().ln() < f64::from(dimensions - 1) * stretch.ln() + there - densities[k] {
                (walkers[k], densities[k]) = (moved, there);
            }
        }
        if sweep >= FIRST_KEPT && sweep % DISTANCE == 0 {
            kept.extend_from_slice(walkers);
        }
    }
    kept
}

/// The likelihood, linearised where springs and dampers tell the numbers of the transfer function apart best.
fn linearised(recorded: Recorded<'_>, coordinates: &Coordinates, total: f64, scale: f64) -> Option<Likelihood> {
    let start = recorded.0.theta.clone();
    let apart = |theta: &[f64]| {
        let values = coordinates.values(theta);
        ((values[1] * values[2]) / (total * values[3])).ln().abs()
    };
    let mut numbers = of_values(&coordinates.values(&start))?.0;
    let mut likelihood = None;
    for _ in 0..LINEARISATIONS {
        let at_share = |share: f64| {
            let masses = [share * total, (1.0 - share) * total];
            let [[k1, k2, c1, c2], _] = springs_of(masses, &numbers)?;
            let model = DoubleSpringMassDamper {
                m1_kg: masses[0],
                m2_kg: masses[1],
                k1_n_per_m: k1,
                k2_n_per_m: k2,
                c1_n_s_per_m: c1,
                c2_n_s_per_m: c2,
            };
            let theta = coordinates.coordinates_of(&Model::DoubleSpringMassDamper(model));
            theta.iter().all(|x| x.is_finite()).then_some(theta)
        };
        let own = likelihood.is_none().then(|| start.clone());
        let points = SHARES.into_iter().filter_map(at_share).chain(own);
        let best = points.max_by(|a, b| apart(a).total_cmp(&apart(b)))?;
        let next = Likelihood::at(recorded, coordinates, &best, scale)?;
        numbers = next.at_zero + next.by_y * next.y.0.clamp(0.0, LARGEST_Y);
        likelihood = Some(next);
    }
    likelihood
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn springs_and_dampers_come_back_from_the_numbers_of_the_transfer_function_with_their_dual() {
        let mut random = RandomNumbers::seeded(1);
        for _ in 0..200 {
            let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
            let masses = [between(100.0, 600.0), between(700.0, 1700.0)];
            let springs = [between(3e5, 4e6), between(3e5, 4e6), between(1e3, 2e4), between(1e3, 2e4)];
            let (numbers, y) = numbers_of(masses, springs);
            let both = springs_of(masses, &numbers).unwrap();
            let larger = masses[1] * springs[0] > (masses[0] + masses[1]) * springs[1];
            let (own, dual) = if larger { (both[0], both[1]) } else { (both[1], both[0]) };
            let near = (masses[1] * springs[0] / ((masses[0] + masses[1]) * springs[1]) - 1.0).abs();
            for (a, b) in own.iter().zip(springs) {
                // Rounding over the distance of the roots.
                assert!((a / b - 1.0).abs() < 1e-11 / near, "{own:?} {springs:?}");
            }
            let (of_dual, y_of_dual) = numbers_of(masses, dual);
            assert!((of_dual - numbers).amax() < 1e-11 / near && (y_of_dual / y - 1.0).abs() < 1e-11 / near);
        }
    }

    #[test]
    fn the_front_follows_from_the_compartment() {
        let masses = [375.0, 1125.0];
        for c2_n_s_per_m in [0.0, 50.0, 9e3, 4e4] {
            let springs = [9e5, 1e6, 6e3, c2_n_s_per_m];
            let model = DoubleSpringMassDamper {
                m1_kg: masses[0],
                m2_kg: masses[1],
                k1_n_per_m: springs[0],
                k2_n_per_m: springs[1],
                c1_n_s_per_m: springs[2],
                c2_n_s_per_m,
            };
            let response = Model::DoubleSpringMassDamper(model).respond(1.0, COMPARED_DT_S, COMPARED).unwrap();
            let [front, compartment] = &response.motions[..] else { panic!("two masses") };
            let beside = front_beside(&compartment.acceleration_m_per_s2, masses, springs);
            for ((here, x1), x2) in beside.zip(&front.displacement_m[1..]).zip(&compartment.displacement_m[1..]) {
                // A parabola through 2 ms of an acceleration of up to 40 1/s (of 1 m/s) and 5e4 1/s³ misses a straight
                // line by 5e4 h²/8, of a spring that gives 1.1e-3 m for each m/s².
                assert!((here - (x1 - x2)).abs() < 1.1e-3 * 5e4 * 4e-6 / 8.0, "{here} {}", x1 - x2);
            }
        }
    }

    #[test]
    fn a_model_moves_like_itself_and_its_dual_does_not() {
        let model = DoubleSpringMassDamper {
            m1_kg: 375.0,
            m2_kg: 1125.0,
            k1_n_per_m: 9e5,
            k2_n_per_m: 1e6,
            c1_n_s_per_m: 6e3,
            c2_n_s_per_m: 9e3,
        };
        let (masses, dual) = ([375.0, 1125.0], model.dual());
        let springs_of_dual = [dual.k1_n_per_m, dual.k2_n_per_m, dual.c1_n_s_per_m, dual.c2_n_s_per_m];
        let moves_like_model = nearer_than_its_dual(&model).unwrap();
        assert!(moves_like_model(masses, [9e5, 1e6, 6e3, 9e3]) && !moves_like_model(masses, springs_of_dual));
        // One that is its own dual stands for both sides.
        let own_dual = DoubleSpringMassDamper { k2_n_per_m: 0.75 * 9e5, c2_n_s_per_m: 0.75 * 6e3, ..model };
        let moves_like_it = nearer_than_its_dual(&own_dual).unwrap();
        assert!(moves_like_it(masses, [9e5, 1e6, 6e3, 9e3]) && moves_like_it(masses, springs_of_dual));
    }
}
