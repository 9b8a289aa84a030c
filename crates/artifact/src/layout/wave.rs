//! Waveforms: one uniformly sampled signal, stored as blocks.

use std::collections::BTreeMap;

use crumple_signal::{Quantity, QuantityKind, Sampled, Signal, SignalError};

use crate::layout::codec::WAVE_LAYOUT;
use crate::layout::time_origin::{FARTHEST_S, to_ns};
use crate::records::WaveBlockV1;

/// Samples in a block; the last block of a waveform may be shorter.
pub(crate) const BLOCK_SAMPLES: usize = 65_536;

/// A waveform of an artifact: samples in SI units that know what they measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Wave {
    /// What is measured.
    pub quantity: QuantityKind,
    /// Grid and samples.
    pub sampled: Sampled,
}

impl Wave {
    /// The samples as a signal of `Q`; refused if they measure something else.
    pub fn signal<Q: Quantity>(&self) -> Result<Signal<Q>, SignalError> {
        if self.quantity != Q::KIND {
            return Err(SignalError::Quantity { found: self.quantity, needed: Q::KIND });
        }
        Ok(Signal::from(self.sampled.clone()))
    }

    pub(crate) fn t0_ns(&self) -> i64 {
        to_ns(self.sampled.t0_s())
    }

    pub(crate) fn channel_metadata(&self) -> BTreeMap<String, String> {
        [
            ("encoding", "bincode 2 legacy: fixed-int little-endian"),
            ("layout", WAVE_LAYOUT),
            ("quantity", self.quantity.name()),
            ("unit", self.quantity.si_unit()),
        ]
        .into_iter()
        .map(|(k, v)| (k.to_owned(), v.to_owned()))
        .collect()
    }
}

/// Puts a waveform together from its blocks, in order.
#[derive(Debug, Default)]
pub(crate) struct WaveAssembler {
    grid: Option<(i64, f64)>,
    samples: Vec<f64>,
}

impl WaveAssembler {
    pub(crate) fn push(&mut self, block: WaveBlockV1) -> Result<(), String> {
        let grid = (block.t0_ns, block.dt_s);
        match self.grid {
            None => self.grid = Some(grid),
            Some(known) if known == grid => {}
            Some((t0, dt)) => {
                return Err(format!(
                    "block at sample {} has t0_ns {} and dt_s {}, the blocks before it {t0} and {dt}",
                    block.first, block.t0_ns, block.dt_s
                ));
            }
        }
        if block.first != self.samples.len() as u64 {
            return Err(format!("a block starts at sample {}, expected {}", block.first, self.samples.len()));
        }
        if self.samples.is_empty() {
            self.samples = block.samples;
        } else {
            self.samples.extend_from_slice(&block.samples);
        }
        Ok(())
    }

    pub(crate) fn finish(self) -> Result<Sampled, String> {
        let (t0_ns, dt_s) = self.grid.ok_or("no block")?;
        if t0_ns.unsigned_abs() > to_ns(FARTHEST_S).unsigned_abs() {
            return Err(format!("it starts at {t0_ns} ns, times go from -292 to 292 years"));
        }
        // Division, not multiplication by 1e-9: -20,000,000 ns must read as -0.02 s to the last bit.
        Sampled::new(t0_ns as f64 / 1e9, dt_s, self.samples).map_err(|e| e.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(first: u64, n: usize) -> WaveBlockV1 {
        WaveBlockV1 { t0_ns: -20_000_000, dt_s: 1e-4, first, samples: vec![1.0; n] }
    }

    #[test]
    fn blocks_join_and_keep_the_start_time_to_the_last_bit() {
        let mut wave = WaveAssembler::default();
        wave.push(block(0, 3)).unwrap();
        wave.push(block(3, 2)).unwrap();
        let sampled = wave.finish().unwrap();
        assert_eq!(sampled.len(), 5);
        assert_eq!(sampled.t0_s(), -0.02);
    }

    #[test]
    fn a_wave_is_a_signal_of_what_it_measures_alone() {
        let sampled = Sampled::new(0.0, 1e-4, vec![1.0, 2.0]).unwrap();
        let wave = Wave { quantity: QuantityKind::Velocity, sampled };
        assert_eq!(wave.signal::<crumple_signal::Velocity>().unwrap().samples(), [1.0, 2.0]);
        assert!(matches!(
            wave.signal::<crumple_signal::Acceleration>(),
            Err(SignalError::Quantity { found: QuantityKind::Velocity, needed: QuantityKind::Acceleration })
        ));
    }

    #[test]
    fn a_missing_block_and_a_changed_grid_are_refused() {
        let mut wave = WaveAssembler::default();
        wave.push(block(0, 3)).unwrap();
        assert_eq!(wave.push(block(4, 1)).unwrap_err(), "a block starts at sample 4, expected 3");
        assert!(wave.push(WaveBlockV1 { dt_s: 2e-4, ..block(3, 1) }).is_err());
    }
}
