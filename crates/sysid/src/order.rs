//! Models of many orders: their poles, and those that stay in the stabilisation diagram.

use std::f64::consts::PI;

use crumple_numerics::estimation::statistics::{autoregressive_effective_samples, quantile};
use crumple_numerics::lti::{Complex, Mode, eigenvalues, eigenvectors};
use nalgebra::DMatrix;

use crate::hankel::block_hankel::Hankel;
use crate::hankel::golub_kahan::GolubKahan;
use crate::hankel::shift_pair::{Shift, ShiftPair};
use crate::hankel::svd::factorize;
use crate::modes::{modal_assurance, phase_collinearity};
use crate::{EraError, MarkovParameters, Subspace};

// Poles of all orders from one factorisation, for the stabilisation diagram.
//
// In balanced coordinates the model of order `n` is the leading `n x n` part of any larger one. So a diagram over
// all orders costs one decomposition and one eigenvalue problem per order, instead of one identification each.

/// Hankel matrices up to this size are decomposed whole.
const DENSE_UP_TO: usize = 64;

/// Lanczos steps at which convergence is looked at; the last is the limit.
const CHECKPOINTS: [usize; 5] = [30, 45, 68, 100, 150];

/// Relative residual of a singular value that is good enough here: the diagram compares changes of 1 %, and the poles'
/// errors go with the square of this.
const GOOD: f64 = 0.03;

/// Poles of the ERA models of the orders 2, 4, ... up to `highest` or to what the record supports.
///
/// In the balanced form the model of order n is the leading part of every larger one, so all orders cost one
/// decomposition and one small eigenproblem each. `markov` as for [`era`](crate::era()); half of the samples are rows,
/// half columns, unless given. Errors: as there.
pub fn era_order_scan(
    markov: &[f64],
    highest: usize,
    rows: Option<usize>,
    columns: Option<usize>,
) -> Result<Vec<OrderPoles>, EraError> {
    era_order_scan_of(MarkovParameters::new(vec![markov], 1)?, highest, rows, columns)
}

/// The same for any number of outputs and inputs, with mode shapes where outputs are several.
pub fn era_order_scan_of(
    markov: MarkovParameters<'_>,
    highest: usize,
    rows: Option<usize>,
    columns: Option<usize>,
) -> Result<Vec<OrderPoles>, EraError> {
    let (q, m) = (markov.outputs(), markov.inputs());
    let parameters = markov.samples().saturating_sub(1);
    let half = parameters / 2;
    let rows = rows.unwrap_or_else(|| columns.map_or(half, |columns| parameters.saturating_sub(columns)));
    let columns = columns.unwrap_or_else(|| if rows == half { half } else { parameters.saturating_sub(rows) });
    if rows == 0 || columns == 0 || rows.saturating_add(columns) > parameters {
        return Err(EraError::TooShort { parameters, rows: rows.max(1), columns: columns.max(1) });
    }
    let used = || markov.sequences().iter().map(|y| &y[1..=rows + columns]);
    if used().all(|y| y[..y.len() - 1].iter().all(|y| *y == 0.0)) {
        return Err(EraError::Silent { samples: rows + columns });
    }
    let largest = used().flatten().fold(0.0_f64, |m, y| m.max(y.abs()));
    let scaled: Vec<Vec<f64>> = used().map(|y| y.iter().map(|y| y / largest).collect()).collect();
    let mut hankel = Hankel::new(scaled.iter().map(Vec::as_slice).collect(), m, rows, columns);
    let (values, left, right) = triplets(&mut hankel, highest)?;
    let count = values.len();
    let mut products = DMatrix::zeros(hankel.rows(), count);
    let mut product = vec![0.0; hankel.rows()];
    for i in 0..count {
        hankel.multiply(Shift::One, right.column(i).as_slice(), &mut product);
        products.column_mut(i).copy_from_slice(&product);
    }
    let shifted = left.columns(0, count).tr_mul(&products);
    let roots: Vec<f64> = values.iter().map(|s| s.sqrt()).collect();
    let balanced = DMatrix::from_fn(count, count, |i, j| shifted[(i, j)] / (roots[i] * roots[j]));
    (2..=count)
        .step_by(2)
        .map(|order| {
            let a = balanced.view((0, 0), (order, order)).into_owned();
            let poles = eigenvalues(&a)?;
            let b = DMatrix::from_fn(order, m, |i, j| roots[i] * right[(j, i)]);
            let c = DMatrix::from_fn(q, order, |j, i| roots[i] * left[(j, i)]);
            let (shapes, strengths) = evidence(&a, &b, &c, &poles, &scaled).unwrap_or_default();
            Ok(OrderPoles { order, poles, shapes: if q > 1 { shapes } else { Vec::new() }, strengths })
        })
        .collect()
}

/// Mode shapes, one vector per pole with an entry per output, and strengths, one per pole.
type ShapesAndStrengths = (Vec<Vec<Complex>>, Vec<f64>);

/// What the outputs show of every pole; and energy of its wave in the Markov parameters, over `2 s² (N/Ne) ln Ne`: that
/// of the strongest of all frequencies in noise of the residual's mean square `s²` and effective number of samples.
/// Sequences stand one after the other. `None` without a basis of eigenvectors, or where a wave leaves the range of
/// numbers.
fn evidence(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    c: &DMatrix<f64>,
    poles: &[Complex],
    markov: &[Vec<f64>],
) -> Option<ShapesAndStrengths> {
    let complex = |m: &DMatrix<f64>| m.map(|x| Complex::new(x, 0.0));
    let vectors = eigenvectors(a, poles)?;
    let b = vectors.clone().try_inverse()? * complex(b);
    let c = complex(c) * vectors;
    let mut residual = markov.concat();
    let (inputs, length) = (b.ncols(), markov.first()?.len());
    let mut energies = Vec::with_capacity(poles.len());
    for (i, z) in poles.iter().enumerate() {
        // Of a pair the wave is the real part of both together.
        let both = if z.im == 0.0 { 1.0 } else { 2.0 };
        let mut energy = 0.0;
        for (sequence, residual) in residual.chunks_exact_mut(length).enumerate() {
            let mut wave = c[(sequence / inputs, i)] * b[(i, sequence % inputs)];
            for e in residual {
                let y = both * wave.re;
                energy += y * y;
                if z.im >= 0.0 {
                    *e -= y;
                }
                wave *= z;
            }
        }
        energies.push(energy);
    }
    let samples = residual.len() as f64;
    let square = residual.iter().map(|e| e * e).sum::<f64>() / samples;
    let effective = autoregressive_effective_samples(&residual).max(2.0);
    let noise = 2.0 * square * samples / effective * effective.ln();
    let strengths: Vec<f64> = energies.into_iter().map(|energy| energy / noise.max(f64::MIN_POSITIVE)).collect();
    let shapes = c.column_iter().map(|column| column.iter().copied().collect()).collect();
    strengths.iter().all(|x| x.is_finite()).then_some((shapes, strengths))
}

/// Singular values, left vectors, right vectors, the vectors as columns.
type Triplets = (Vec<f64>, DMatrix<f64>, DMatrix<f64>);

/// The leading singular triplets, at most `wanted`, fewer where the record has fewer or they do not converge.
fn triplets(hankel: &mut Hankel<'_>, wanted: usize) -> Result<Triplets, EraError> {
    if hankel.rows().min(hankel.columns()) <= DENSE_UP_TO {
        let factors = factorize(hankel, wanted, false, |_| wanted)?;
        let count = factors.rank().min(wanted);
        return Ok((factors.values[..count].to_vec(), factors.left, factors.right));
    }
    let mut lanczos = GolubKahan::new(hankel.columns());
    let last = CHECKPOINTS[CHECKPOINTS.len() - 1];
    for steps in CHECKPOINTS {
        lanczos.extend(hankel, steps);
        let Some(ritz) = lanczos.ritz() else { break };
        let floor = 1e-12 * ritz.values.first().copied().unwrap_or(0.0);
        let good = ritz
            .values
            .iter()
            .zip(&ritz.residuals)
            .take_while(|(value, residual)| **value > floor && **residual <= GOOD * **value)
            .count();
        let all = ritz.values.get(good).is_none_or(|value| *value <= floor);
        if good >= wanted || all || lanczos.exhausted() || steps == last {
            let count = good.min(wanted);
            let (left, right) = lanczos.vectors(&ritz, count);
            return Ok((ritz.values[..count].to_vec(), left, right));
        }
    }
    Err(EraError::NotConverged { rows: hankel.rows(), columns: hankel.columns(), steps: lanczos.steps() })
}

/// Poles, and with several outputs mode shapes, of the subspace models of the orders 2, 4, ... up to `highest` or to
/// what the factorisation supports.
///
/// Shift invariance in the least-squares sense for all orders at once: with the observability matrix without its last
/// block row `= Q R` and `T = Q'` times that without its first, the state matrix of order n is
/// `R[..n, ..n]^-1 T[..n, ..n]` (Döhler & Mevel, Mech. Syst. Signal Process. 38, 2013). Growing poles stay as they are.
pub fn subspace_order_scan(subspace: &Subspace<'_>, highest: usize) -> Vec<OrderPoles> {
    let (observability, outputs) = subspace.observability();
    let rows = observability.nrows() - outputs;
    let count = subspace.highest_order().min(highest).min(observability.ncols());
    let (q, r) = observability.view((0, 0), (rows, count)).into_owned().qr().unpack();
    let t = q.tr_mul(&observability.view((outputs, 0), (rows, count)));
    let c = observability.view((0, 0), (outputs, count)).into_owned();
    let scales = subspace.output_scales();
    (2..=count)
        .step_by(2)
        .filter_map(|order| {
            let a = r.view((0, 0), (order, order)).solve_upper_triangular(&t.view((0, 0), (order, order)))?;
            let poles = eigenvalues(&a).ok()?;
            let shapes = if outputs > 1 {
                let vectors = eigenvectors(&a, &poles)?;
                let seen = DMatrix::from_fn(outputs, order, |i, k| Complex::new(c[(i, k)] * scales[i], 0.0)) * vectors;
                seen.column_iter().map(|column| column.iter().copied().collect()).collect()
            } else {
                Vec::new()
            };
            Some(OrderPoles { order, poles, shapes, strengths: Vec::new() })
        })
        .collect()
}

// The stabilisation diagram: which poles stay where they are while the order of the model grows.
//
// A mode of the structure comes back at every order, a pole that fits noise somewhere else each time. Poles that lie
// close together in frequency and shape, over at least half of the orders, are one mode; their scatter is its
// uncertainty.

/// Settings of a stabilisation diagram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StabilizationOptions {
    /// Highest order; orders are 2, 4, ... up to it.
    pub highest_order: usize,
    /// Largest damping ratio of a pole that counts. 0.3 for structures; crash records have up to 2.
    pub highest_damping: f64,
    /// Share of the Nyquist frequency above which an oscillation is an artefact of sampling.
    pub nyquist_share: f64,
    /// Least modal phase collinearity of a shape, with several sensors.
    pub least_collinearity: f64,
    /// Least strength, where the method gives one: energy of the mode in the record over that of the strongest wave in
    /// noise like the residual. Models of rising order that contain each other keep a wave of the noise for ever, so
    /// that staying alone proves nothing.
    pub least_strength: f64,
    /// Relative change of frequency from order to order up to which a pole is stable.
    pub frequency_change: f64,
    /// Relative change of the damping ratio, likewise.
    pub damping_change: f64,
    /// Loss of modal assurance, `1 - MAC`, likewise, with several sensors.
    pub shape_change: f64,
    /// Share of the orders in which a cluster must be present.
    pub presence: f64,
}

impl Default for StabilizationOptions {
    /// Order 20, damping ratio 2, 95 % of Nyquist, MPC 0.5, strength 2, changes of 1 %, 5 % and 2 %, half of the
    /// orders.
    fn default() -> Self {
        Self {
            highest_order: 20,
            highest_damping: 2.0,
            nyquist_share: 0.95,
            least_collinearity: 0.5,
            least_strength: 2.0,
            frequency_change: 0.01,
            damping_change: 0.05,
            shape_change: 0.02,
            presence: 0.5,
        }
    }
}

/// Poles of the model of one order.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderPoles {
    /// Number of states.
    pub order: usize,
    /// Poles in the z-plane.
    pub poles: Vec<Complex>,
    /// Mode shapes, one per pole and one entry per sensor; empty with one sensor.
    pub shapes: Vec<Vec<Complex>>,
    /// Energy of every pole's wave in the record over that of the strongest in noise; empty where not known.
    pub strengths: Vec<f64>,
}

/// How much of a pole stayed since the order before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stability {
    /// It fails a hard criterion: growing, too strongly damped, near the Nyquist frequency, no stronger than noise, or
    /// without a real mode shape.
    Rejected,
    /// No pole of the order before has its frequency.
    New,
    /// Frequency stays.
    Frequency,
    /// Frequency and damping stay: all that one sensor can show.
    FrequencyAndDamping,
    /// Frequency, damping and shape stay.
    All,
}

impl Stability {
    /// In the words of the artifact.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rejected => "rejected",
            Self::New => "new",
            Self::Frequency => "frequency",
            Self::FrequencyAndDamping => "frequency-and-damping",
            Self::All => "all",
        }
    }
}

/// One oscillating pole of the diagram, of a conjugate pair the upper one.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagramPole {
    /// Order of its model.
    pub order: usize,
    /// The pole in continuous time.
    pub mode: Mode,
    /// Its shape; empty with one sensor.
    pub shape: Vec<Complex>,
    /// Energy in the record over that of the strongest wave in noise, where known.
    pub strength: Option<f64>,
    /// Whether it stayed.
    pub stability: Stability,
    /// Whether it stayed, or the order after found it again: such poles are clustered.
    pub(crate) lasting: bool,
}

/// Poles over orders, and what they gather to.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilizationDiagram {
    /// Orders, rising.
    pub orders: Vec<usize>,
    /// Poles, by order and then by frequency.
    pub poles: Vec<DiagramPole>,
    /// Clusters present in enough orders, by frequency.
    pub clusters: Vec<PoleCluster>,
    /// Settings.
    pub options: StabilizationOptions,
}

/// Draws the diagram of models of rising order.
///
/// Hard criteria reject a pole: it must oscillate (real poles are left out altogether), `0 < zeta <` the limit, stay
/// below the Nyquist frequency, be stronger than a wave of noise (ERA), and with several sensors have a shape of nearly
/// one phase. Soft criteria compare it
/// with the nearest accepted pole of the order before, in `|df|/f + (1 - MAC)`. Poles that last are clustered by single
/// linkage in the same distance; clusters present in the asked share of the orders are the physical modes, as far as
/// one record tells. A record without noise has no orders above its rank, and little to show.
///
/// After Peeters & De Roeck, Mech. Syst. Signal Process. 13(6), 1999, and Reynders, Houbrechts & De Roeck, 26(1), 2012.
pub fn stabilization(models: &[OrderPoles], sample_time_s: f64, options: StabilizationOptions) -> StabilizationDiagram {
    let mut poles: Vec<DiagramPole> = Vec::new();
    let mut before: Vec<usize> = Vec::new();
    for model in models {
        let mut poles_of_order: Vec<DiagramPole> = model
            .poles
            .iter()
            .enumerate()
            .filter(|(_, z)| z.im > 0.0)
            .filter_map(|(k, z)| {
                let mode = Mode::discrete(*z, sample_time_s)?;
                let shape = model.shapes.get(k).filter(|shape| shape.len() > 1).cloned().unwrap_or_default();
                let strength = model.strengths.get(k).copied();
                let stability = Stability::New;
                Some(DiagramPole { order: model.order, mode, shape, strength, stability, lasting: false })
            })
            .collect();
        poles_of_order
            .sort_by(|a, b| a.mode.natural_frequency_rad_per_s.total_cmp(&b.mode.natural_frequency_rad_per_s));
        let mut now = Vec::new();
        for mut pole in poles_of_order {
            let place = poles.len();
            if !accepted(&pole, sample_time_s, &options) {
                pole.stability = Stability::Rejected;
            } else {
                now.push(place);
                let nearest =
                    before.iter().min_by(|a, b| distance(&pole, &poles[**a]).total_cmp(&distance(&pole, &poles[**b])));
                if let Some(&old) = nearest {
                    pole.stability = stability(&pole, &poles[old], &options);
                    pole.lasting = pole.stability >= Stability::FrequencyAndDamping
                        && (pole.shape.is_empty() || pole.stability == Stability::All);
                    poles[old].lasting |= pole.lasting;
                }
            }
            poles.push(pole);
        }
        before = now;
    }
    let orders: Vec<usize> = models.iter().map(|model| model.order).collect();
    StabilizationDiagram { clusters: clusters(&poles, orders.len(), &options), orders, poles, options }
}

fn accepted(pole: &DiagramPole, sample_time_s: f64, options: &StabilizationOptions) -> bool {
    let damping = pole.mode.damping_ratio.unwrap_or(-1.0);
    damping > 0.0
        && damping < options.highest_damping
        && pole.mode.pole.im.abs() < options.nyquist_share * PI / sample_time_s
        && pole.strength.is_none_or(|strength| strength >= options.least_strength)
        && (pole.shape.is_empty() || phase_collinearity(&pole.shape).unwrap_or(0.0) >= options.least_collinearity)
}

fn stability(pole: &DiagramPole, old: &DiagramPole, options: &StabilizationOptions) -> Stability {
    let damping = |p: &DiagramPole| p.mode.damping_ratio.unwrap_or(0.0);
    let change = (damping(pole) - damping(old)).abs() / damping(pole);
    if frequency_change(pole, old) > options.frequency_change {
        Stability::New
    } else if change > options.damping_change {
        Stability::Frequency
    } else if pole.shape.is_empty() || shape_change(pole, old) > options.shape_change {
        Stability::FrequencyAndDamping
    } else {
        Stability::All
    }
}

fn frequency_change(a: &DiagramPole, b: &DiagramPole) -> f64 {
    let (a, b) = (a.mode.natural_frequency_rad_per_s, b.mode.natural_frequency_rad_per_s);
    (a - b).abs() / a.max(b)
}

/// `1 - MAC`; 1 for shapes of zeros, which have none.
fn shape_change(a: &DiagramPole, b: &DiagramPole) -> f64 {
    1.0 - modal_assurance(&a.shape, &b.shape).unwrap_or(0.0)
}

/// `|df|/f + (1 - MAC)`; the second part only with several sensors.
fn distance(a: &DiagramPole, b: &DiagramPole) -> f64 {
    let shape = if a.shape.is_empty() || b.shape.is_empty() { 0.0 } else { shape_change(a, b) };
    frequency_change(a, b) + shape
}

/// Median and quartiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quartiles {
    /// A quarter lies below.
    pub lower: f64,
    /// Median.
    pub median: f64,
    /// A quarter lies above.
    pub upper: f64,
}

impl Quartiles {
    pub(crate) fn from_values(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let at = |share| quantile(&values, share).unwrap_or(0.0);
        Self { lower: at(0.25), median: at(0.5), upper: at(0.75) }
    }

    /// Upper minus lower quartile.
    pub fn interquartile_range(&self) -> f64 {
        self.upper - self.lower
    }
}

/// A mode that many orders agree on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoleCluster {
    /// Number of orders in which it is present.
    pub orders: usize,
    /// Natural frequency, rad/s.
    pub natural_frequency_rad_per_s: Quartiles,
    /// Damping ratio.
    pub damping_ratio: Quartiles,
}

/// Single linkage of the lasting poles: two belong together if a chain of links shorter than the tolerated changes of
/// frequency and shape leads from one to the other. `orders` is the number of orders of the diagram.
fn clusters(poles: &[DiagramPole], orders: usize, options: &StabilizationOptions) -> Vec<PoleCluster> {
    let lasting: Vec<&DiagramPole> = poles.iter().filter(|pole| pole.lasting).collect();
    let mut cluster: Vec<usize> = (0..lasting.len()).collect();
    for i in 0..lasting.len() {
        for j in 0..i {
            let shape = if lasting[i].shape.is_empty() { 0.0 } else { options.shape_change };
            if distance(lasting[i], lasting[j]) <= options.frequency_change + shape && cluster[i] != cluster[j] {
                let (from, to) = (cluster[i], cluster[j]);
                cluster.iter_mut().filter(|c| **c == from).for_each(|c| *c = to);
            }
        }
    }
    let mut names: Vec<usize> = cluster.clone();
    names.sort_unstable();
    names.dedup();
    let mut clusters: Vec<PoleCluster> = names
        .into_iter()
        .filter_map(|name| {
            let members: Vec<&DiagramPole> =
                lasting.iter().zip(&cluster).filter(|(_, c)| **c == name).map(|(pole, _)| *pole).collect();
            let mut present: Vec<usize> = members.iter().map(|pole| pole.order).collect();
            present.sort_unstable();
            present.dedup();
            (present.len() as f64 >= options.presence * orders as f64).then(|| PoleCluster {
                orders: present.len(),
                natural_frequency_rad_per_s: Quartiles::from_values(
                    members.iter().map(|pole| pole.mode.natural_frequency_rad_per_s).collect(),
                ),
                damping_ratio: Quartiles::from_values(
                    members.iter().filter_map(|pole| pole.mode.damping_ratio).collect(),
                ),
            })
        })
        .collect();
    clusters.sort_by(|a, b| a.natural_frequency_rad_per_s.median.total_cmp(&b.natural_frequency_rad_per_s.median));
    clusters
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    const DT_S: f64 = 1e-3;

    /// Conjugate pairs of `(frequency Hz, damping ratio)`.
    fn order(order: usize, modes: &[(f64, f64)]) -> OrderPoles {
        let poles = modes
            .iter()
            .flat_map(|(hz, zeta)| {
                let w = 2.0 * PI * hz;
                let s = Complex::new(-zeta * w, w * (1.0 - zeta * zeta).sqrt());
                [(s * DT_S).exp(), (s.conj() * DT_S).exp()]
            })
            .collect();
        OrderPoles { order, poles, shapes: Vec::new(), strengths: Vec::new() }
    }

    #[test]
    fn labels_follow_the_printed_settings() {
        let models = [
            order(2, &[(10.0, 0.1)]),
            // 0.5 % in frequency, 10 % in damping; a growing one; one at 0.98 of Nyquist.
            order(4, &[(10.05, 0.11), (50.0, -0.1), (490.0, 0.01)]),
            // 4 % in damping; 50.2 Hz has no accepted predecessor.
            order(6, &[(10.0, 0.1145), (50.2, 0.1), (100.0, 0.2)]),
            order(8, &[(11.0, 0.1145)]),
        ];
        let diagram = stabilization(&models, DT_S, StabilizationOptions::default());
        let names: Vec<(usize, &str)> = diagram.poles.iter().map(|p| (p.order, p.stability.name())).collect();
        assert_eq!(
            names,
            [
                (2, "new"),
                (4, "frequency"),
                (4, "rejected"),
                (4, "rejected"),
                (6, "frequency-and-damping"),
                (6, "new"),
                (6, "new"),
                (8, "new"),
            ]
        );
        // Orders 4 and 6 of four: half.
        assert_eq!(diagram.clusters.len(), 1);
        assert_eq!(diagram.clusters[0].orders, 2);
        assert!((diagram.clusters[0].natural_frequency_rad_per_s.median / 2.0 / PI - 10.025).abs() < 1e-9);
        // Quartiles of 10.00 and 10.05 Hz, interpolated.
        assert!(
            (diagram.clusters[0].natural_frequency_rad_per_s.interquartile_range() / 2.0 / PI - 0.025).abs() < 1e-9
        );
    }

    #[test]
    fn a_shape_that_changes_keeps_modes_of_one_frequency_apart() {
        let c = Complex::new;
        let with_shape = |n: usize, shape: [Complex; 2]| {
            let mut model = order(n, &[(10.0, 0.05)]);
            model.shapes = vec![shape.to_vec(), shape.map(|x| x.conj()).to_vec()];
            model
        };
        let up = [c(1.0, 0.0), c(1.0, 0.0)];
        let down = [c(1.0, 0.0), c(-1.0, 0.0)];
        let models = [with_shape(2, up), with_shape(4, up), with_shape(6, down), with_shape(8, down)];
        let diagram = stabilization(&models, DT_S, StabilizationOptions::default());
        let names: Vec<&str> = diagram.poles.iter().map(|p| p.stability.name()).collect();
        assert_eq!(names, ["new", "all", "frequency-and-damping", "all"]);
        assert_eq!(diagram.clusters.len(), 2);
    }
}
