//! Whatever the bytes, the answer is a result or a refusal.

use std::fs;

use crumple_ingest::{Bundle, IngestError, IngestSettings, Refusal, Wave, ingest};
use crumple_signal::QuantityKind;
use crumple_testkit::{shared, simulated};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::TestRunner;

use crate::messages::mcap_file;
use crate::protobuf::{MAGIC, records};
use crate::{given, lenient, lvm, read_as, tdm, tdms, write, zipped};

const CSV: &str = "# mass: 873 kg\n# impact speed: 36 km/h\ntime_s,accel_g,force [kN]\n";
const EV5: &str = "# Source\n----- EV5 -----\n----- TEST -----\nV5|NCAP - 2018 CAR|||LAB||R|NCA|VTB|||22|||57.09|0|0\n\
    ----- VEHICLE -----\n1|16|03|2018|||||||1719|1514\n----- BARRIER -----\nR|LCB|0|0|X\n----- INSTRUMENTATION -----\n\
    1|93|AC|NA|FLLR|XG|SEC|G'S|2800|M|D|800|21|57.09|-5|64|100|AM|P|REAR SEAT X\n\
    1|96|AC|NA|ENGN|XG|SEC|G'S|2800|M|D|800|21|57.09|-5|64|100|CF|P|ENGINE X: bad\n----- END -----\n";

fn table() -> Vec<u8> {
    let rows: String =
        (0..60).map(|k| format!("{:.4},{:.3},{k}\n", f64::from(k) * 1e-4 - 0.001, -0.1 * f64::from(k))).collect();
    (CSV.to_owned() + &rows).into_bytes()
}

fn curve() -> Vec<u8> {
    (-5..65)
        .map(|k| format!("{:.6}\t{:.6}\n", f64::from(k) * 1e-4, -0.1 * f64::from(k)))
        .collect::<String>()
        .into_bytes()
}

fn test_as_zip() -> Vec<u8> {
    zipped(&[("t/v1.EV5", EV5.as_bytes()), ("t/v1.093", &curve()), ("t/v1.096", &curve())])
}

/// An ISO-MME channel file.
fn channel_file() -> Vec<u8> {
    let samples: String = (0..80).map(|k| format!("{:.4e}\n", -0.1 * f64::from(k))).collect();
    format!(
        "Test object number          :1\nChannel code                :10SECMLERE00ACXP\n\
         Unit                        :g\n\
         Reference channel           :implicit\nSampling interval           :0.0001\n\
         Time of first sample        :-0.002\nNumber of samples           :80\n{samples}NOVALUE\n"
    )
    .into_bytes()
}

/// An MCAP file of JSON messages.
fn recording() -> Vec<u8> {
    let messages = (0..60_u64).map(|k| (1_000_000 * k, format!("{{\"x\":{k}}}").into_bytes()));
    mcap_file(("", "", b""), ("/a", "json"), None, messages)
}

/// A ROS bag without chunks.
fn bag() -> Vec<u8> {
    [MAGIC, &records().concat()].concat()
}

/// A change: what, where, which piece, how long or which number.
type Change = (u8, Index, u8, u32);

fn changes() -> impl Strategy<Value = Vec<Change>> {
    vec((any::<u8>(), any::<Index>(), any::<u8>(), any::<u32>()), 0..6)
}

/// Pieces that matter to a reader.
const PIECES: [&[u8]; 38] = [
    b"NaN",
    b",",
    b";",
    b"\t",
    b"\n",
    b"\r\n",
    b"\"",
    b"#",
    b"-",
    b"1e999",
    b"|",
    b"\0",
    b"\xFF\xFE",
    b" ",
    b":",
    b"-----",
    b"99999999999999999999",
    b"\n\n",
    b"e",
    b".",
    b"0",
    b"kg",
    b"\0\0\0\0",
    b"\x7F\xFF\xFF\xFF",
    b"\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF",
    b"<",
    b">",
    b"id(\"",
    b"usi1",
    b"&amp;",
    b"eInt8Usi",
    b"explicit",
    b"\xFF",
    b"***End_of_Header***",
    b"***Start_Special***\n",
    b"Multi",
    b"-1",
    b"",
];

/// Bytes and numbers set, pieces put in, taken out or doubled, the end cut off. Half of the places are in the first 4
/// KiB, where the headers are.
fn mutate(mut bytes: Vec<u8>, changes: &[Change]) -> Vec<u8> {
    for (kind, at, piece, number) in changes {
        let span = if kind & 8 == 0 { bytes.len().min(4096) } else { bytes.len() };
        let at = at.index(span + 1);
        let piece_of = PIECES[usize::from(*piece) % PIECES.len()];
        let end_after = |length: usize| (at + length).min(bytes.len());
        let (end, end_of_piece, end_of_number) =
            (end_after(*number as usize % 400), end_after(piece_of.len()), end_after(4));
        match kind % 8 {
            0 => drop(bytes.splice(at..at, piece_of.iter().copied())),
            1 => drop(bytes.splice(at..end_of_piece, piece_of.iter().copied())),
            2 => drop(bytes.drain(at..if kind & 16 == 0 { end } else { end_of_piece })),
            3 => drop(bytes.splice(at..at, bytes[at..end].to_vec())),
            4 => bytes[at..].iter_mut().take(1).for_each(|b| *b ^= piece),
            5 => drop(bytes.splice(at..end_of_number, number.to_le_bytes())),
            6 => drop(bytes.splice(at..end_of_number, (number % 40).to_le_bytes())),
            _ if kind & 16 == 0 => bytes.truncate(at),
            _ => bytes.truncate(bytes.len() - (bytes.len() - at) / 8),
        }
    }
    bytes
}

/// A result has finite samples and a pulse; a refusal has words. Reaching the end is the point.
fn check(bundle: Result<Bundle, IngestError>, settings: &IngestSettings) {
    match bundle.and_then(|bundle| ingest(&bundle, settings)) {
        Ok(ingested) => {
            let is_long = |w: &Wave| w.samples.len() >= 50 || w.quantity != QuantityKind::Acceleration;
            assert!(ingested.pulse().is_none_or(is_long));
            assert!(ingested.waves.iter().all(|w| w.samples.samples().iter().all(|x| x.is_finite())));
        }
        Err(error) => assert!(!error.to_string().is_empty() && !error.hint().is_empty()),
    }
}

/// What people state of made records.
fn stated() -> Vec<IngestSettings> {
    let channels =
        ["", "--channel accel_g", "--channel 93", "--channel 1", "--channel 2", "--channel 96", "--channel x"];
    let unit = |channel: &str| format!("--field x --unit g {channel}");
    channels.iter().flat_map(|c| [given(c), given(&format!("--allow-missing {c}")), given(&unit(c))]).collect()
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, max_shrink_iters: 200, ..ProptestConfig::default() }
}

/// Damages the main file and, half of the time, one of the files beside it.
fn never_panics(name: &str, bytes: &[u8], beside: &[(&str, Vec<u8>)], settings: &[IngestSettings], cases: u32) {
    let work = tempfile::tempdir().unwrap();
    let strategy = (changes(), changes(), any::<Option<Index>>(), any::<Index>());
    let run = |(of_main, of_companion, which, of_settings): (Vec<Change>, Vec<Change>, Option<Index>, Index)| {
        let is_whole = which.is_some() && of_main.len() % 2 == 0 && !beside.is_empty();
        let main = if is_whole { bytes.to_vec() } else { mutate(bytes.to_vec(), &of_main) };
        let bundle = if name.ends_with(".zip") {
            write(work.path(), &[(name, main)]);
            Bundle::open(&work.path().join(name))
        } else {
            Bundle::from_bytes(name, main).map(|mut bundle| {
                bundle.companions.extend(beside.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.clone())));
                if let Some(which) = which.filter(|_| !beside.is_empty()) {
                    let (name, bytes) = &beside[which.index(beside.len())];
                    bundle.companions.insert((*name).to_owned(), mutate(bytes.clone(), &of_companion));
                }
                bundle
            })
        };
        check(bundle, of_settings.get(settings));
        Ok(())
    };
    TestRunner::new(config(cases)).run(&strategy, run).unwrap();
}

#[test]
fn the_unchanged_examples_are_read() {
    assert!(read_as("a.csv", table(), &IngestSettings::default()).is_ok());
    let mut bundle = Bundle::from_bytes("v1.EV5", EV5.as_bytes().to_vec()).unwrap();
    bundle.companions.insert("v1.093".to_owned(), curve());
    assert_eq!(ingest(&bundle, &IngestSettings::default()).unwrap().test.pulse.as_deref(), Some("93"));
    assert_eq!(ingest(&open("v1.zip", &test_as_zip()).unwrap(), &IngestSettings::default()).unwrap().waves.len(), 2);
    let settings = given("--field x --allow-missing");
    for (name, bytes, waves) in [("a.001", channel_file(), 1), ("a.bag", bag(), 6), ("a.mcap", recording(), 1)] {
        assert_eq!(read_as(name, bytes, &settings).unwrap().waves.len(), waves, "{name}");
    }
}

#[test]
fn mutated_tables() {
    never_panics("a.csv", &table(), &[], &stated(), 1000);
}

#[test]
fn mutated_tests() {
    never_panics("v1.EV5", EV5.as_bytes(), &[("v1.093", curve()), ("v1.096", curve())], &stated(), 1000);
    never_panics("v1.zip", &test_as_zip(), &[], &stated(), 200);
}

#[test]
fn mutated_recordings() {
    never_panics("a.001", &channel_file(), &[], &stated(), 500);
    never_panics("a.bag", &bag(), &[], &stated(), 500);
    never_panics("a.mcap", &recording(), &[], &stated(), 500);
}

#[test]
fn mutated_simulations() {
    let settings = [lenient(), given("--units mm-ms-kg --node 7"), given("--units mm-s-t --allow-missing")];
    never_panics("binout", &simulated::binout(true), &[("binout%001", simulated::binout(false))], &settings, 200);
    never_panics(
        "nodout",
        simulated::nodout().as_bytes(),
        &[("rwforc", simulated::rwforc().into_bytes())],
        &settings,
        200,
    );
    never_panics("T01", &simulated::t01(), &[("T01_TITLES", b"0\nDX\n0\nDY\n".to_vec())], &settings, 200);
}

#[test]
fn mutated_measurements() {
    for example in lvm::examples() {
        never_panics("t.lvm", &example, &[], &[IngestSettings::default(), given("--allow-missing --channel 1")], 1000);
    }
    for example in tdms::examples() {
        never_panics("t.tdms", &example, &[], &[lenient()], 300);
    }
    let (tdm, tdx) = tdm::example();
    never_panics("t.TDM", tdm.as_bytes(), &[("t.tdx", tdx)], &[IngestSettings::default()], 800);
}

proptest! {
    #![proptest_config(config(1000))]

    #[test]
    fn any_bytes(bytes in vec(any::<u8>(), 0..400), which in any::<Index>()) {
        check(Bundle::from_bytes("a.bin", bytes), which.get(&stated()));
    }

    #[test]
    fn any_printed_text(text in "[-0-9.,;eE\t \n#a-z\"()]{0,400}", which in any::<Index>()) {
        check(Bundle::from_bytes("a.txt", text.into_bytes()), which.get(&stated()));
    }
}

/// Damages real files. What a record lacks is not asked back, and messages are resampled, so that reading gets as far
/// as it can.
fn real_file_never_panics(main: &str, beside: &[&str], cases: u32) {
    let Some(path) = shared(main) else { return };
    let flags = match main.rsplit_once('.') {
        Some((_, "mcap")) => "--field clientX",
        Some((_, "dat")) => "--sample-time 80ms",
        _ => "",
    };
    let settings = given(&format!("--allow-missing --unit g --resample 20Hz {flags}"));
    let beside: Vec<_> = beside.iter().map(|n| (*n, fs::read(path.with_file_name(n)).unwrap())).collect();
    let name = path.file_name().unwrap().to_str().unwrap();
    never_panics(name, &fs::read(&path).unwrap(), &beside, &[settings], cases);
}

fn open(name: &str, bytes: &[u8]) -> Result<Bundle, IngestError> {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[(name, bytes)]);
    Bundle::open(&folder.path().join(name))
}

fn refused(bundle: Result<Bundle, IngestError>) -> String {
    let error = match bundle.and_then(|bundle| ingest(&bundle, &IngestSettings::default())) {
        Err(error) => error,
        Ok(_) => panic!("it was read"),
    };
    assert!(error.refusal == Refusal::TooLarge, "{error:?}");
    error.to_string()
}

#[test]
fn a_zip_bomb_is_not_inflated_to_its_end() {
    let bomb = zipped(&[("a.csv", vec![b'0'; 300 << 20])]);
    assert!(bomb.len() < 1 << 20, "a good bomb is small");
    assert_eq!(refused(open("a.zip", &bomb)), "a.zip: a.csv: more than 256 MiB when unpacked");
}

#[test]
fn a_bomb_of_many_files_is_refused_by_what_it_claims() {
    let curves = (0..9).map(|k| (format!("v1.{k:03}"), "0\n"));
    let specification = ("v1.EV5".to_owned(), "----- EV5 -----\n----- TEST -----\n");
    let mut bomb = zipped(&std::iter::once(specification).chain(curves).collect::<Vec<_>>());
    // Each of the nine claims 240 MiB, within the limit of a file: 24 bytes into its entry of the central directory.
    let entries: Vec<usize> = (0..bomb.len()).filter(|at| bomb[*at..].starts_with(b"PK\x01\x02")).collect();
    for at in &entries[1..] {
        bomb[at + 24..at + 28].copy_from_slice(&(240_u32 << 20).to_le_bytes());
    }
    assert_eq!(refused(open("a.zip", &bomb)), "a.zip: the files of the record take more than 2048 MiB");
}

#[test]
fn an_archive_of_countless_files_is_refused_before_any_is_read() {
    let files: Vec<(String, &str)> = (0..20_001).map(|k| (format!("{k}.csv"), "")).collect();
    assert_eq!(refused(open("a.zip", &zipped(&files))), "a.zip: 20001 entries");
}

#[test]
fn what_has_no_end_is_refused_where_it_starts() {
    let line = "1".repeat((1 << 20) + 10);
    let (channel, row) = ("Channel code :10VEHC000000ACX0\n", vec!["1"; 5000].join(","));
    for (name, text, said) in [
        ("a.csv", format!("0,1\n{line}"), "a.csv, line 2: the line is longer than 1 MiB"),
        ("a.001", format!("{channel}Comments :{line}"), "a.001, line 2: the line is longer than 1 MiB"),
        (
            "a.001",
            channel.to_owned() + &"Comments :x\n".repeat(20_000),
            "a.001, line 10001: more than 10000 lines of keywords",
        ),
        ("a.csv", format!("{row}\n{row}\n"), "a.csv, line 1: 5000 columns"),
    ] {
        assert_eq!(refused(open(name, text.as_bytes())), said);
    }
}

#[test]
fn nhtsa_specification_and_curves() {
    real_file_never_panics(
        "data/nhtsa-v10146-camry-frontal/v10146.EV5",
        &["v10146.093", "v10146.094", "v10146.096"],
        100,
    );
}

#[test]
fn nhtsa_archive() {
    real_file_never_panics("data/nhtsa-v10146-camry-frontal/v10146_barrier_fx.zip", &[], 30);
}

#[test]
fn iso_channel() {
    real_file_never_panics("data/iso-mme-98_7707/98_7707.001", &[], 300);
}

#[test]
fn tdms_and_tdm() {
    real_file_never_panics("data/iihs-diadem-tdms/Target Pulse.tdms", &[], 1000);
    real_file_never_panics("data/nptdms-fixtures/big_endian.tdms", &[], 300);
    real_file_never_panics("data/nptdms-fixtures/raw1.tdms", &[], 300);
    real_file_never_panics("data/iihs-diadem-tdms/Corridors.TDM", &["Corridors.tdx"], 600);
}

#[test]
fn labview_texts() {
    for name in ["no_decimal_separator", "short", "with_empty_fields", "multi_time_column"] {
        real_file_never_panics(&format!("data/lvm-fixtures/{name}.lvm"), &[], 300);
    }
    real_file_never_panics("data/shock-table-lvm/Test_002.lvm", &[], 20);
}

#[test]
fn tables() {
    real_file_never_panics("data/iihs-cep1705-accord/CEP1705_ACXD.csv", &[], 100);
    real_file_never_panics("data/pcb-shock-txt/acc_base_a0.txt", &[], 100);
    real_file_never_panics("data/drop-tower-csv/accel_1.csv", &[], 40);
    real_file_never_panics("data/sysid/hair-dryer/dryer.dat", &[], 200);
}

#[test]
fn recordings() {
    real_file_never_panics("data/ros-imu-bag/tilt_laser.bag", &[], 60);
    real_file_never_panics("data/mcap-json/example.mcap", &[], 500);
}
