//! Every real record at hand, damaged at random: the answer is a result or a refusal.

use std::fs;

use crumple_ingest::{Bundle, IngestError, IngestSettings, ingest};
use crumple_testkit::shared;
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::TestRunner;

/// A change: what, where, which piece, how long.
type Change = (u8, Index, u8, u16);

fn changes() -> impl Strategy<Value = Vec<Change>> {
    prop::collection::vec((any::<u8>(), any::<Index>(), any::<u8>(), 0_u16..400), 1..5)
}

/// Bytes set, pieces put in, taken out or doubled, the end cut off. Half of the places are in the first 4 KiB, where
/// the headers are.
fn mutate(mut bytes: Vec<u8>, changes: &[Change]) -> Vec<u8> {
    const PIECES: [&[u8]; 16] = [
        b"NaN",
        b",",
        b";",
        b"\t",
        b"\n",
        b"\"",
        b"-",
        b"1e999",
        b"|",
        b"\0\0\0\0",
        b"\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF",
        b":",
        b"0",
        b"\x7F\xFF\xFF\xFF",
        b"<",
        b"99999999999999999999",
    ];
    for (kind, at, piece, length) in changes {
        let span = if kind & 8 == 0 { bytes.len().min(4096) } else { bytes.len() };
        let at = at.index(span + 1);
        let end = (at + usize::from(*length)).min(bytes.len());
        let bytes_of_piece = PIECES[usize::from(*piece) % PIECES.len()];
        match kind % 6 {
            0 => drop(bytes.splice(at..at, bytes_of_piece.iter().copied())),
            1 => drop(bytes.splice(at..(at + bytes_of_piece.len()).min(bytes.len()), bytes_of_piece.iter().copied())),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let copy = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, copy));
            }
            4 => bytes[at..].iter_mut().take(1).for_each(|b| *b ^= piece),
            _ if kind & 16 == 0 => bytes.truncate(at),
            _ => {}
        }
    }
    bytes
}

fn check(name: &str, bundle: Result<Bundle, IngestError>) {
    // What a record lacks is not asked back, and messages are resampled, so that reading gets as far as it can.
    let settings = IngestSettings {
        allow_missing: Some(true),
        unit: Some("g".to_owned()),
        field: name.ends_with(".mcap").then(|| "clientX".to_owned()),
        sample_time: name.ends_with(".dat").then(|| "80ms".parse().unwrap()),
        resample: Some("20Hz".parse().unwrap()),
        ..IngestSettings::default()
    };
    match bundle.and_then(|bundle| ingest(&bundle, &settings)) {
        Ok(ingested) => {
            assert!(ingested.waves.iter().all(|w| w.samples.samples().iter().all(|x| x.is_finite())));
        }
        Err(error) => assert!(!error.to_string().is_empty() && !error.hint().is_empty()),
    }
}

/// Damages the main file and, half of the time, one of the files beside it.
fn never_panics(main: &str, beside: &[&str], cases: u32) {
    let Some(path) = shared(main) else { return };
    let folder = path.parent().unwrap();
    let name = path.file_name().unwrap().to_str().unwrap();
    let bytes = fs::read(&path).unwrap();
    let companions: Vec<(&str, Vec<u8>)> = beside.iter().map(|n| (*n, fs::read(folder.join(n)).unwrap())).collect();
    let config =
        ProptestConfig { cases, failure_persistence: None, max_shrink_iters: 200, ..ProptestConfig::default() };
    let work = tempfile::tempdir().unwrap();
    let strategy = (changes(), changes(), any::<Option<Index>>());
    TestRunner::new(config)
        .run(&strategy, |(of_main, of_companion, which)| {
            let main =
                if which.is_some() && of_main.len() % 2 == 0 { bytes.clone() } else { mutate(bytes.clone(), &of_main) };
            if name.ends_with(".zip") {
                let path = work.path().join(name);
                fs::write(&path, main).unwrap();
                check(name, Bundle::open(&path));
                return Ok(());
            }
            let bundle = Bundle::from_bytes(name, main).map(|mut bundle| {
                bundle.companions.extend(companions.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.clone())));
                if let Some(which) = which.filter(|_| !companions.is_empty()) {
                    let (name, bytes) = &companions[which.index(companions.len())];
                    bundle.companions.insert((*name).to_owned(), mutate(bytes.clone(), &of_companion));
                }
                bundle
            });
            check(name, bundle);
            Ok(())
        })
        .unwrap();
}

#[test]
fn nhtsa_specification_and_curves() {
    never_panics("data/nhtsa-v10146-camry-frontal/v10146.EV5", &["v10146.093", "v10146.094", "v10146.096"], 100);
}

#[test]
fn nhtsa_archive() {
    never_panics("data/nhtsa-v10146-camry-frontal/v10146_barrier_fx.zip", &[], 30);
}

#[test]
fn iso_channel() {
    never_panics("data/iso-mme-98_7707/98_7707.001", &[], 300);
}

#[test]
fn tdms_and_tdm() {
    never_panics("data/iihs-diadem-tdms/Target Pulse.tdms", &[], 1000);
    never_panics("data/nptdms-fixtures/big_endian.tdms", &[], 300);
    never_panics("data/nptdms-fixtures/raw1.tdms", &[], 300);
    never_panics("data/iihs-diadem-tdms/Corridors.TDM", &["Corridors.tdx"], 300);
}

#[test]
fn labview_texts() {
    for name in ["no_decimal_separator", "short", "with_empty_fields", "multi_time_column"] {
        never_panics(&format!("data/lvm-fixtures/{name}.lvm"), &[], 300);
    }
    never_panics("data/shock-table-lvm/Test_002.lvm", &[], 20);
}

#[test]
fn tables() {
    never_panics("data/iihs-cep1705-accord/CEP1705_ACXD.csv", &[], 100);
    never_panics("data/pcb-shock-txt/acc_base_a0.txt", &[], 100);
    never_panics("data/drop-tower-csv/accel_1.csv", &[], 40);
    never_panics("data/sysid/hair-dryer/dryer.dat", &[], 200);
}

#[test]
fn recordings() {
    never_panics("data/ros-imu-bag/tilt_laser.bag", &[], 60);
    never_panics("data/mcap-json/example.mcap", &[], 500);
}
