//! Any bytes as a record: the reader that recognises them reads or refuses them, as a list, as a crash and as the table
//! of a recorder, and never panics.
#![no_main]

use crumple_ingest::{Bundle, IngestSettings, Profile, ingest, list};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(bundle) = Bundle::from_bytes("record", bytes.to_vec()) else { return };
    let plain = IngestSettings::default();
    let unit = IngestSettings { unit: Some("g".to_owned()), sample_time: "1ms".parse().ok(), ..plain.clone() };
    let recorder = IngestSettings { profile: Some(Profile::Edr), ..plain.clone() };
    let _ = list(&bundle, &plain);
    for settings in [plain, unit, recorder] {
        let _ = ingest(&bundle, &settings);
    }
});
