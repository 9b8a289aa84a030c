//! Poles of many orders gathered to modes.
//!
//! A mode of the structure comes back at every order, a pole that fits noise somewhere else each time. Poles that lie
//! close together in frequency and shape, over at least half of the orders, are one mode; their scatter is its
//! uncertainty.

use crumple_estimation::statistics::quantile;

use crate::order::stabilization::{DiagramPole, StabilizationOptions, distance};

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
    fn of(mut values: Vec<f64>) -> Self {
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
pub(crate) fn clusters(poles: &[DiagramPole], orders: usize, options: &StabilizationOptions) -> Vec<PoleCluster> {
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
    let mut found: Vec<PoleCluster> = names
        .into_iter()
        .filter_map(|name| {
            let members: Vec<&DiagramPole> =
                lasting.iter().zip(&cluster).filter(|(_, c)| **c == name).map(|(pole, _)| *pole).collect();
            let mut present: Vec<usize> = members.iter().map(|pole| pole.order).collect();
            present.sort_unstable();
            present.dedup();
            (present.len() as f64 >= options.presence * orders as f64).then(|| PoleCluster {
                orders: present.len(),
                natural_frequency_rad_per_s: Quartiles::of(
                    members.iter().map(|pole| pole.mode.natural_frequency_rad_per_s).collect(),
                ),
                damping_ratio: Quartiles::of(members.iter().filter_map(|pole| pole.mode.damping_ratio).collect()),
            })
        })
        .collect();
    found.sort_by(|a, b| a.natural_frequency_rad_per_s.median.total_cmp(&b.natural_frequency_rad_per_s.median));
    found
}
