//! How far an impact reaches: the largest compression of every element, and the speed.

use crumple_lumped::{Motion, Node, Structure};

use crate::impact::outcome::Wave;

/// What is not counted as beyond: rounding, and the samples between which a largest compression lies.
const BEYOND: f64 = 1.001;

/// How far an impact reaches.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Largest compression of each element, m, in the order of the structure.
    pub compression_m: Vec<f64>,
    /// Impact speed, m/s.
    pub speed_m_per_s: f64,
}

impl Reach {
    /// The reach of an impact.
    pub(crate) fn new(structure: &Structure, wave: &Wave, speed_m_per_s: f64) -> Self {
        let place = |node: Node| match node {
            Node::Wall => None,
            Node::Mass(i) => wave.motions.get(i),
        };
        let at = |motion: Option<&Motion>, k: usize| motion.map_or(0.0, |motion| motion.displacement_m[k]);
        let samples = wave.compartment().map_or(0, |motion| motion.displacement_m.len());
        let compression_m = structure
            .connections()
            .iter()
            .map(|connection| {
                let (front, rear) = (place(connection.front), place(connection.rear));
                (0..samples).map(|k| at(rear, k) - at(front, k)).fold(0.0, f64::max)
            })
            .collect();
        Self { compression_m, speed_m_per_s }
    }

    /// The largest factor by which a compression goes beyond that of a test, with the number of the element, from 1;
    /// `None`: none does.
    pub fn beyond(&self, tested: &Self) -> Option<(usize, f64)> {
        let pairs = self.compression_m.iter().zip(&tested.compression_m).enumerate();
        pairs
            .filter(|(_, (_, tested))| **tested > 0.0)
            .map(|(k, (asked, tested))| (k + 1, asked / tested))
            .filter(|(_, factor)| *factor > BEYOND)
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Whether the speed goes beyond that of a test.
    pub fn is_faster(&self, tested: &Self) -> bool {
        self.speed_m_per_s > BEYOND * tested.speed_m_per_s
    }
}
