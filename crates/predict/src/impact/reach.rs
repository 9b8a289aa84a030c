//! How far an impact reaches: the largest compression of every element, and the speed.

use crumple_lumped::{Node, Structure};

use crate::impact::outcome::{Side, Wave};

/// What is not counted as beyond: rounding, and the samples between which a largest compression lies.
const BEYOND: f64 = 1.001;

/// How far an impact reaches.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Largest compression of each element, m, in the order of the structure.
    pub compression_m: Vec<f64>,
    /// Impact speed on a wall, or that of the same energy, m/s.
    pub speed_m_per_s: f64,
}

impl Reach {
    /// The reach of an impact in the structure of one side.
    pub(crate) fn new(structure: &Structure, wave: &Wave, side: Side, speed_m_per_s: f64) -> Self {
        let displacements = wave.crush_of_masses(side);
        let place = |node: Node| match node {
            Node::Wall => None,
            Node::Mass(i) => displacements.get(i),
        };
        let at = |displacement: Option<&Vec<f64>>, k: usize| displacement.map_or(0.0, |displacement| displacement[k]);
        let samples = displacements.last().map_or(0, Vec::len);
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
