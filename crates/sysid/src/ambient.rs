//! Modes of a structure that moves in wind, traffic or other noise that nobody measured: no input, several outputs.
//!
//! Correlations of the outputs decay like free motion (James, Carne & Lauffer, *The Natural Excitation Technique*,
//! 1993). Their block Hankel matrix gives a model of every order by one decomposition (covariance-driven stochastic
//! subspace identification, Peeters & De Roeck, J. Dyn. Syst. Meas. Control 123, 2001). A mode is what many orders and
//! both halves of the record agree on; the fit of a simulation is no verdict on a record without an input.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use crumple_numerics::linalg::{dot, pseudo_inverse_times};
use crumple_numerics::lti::{Complex, Mode, eigenvalues, eigenvectors};
use nalgebra::{DMatrix, SymmetricEigen};
use rayon::prelude::*;

use crate::harmonic::{HarmonicLine, harmonic_line};
use crate::modes::{modal_assurance, normalized, phase_collinearity};
use crate::order::Quartiles;
use crate::{IdentifyError, IoData};

/// Block rows, at least and at most.
const BLOCK_ROWS: (usize, usize) = (20, 100);

/// Rows of the matrix of the first look, at most: its decomposition takes their cube.
const FIRST_LOOK: usize = 600;

/// Horizons in half periods of the lowest mode. What one of them splits or loses by chance, the others do not.
const HORIZONS: [f64; 3] = [1.0, 1.4, 2.0];

/// Highest order in units of the number of outputs.
const ORDERS_PER_OUTPUT: usize = 6;

/// Share of the Nyquist frequency above which a pole does not count.
const NYQUIST_SHARE: f64 = 0.95;

/// Least phase collinearity of a shape.
const LEAST_COLLINEARITY: f64 = 0.7;

/// Distances at which clusters end: of the whole record, and of its halves.
const CUT: f64 = 0.03;
const CUT_OF_HALVES: f64 = 0.05;

/// Share of the orders that a cluster is found in.
const PRESENCE: f64 = 0.5;

/// The same of a half of the record.
const PRESENCE_IN_HALVES: f64 = 0.3;

/// Relative difference of frequencies within which two clusters of one shape are one mode.
const NEAR: f64 = 0.1;

/// A cluster of a half is the same mode up to this relative difference of frequency, from this likeness of shapes on.
const SAME_FREQUENCY: f64 = 0.04;
const SAME_SHAPE: f64 = 0.9;

/// How modes are looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmbientOptions {
    /// Block rows; `None`: about half a period of the lowest mode.
    pub block_rows: Option<usize>,
    /// Highest order; `None`: six times the outputs.
    pub highest_order: Option<usize>,
    /// Largest damping ratio of a pole that counts: 0.1 of structures, 0.3 of machines.
    pub highest_damping: f64,
}

impl Default for AmbientOptions {
    /// What the record asks for, damping up to 0.1.
    fn default() -> Self {
        Self { block_rows: None, highest_order: None, highest_damping: 0.1 }
    }
}

/// A mode that orders and halves agree on.
#[derive(Debug, Clone, PartialEq)]
pub struct AmbientMode {
    /// Orders in which it is found.
    pub orders: usize,
    /// Natural frequency over them, rad/s.
    pub natural_frequency_rad_per_s: Quartiles,
    /// Damping ratio over them.
    pub damping_ratio: Quartiles,
    /// Mean shape, the largest entry 1.
    pub shape: Vec<Complex>,
    /// Natural frequency in each half of the record, rad/s.
    pub halves_rad_per_s: [f64; 2],
}

/// A pole that counts.
#[derive(Debug, Clone, PartialEq)]
pub struct AmbientPole {
    /// Order of its model.
    pub order: usize,
    /// Block rows of its matrix.
    pub block_rows: usize,
    /// The pole.
    pub mode: Mode,
    /// Its shape, the largest entry 1.
    pub shape: Vec<Complex>,
}

/// Modes of a record without an input.
#[derive(Debug, Clone, PartialEq)]
pub struct AmbientModes {
    /// By frequency.
    pub modes: Vec<AmbientMode>,
    /// Lines of machines that run, which are no modes, by frequency.
    pub harmonics: Vec<HarmonicLine>,
    /// Clusters of the whole record that not both halves show.
    pub not_in_both_halves: usize,
    /// Orders, rising.
    pub orders: Vec<usize>,
    /// Poles that count, by order and frequency.
    pub poles: Vec<AmbientPole>,
    /// Block rows of every horizon.
    pub block_rows: Vec<usize>,
}

/// Finds the modes of outputs that nobody knows the input of. Errors: fewer than two outputs, too few samples, outputs
/// that do not vary.
pub fn ambient_modes(data: &IoData, options: AmbientOptions) -> Result<AmbientModes, IdentifyError> {
    let (q, samples) = (data.outputs().len(), data.samples());
    if q < 2 || !data.inputs().is_empty() {
        let (method, needed) = ("ambient", "no input and two outputs at least");
        return Err(IdentifyError::Channels { method, needed, inputs: data.inputs().len(), outputs: q });
    }
    let first = options.block_rows.unwrap_or(BLOCK_ROWS.0);
    let needed = 20 * first;
    if samples < needed {
        let why = format!("halves of five times {first} block rows each way");
        return Err(IdentifyError::TooShort { method: "ambient", samples, needed, why });
    }
    let horizons = match options.block_rows {
        Some(given) => vec![given],
        None => horizons(data, options)?,
    };
    let poles = poles_of_horizons(data, &horizons, options)?;
    let looked = |presence: f64, cut: f64| Look { horizons: horizons.len(), presence, cut, ..Look::new(q, options) };
    let whole = clusters(&poles, looked(PRESENCE, CUT));
    let of_half = |from: usize, to: usize| -> Result<Vec<Cluster>, IdentifyError> {
        let half = data.slice(from, to)?;
        let poles = poles_of_horizons(&half, &horizons, options)?;
        Ok(clusters(&poles, looked(PRESENCE_IN_HALVES, CUT_OF_HALVES)))
    };
    let halves = [of_half(0, samples / 2)?, of_half(samples / 2, samples)?];
    let count = whole.len();
    let found_again = |cluster: &Cluster, half: &[Cluster]| {
        let is_same = |other: &&Cluster| {
            (other.frequency.median / cluster.frequency.median - 1.0).abs() <= SAME_FREQUENCY
                && modal_assurance(&other.shape, &cluster.shape).unwrap_or(0.0) >= SAME_SHAPE
        };
        let apart = |other: &&Cluster| (other.frequency.median - cluster.frequency.median).abs();
        half.iter().filter(is_same).min_by(|a, b| apart(a).total_cmp(&apart(b))).map(|other| other.frequency.median)
    };
    let modes = whole.into_iter().filter_map(|cluster| {
        let halves_rad_per_s = [found_again(&cluster, &halves[0])?, found_again(&cluster, &halves[1])?];
        let Cluster { orders, frequency, damping, shape, .. } = cluster;
        let natural_frequency_rad_per_s = frequency;
        Some(AmbientMode { orders, natural_frequency_rad_per_s, damping_ratio: damping, shape, halves_rad_per_s })
    });
    let mut modes: Vec<AmbientMode> = modes.collect();
    let not_in_both_halves = count - modes.len();
    let line =
        |mode: &AmbientMode| harmonic_line(data, mode.natural_frequency_rad_per_s.median, mode.damping_ratio.median);
    let lines: Vec<Option<HarmonicLine>> = modes.iter().map(line).collect();
    let mut is_line = lines.iter().map(Option::is_some);
    modes.retain(|_| !is_line.next().unwrap_or(false));
    let harmonics = lines.into_iter().flatten().collect();
    let orders = orders_of(q, horizons.iter().copied().max().unwrap_or(first), options).collect();
    Ok(AmbientModes { not_in_both_halves, modes, harmonics, orders, poles, block_rows: horizons })
}

/// About half a period of the lowest mode, which is looked for over the longest horizon: too short loses it, too long
/// costs damping of the high ones.
fn horizons(data: &IoData, options: AmbientOptions) -> Result<Vec<usize>, IdentifyError> {
    let q = data.outputs().len();
    let most = BLOCK_ROWS.1.min(data.samples() / 20).min(FIRST_LOOK / q).max(BLOCK_ROWS.0);
    let first = clusters(&poles_of_orders(data, most, options)?, Look::new(q, options));
    let half = first.first().map_or(0.0, |cluster| PI / cluster.frequency.median / data.sample_time_s());
    let rows = HORIZONS.map(|share| ((share * half).round() as usize).clamp(BLOCK_ROWS.0, most));
    let mut all = rows.to_vec();
    all.dedup();
    Ok(all)
}

/// Poles that count, of the models of all orders of every horizon.
fn poles_of_horizons(
    data: &IoData,
    horizons: &[usize],
    options: AmbientOptions,
) -> Result<Vec<AmbientPole>, IdentifyError> {
    let all: Result<Vec<_>, _> = horizons.par_iter().map(|rows| poles_of_orders(data, *rows, options)).collect();
    Ok(all?.concat())
}

/// Even orders up to the highest that the matrix has room for.
fn orders_of(outputs: usize, block_rows: usize, options: AmbientOptions) -> impl Iterator<Item = usize> {
    let highest = options.highest_order.unwrap_or(ORDERS_PER_OUTPUT * outputs);
    (2..=highest.min(block_rows * outputs)).step_by(2)
}

/// Poles that count, of the models of all orders, by order and frequency.
fn poles_of_orders(
    data: &IoData,
    block_rows: usize,
    options: AmbientOptions,
) -> Result<Vec<AmbientPole>, IdentifyError> {
    let (q, dt_s) = (data.outputs().len(), data.sample_time_s());
    let (correlations, deviations) = correlations(data, 2 * block_rows)?;
    let hankel = DMatrix::from_fn((block_rows + 1) * q, block_rows * q, |row, column| {
        correlations[row / q + column / q + 1][(row % q, column % q)]
    });
    // Left singular vectors; what rounding loses of small ones is below the noise.
    let eigen = SymmetricEigen::new(&hankel * hankel.transpose());
    let mut places: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    places.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let vectors = eigen.eigenvectors;
    let limit = NYQUIST_SHARE * PI / dt_s;
    let of_order = |order: usize| -> Vec<AmbientPole> {
        let observability = vectors.select_columns(&places[..order]);
        let above = observability.rows(0, block_rows * q).into_owned();
        let below = observability.rows(q, block_rows * q).into_owned();
        let Some(a) = pseudo_inverse_times(&above, &below) else { return Vec::new() };
        let Ok(all) = eigenvalues(&a) else { return Vec::new() };
        let Some(states) = eigenvectors(&a, &all) else { return Vec::new() };
        let seen = observability.rows(0, q).map(|x| Complex::new(x, 0.0)) * states;
        let counts = all.iter().zip(seen.column_iter()).filter(|(z, _)| z.im > 0.0).filter_map(|(z, column)| {
            let mode = Mode::discrete(*z, dt_s)?;
            let shape = normalized(column.iter().zip(&deviations).map(|(c, scale)| c * *scale).collect())?;
            let damping = mode.damping_ratio?;
            let counts = damping > 0.0
                && damping < options.highest_damping
                && mode.natural_frequency_rad_per_s < limit
                && phase_collinearity(&shape)? >= LEAST_COLLINEARITY;
            counts.then_some(AmbientPole { order, block_rows, mode, shape })
        });
        let mut poles: Vec<AmbientPole> = counts.collect();
        poles.sort_by(|a, b| a.mode.natural_frequency_rad_per_s.total_cmp(&b.mode.natural_frequency_rad_per_s));
        poles
    };
    let orders: Vec<usize> = orders_of(q, block_rows, options).collect();
    Ok(orders.into_par_iter().map(of_order).collect::<Vec<_>>().concat())
}

/// Correlations `R_0, R_1, ...` up to a lag, outputs less their means divided by their deviations; and the deviations.
fn correlations(data: &IoData, highest: usize) -> Result<(Vec<DMatrix<f64>>, Vec<f64>), IdentifyError> {
    let samples = data.samples();
    let mut deviations = Vec::new();
    let mut scaled: Vec<Vec<f64>> = Vec::new();
    for y in data.outputs() {
        let mean = y.iter().sum::<f64>() / samples as f64;
        let deviation = (y.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / samples as f64).sqrt();
        if deviation <= 0.0 {
            return Err(IdentifyError::Silent("outputs"));
        }
        scaled.push(y.iter().map(|x| (x - mean) / deviation).collect());
        deviations.push(deviation);
    }
    let q = scaled.len();
    let of_lag = |lag: usize| {
        DMatrix::from_fn(q, q, |i, j| dot(&scaled[i][lag..], &scaled[j][..samples - lag]) / samples as f64)
    };
    Ok(((0..=highest).into_par_iter().map(of_lag).collect(), deviations))
}

/// Poles of many orders that lie close together.
struct Cluster {
    /// Models that show it, and orders of these.
    models: usize,
    orders: usize,
    frequency: Quartiles,
    damping: Quartiles,
    shape: Vec<Complex>,
}

/// What makes a cluster.
#[derive(Clone, Copy)]
struct Look {
    outputs: usize,
    highest_order: Option<usize>,
    horizons: usize,
    presence: f64,
    cut: f64,
}

impl Look {
    /// In one horizon of the whole record.
    fn new(outputs: usize, options: AmbientOptions) -> Self {
        Self { outputs, highest_order: options.highest_order, horizons: 1, presence: PRESENCE, cut: CUT }
    }
}

/// Clusters by average linkage of `|f_i - f_j|/max + 1 - MAC`, those in the share of the orders from twice the number
/// of outputs on, by frequency. Of two of one shape near each other the one in more orders: models of high order split
/// a mode.
fn clusters(poles: &[AmbientPole], look: Look) -> Vec<Cluster> {
    let first = 2 * look.outputs;
    let last = poles.iter().map(|pole| pole.order).max().unwrap_or(0).max(first);
    let highest = look.highest_order.unwrap_or(last).min(last);
    let considered = look.horizons * ((highest - first.min(highest)) / 2 + 1);
    let mut all: Vec<Cluster> = Vec::new();
    for members in average_linkage(poles, look.cut) {
        let of_members = || members.iter().map(|place| &poles[*place]);
        let counted = of_members().filter(|pole| pole.order >= first);
        let models: BTreeSet<(usize, usize)> = counted.map(|pole| (pole.order, pole.block_rows)).collect();
        if (models.len() as f64) < look.presence * considered as f64 {
            continue;
        }
        let shape = mean_shape(of_members().map(|pole| &pole.shape));
        all.push(Cluster {
            models: models.len(),
            orders: models.iter().map(|(order, _)| order).collect::<BTreeSet<_>>().len(),
            frequency: Quartiles::from_values(of_members().map(|p| p.mode.natural_frequency_rad_per_s).collect()),
            damping: Quartiles::from_values(of_members().filter_map(|p| p.mode.damping_ratio).collect()),
            shape,
        });
    }
    all.sort_by(|a, b| b.models.cmp(&a.models).then(a.frequency.median.total_cmp(&b.frequency.median)));
    let mut kept: Vec<Cluster> = Vec::new();
    for cluster in all {
        let is_part_of = |other: &Cluster| {
            (other.frequency.median / cluster.frequency.median - 1.0).abs() <= NEAR
                && modal_assurance(&other.shape, &cluster.shape).unwrap_or(0.0) >= SAME_SHAPE
        };
        if !kept.iter().any(is_part_of) {
            kept.push(cluster);
        }
    }
    kept.sort_by(|a, b| a.frequency.median.total_cmp(&b.frequency.median));
    kept
}

/// The mean of shapes, each with its largest entry 1, turned the same way as the first.
fn mean_shape<'a>(shapes: impl Iterator<Item = &'a Vec<Complex>>) -> Vec<Complex> {
    let mut sum: Vec<Complex> = Vec::new();
    for shape in shapes {
        if sum.is_empty() {
            sum.clone_from(shape);
            continue;
        }
        let along: Complex = sum.iter().zip(shape).map(|(s, x)| x.conj() * s).sum();
        let turn = if along.norm() > 0.0 { along / along.norm() } else { Complex::new(1.0, 0.0) };
        sum.iter_mut().zip(shape).for_each(|(s, x)| *s += x * turn);
    }
    normalized(sum).unwrap_or_default()
}

/// Places of the members of every cluster; two merge while the mean distance of their members is at most `cut`.
fn average_linkage(poles: &[AmbientPole], cut: f64) -> Vec<Vec<usize>> {
    let n = poles.len();
    let frequency = |place: usize| poles[place].mode.natural_frequency_rad_per_s;
    let distance = |i: usize, j: usize| {
        let (a, b) = (frequency(i), frequency(j));
        (a - b).abs() / a.max(b) + 1.0 - modal_assurance(&poles[i].shape, &poles[j].shape).unwrap_or(0.0)
    };
    // Sums of the distances between all members of two clusters.
    let mut sums: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| if i == j { 0.0 } else { distance(i, j) }).collect()).collect();
    let mut members: Vec<Vec<usize>> = (0..n).map(|place| vec![place]).collect();
    loop {
        let mut closest: Option<(f64, usize, usize)> = None;
        for i in (0..n).filter(|i| !members[*i].is_empty()) {
            for j in (0..i).filter(|j| !members[*j].is_empty()) {
                let mean = sums[i][j] / (members[i].len() * members[j].len()) as f64;
                if mean <= cut && closest.is_none_or(|(least, ..)| mean < least) {
                    closest = Some((mean, j, i));
                }
            }
        }
        let Some((_, kept, merged)) = closest else { break };
        let moved = std::mem::take(&mut members[merged]);
        members[kept].extend(moved);
        let both: Vec<f64> = sums[kept].iter().zip(&sums[merged]).map(|(a, b)| a + b).collect();
        sums.iter_mut().zip(&both).for_each(|(row, sum)| row[kept] = *sum);
        sums[kept] = both;
    }
    members.into_iter().filter(|cluster| !cluster.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::random::RandomNumbers;

    #[test]
    fn modes_in_noise_are_found_with_their_shapes_and_no_others() {
        const DT_S: f64 = 0.02;
        // Two modes of two sensors, each driven by noise of its own.
        let truth = [(1.5, 0.02, [1.0, 0.8]), (4.0, 0.015, [-0.7, 1.0])];
        let mut random = RandomNumbers::seeded(4);
        let mut y = vec![vec![0.0; 8000]; 2];
        for (hz, damping, shape) in truth {
            let w = 2.0 * PI * hz;
            let z = (Complex::new(-damping * w, w * (1.0 - damping * damping).sqrt()) * DT_S).exp();
            let mut state = Complex::new(0.0, 0.0);
            for k in 0..8000 {
                state = z * state + Complex::new(random.normal(), random.normal());
                y.iter_mut().zip(shape).for_each(|(y, s)| y[k] += s * state.re);
            }
        }
        y.iter_mut().for_each(|y| y.iter_mut().for_each(|y| *y += 0.2 * random.normal()));
        let found = ambient_modes(&IoData::new(Vec::new(), y, DT_S).unwrap(), AmbientOptions::default()).unwrap();
        assert_eq!(found.modes.len(), 2, "{:?}", found.modes);
        for (mode, (hz, damping, shape)) in found.modes.iter().zip(truth) {
            let shape = shape.map(|x| Complex::new(x, 0.0));
            // Deviation of a frequency sqrt(damping/(8 pi f T)), about 0.3 %: five of these; damping likewise.
            assert!((mode.natural_frequency_rad_per_s.median / (2.0 * PI * hz) - 1.0).abs() < 0.015, "{mode:?}");
            assert!((mode.damping_ratio.median / damping - 1.0).abs() < 0.6, "{mode:?}");
            assert!(modal_assurance(&mode.shape, &shape).unwrap() > 0.98, "{mode:?}");
        }
    }
}
