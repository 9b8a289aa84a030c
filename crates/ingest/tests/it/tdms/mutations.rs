//! Damaged files never panic.

use crumple_ingest::{Bundle, ingest};
use crumple_testkit::shared;
use proptest::prelude::*;

use crate::tdms::identity::nhtsa;
use crate::tdms::scaling::{daqmx, scaled};
use crate::tdms::time::with_times;
use crate::tdms::writer::{DAQMX, NEW_LIST, RAW, Writer, lenient, segment, simple};

/// Files whose mutations must not panic.
pub fn examples() -> Vec<Vec<u8>> {
    let mut examples = vec![simple(60, false), simple(60, true), with_times(61, 60, 1e-4), nhtsa()];
    let mut rows = Writer::new(false);
    daqmx(&mut rows, "/'g'/'a'", 30, 0, 6, &scaled("Linear"));
    examples.push(segment(NEW_LIST | RAW | DAQMX, 1, &rows, &[1; 360]));
    for path in ["iihs-diadem-tdms/Target Pulse.tdms", "nptdms-fixtures/raw1.tdms", "nptdms-fixtures/big_endian.tdms"] {
        if let Some(path) = shared(&format!("data/{path}")) {
            examples.push(std::fs::read(path).unwrap());
        }
    }
    examples
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_files_never_panic(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0_u8..5, any::<u32>()), 0..5),
        cut in prop::option::of(any::<prop::sample::Index>()),
        early in any::<bool>(),
    ) {
        thread_local! {
            static EXAMPLES: Vec<Vec<u8>> = examples();
        }
        let mut bytes = EXAMPLES.with(|all| which.get(all).clone());
        for (at, kind, value) in changes {
            // Metadata stand at the start: half of the runs change those only.
            let range = if early { bytes.len().min(3000) } else { bytes.len() };
            if range < 4 {
                break;
            }
            let at = at.index(range - 3);
            match kind {
                0 => bytes[at] = value as u8,
                1 => bytes[at..at + 4].copy_from_slice(&value.to_le_bytes()),
                2 => bytes[at..at + 4].copy_from_slice(&[0xFF; 4]),
                3 => bytes[at..at + 4].copy_from_slice(&(value % 40).to_le_bytes()),
                _ => drop(bytes.drain(at..at + 3)),
            }
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len() + 1));
        }
        match Bundle::from_bytes("t.tdms", bytes).and_then(|bundle| ingest(&bundle, &lenient())) {
            Ok(ingested) => {
                prop_assert!(ingested.waves.iter().all(|w| w.samples.samples().iter().all(|x| x.is_finite())));
            }
            Err(error) => prop_assert!(!error.to_string().is_empty() && !error.hint().is_empty()),
        }
    }
}
