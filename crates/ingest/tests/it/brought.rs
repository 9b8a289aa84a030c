//! Records as people bring them: HDF5, Parquet and JSON lines, volts and counts, forces of a wall, mass and speed above
//! a table, and refusals that ask for everything at once.

use crumple_ingest::{IngestError, Ingested};
use crumple_signal::{Axis, STANDARD_GRAVITY_M_PER_S2 as G};

use crate::{given, notes, open, read_as};

/// A sound record of the fuzz corpus: half sine of 100 ms and 24.47 g from 0 s on, 2 kHz from -60 ms on.
fn sound(name: &str, flags: &str) -> Result<Ingested, IngestError> {
    open(crumple_testkit::workspace().join("fuzz/corpus/record").join(name), &given(flags))
}

#[track_caller]
fn check(ingested: &Ingested, id: &str) {
    let pulse = ingested.pulse().unwrap();
    assert_eq!((pulse.id.as_str(), pulse.samples.len(), pulse.samples.dt_s()), (id, 401, 5e-4));
    // Half a unit in the last place of single precision at 0.06 s.
    assert!((pulse.samples.t0_s() + 0.06).abs() < 2e-9, "{}", pulse.samples.t0_s());
    let lowest = pulse.samples.samples().iter().fold(0.0_f64, |lowest, a| lowest.min(*a));
    // Single precision in one, four decimals in another.
    assert!((lowest / (-24.47 * G) - 1.0).abs() < 1e-5, "{lowest}");
}

/// Written by h5py 3.16.0 and hdf5storage 0.2.2.
#[test]
fn hdf5_and_matlab_7_3() {
    check(&sound("packed.h5", "--time-zero-rule file").unwrap(), "test.acceleration");
    let with_time = sound("time.h5", "--time-zero-rule file").unwrap();
    check(&with_time, "accel");
    assert!(notes(&with_time).contains("not read: table"), "{}", notes(&with_time));
    check(&sound("v73.mat", "--time-zero-rule file").unwrap(), "accel_g");
}

/// Written by pandas 3.1.1 with pyarrow 26.0.1 (snappy, single precision, a column with nulls, one of texts) and by
/// polars 2.1.0 (zstd, stamps in nanoseconds); two by pyarrow 26.0.1 alone.
#[test]
fn parquet_is_a_table() {
    let of_pandas = sound("pulse.parquet", "--time-zero-rule file").unwrap();
    check(&of_pandas, "accel");
    assert!(notes(&of_pandas).contains("not read: label (texts)"), "{}", notes(&of_pandas));
    // Stamps count from the first one.
    check(&sound("stamps.parquet", "--time-zero 0.06s").unwrap(), "accel_g");
    for name in ["gzip.parquet", "lz4.parquet"] {
        check(&sound(name, "--time-zero-rule file").unwrap(), "accel");
    }
}

#[test]
fn a_cut_file_is_refused() {
    for name in ["packed.h5", "pulse.parquet"] {
        let bytes = std::fs::read(crumple_testkit::workspace().join("fuzz/corpus/record").join(name)).unwrap();
        for length in [9, 100, 600, 2000, bytes.len() - 100] {
            let error = read_as(name, &bytes[..length], &given("")).unwrap_err();
            assert!(!error.hint().is_empty(), "{length}: {error}");
        }
    }
}

/// A flipped byte gives a record or a refusal with advice.
#[test]
fn a_damaged_file_has_an_answer() {
    for name in ["packed.h5", "v73.mat", "pulse.parquet", "stamps.parquet", "gzip.parquet", "lz4.parquet"] {
        let sound = std::fs::read(crumple_testkit::workspace().join("fuzz/corpus/record").join(name)).unwrap();
        for k in 0..200 {
            let mut bytes = sound.clone();
            // Places spread over the file by the golden ratio.
            let at = (k as f64 * 0.618_033_988_75).fract() * bytes.len() as f64;
            bytes[at as usize] ^= 1 << (k % 8);
            if let Err(error) = read_as(name, bytes, &given("--time-zero 0s")) {
                assert!(!error.hint().is_empty(), "{name}, byte {at}: {error}");
            }
        }
    }
}

#[test]
fn json_lines_are_a_table() {
    let flags = "--time-zero-rule file --time-unit s --unit g --channel acc.x";
    check(&sound("lines.jsonl", flags).unwrap(), "acc.x");
    let error = sound("lines.jsonl", "").unwrap_err();
    assert!(error.hint().contains("--unit g") && error.hint().contains("--channel acc.x"), "{}", error.hint());
}

#[test]
fn events_and_late_numbers_among_json_lines_are_left_out_and_named() {
    let line = |k: i32| {
        let event = if k == 20 { "{\"t\":0.019,\"event\":\"airbag\"}\n" } else { "" };
        let late = if k > 10 { ",\"volt\":12.1" } else { "" };
        format!("{event}{{\"t\":{:.3},\"ax\":{}{late}}}\n", 1e-3 * f64::from(k), -k)
    };
    let file: String = (0..100).map(line).collect();
    let flags = given("--time-unit s --unit g --channel ax --time-zero 0s");
    let read = read_as("a.jsonl", file.into_bytes(), &flags).unwrap();
    assert_eq!(read.pulse().unwrap().samples.len(), 100);
    let said = notes(&read);
    assert!(said.contains("left out: volt") && said.contains("1 lines without"), "{said}");
}

/// 300 rows at 2 kHz from -50 ms on, the value of each column by its row.
fn table(head: &str, columns: &[&dyn Fn(usize) -> f64]) -> Vec<u8> {
    let row = |k: usize| {
        let cells: Vec<String> = columns.iter().map(|column| column(k).to_string()).collect();
        format!("{:.4},{}\n", -0.05 + k as f64 * 5e-4, cells.join(","))
    };
    (head.to_owned() + &(0..300).map(row).collect::<String>()).into_bytes()
}

fn ramp(k: usize) -> f64 {
    if k < 100 { 0.0 } else { -((k - 100) as f64) / 10.0 }
}

#[test]
fn volts_and_counts_have_a_stated_sensitivity() {
    let volts = table("time_s,ch2 [V]\n", &[&|k| 2.5 + 0.05 * ramp(k)]);
    let read = read_as("a.csv", volts.clone(), &given("--scale ch2=50mV/g@2.5V --time-zero 0s")).unwrap();
    let samples = read.pulse().unwrap().samples.samples().to_vec();
    assert!((samples[150] - G * ramp(150)).abs() < 1e-9, "{}", samples[150]);
    let counts = table("time_s,ax\n", &[&|k| (16384.0 * ramp(k) / 10.0).round()]);
    let read = read_as("a.csv", counts, &given("--scale ax=16384/g --time-zero 0s")).unwrap();
    assert!((read.pulse().unwrap().samples.samples()[150] - G * ramp(150) / 10.0).abs() < 1e-3);
    assert!(read_as("a.csv", volts, &given("--scale ch2=50/g --time-zero 0s")).is_err(), "counts of volts");
    // A refusal names the flag with the name of the column, also where the unit is that of a voltage or none.
    for (name, advised) in [("ch2 [mV]", "ch2"), ("ch 2 (V)", "ch_2"), ("Acc ch2", "Acc_ch2")] {
        let file = table(&format!("time_s,{name}\n"), &[&|k| 2.5 + 0.05 * ramp(k)]);
        let hint = read_as("a.csv", file.clone(), &given("--time-zero 0s")).unwrap_err().hint().to_owned();
        assert!(hint.contains(&format!("--scale \"{advised}=50mV/g\"")), "{name}: {hint}");
        assert!(read_as("a.csv", file, &given(&format!("--scale {advised}=50mV/g --time-zero 0s"))).is_ok(), "{name}");
    }
}

#[test]
fn a_force_of_the_wall_is_one_by_its_name_or_by_the_flag() {
    let of = |name: &str, flags: &str| {
        let file = table(&format!("time_s,accel_g,{name}\n"), &[&ramp, &|k| -10.0 * ramp(k)]);
        read_as("a.csv", file, &given(&format!("--time-zero 0s {flags}")))
    };
    for (name, flags) in
        [("wall force [kN]", ""), ("B0BARR0000FOXP [kN]", ""), ("F3 [kN]", "--wall F3"), ("F3 [kN]", "--wall 3")]
    {
        let read = of(name, flags).unwrap();
        assert!(read.test.channels[1].is_wall_force(), "{name} {flags}");
    }
    assert!(!of("F3 [kN]", "").unwrap().test.channels[1].is_wall_force());
    assert!(of("F3 [kN]", "--wall accel_g").unwrap_err().to_string().contains("is no force"));
}

#[test]
fn mass_and_speed_stand_above_the_names() {
    let head = "Versuch;VW 12\nMasse;1719 kg\nGeschwindigkeit [km/h];57,1\nZeit [s];Beschleunigung [g]\n";
    let rows = table("", &[&ramp]);
    let rows = String::from_utf8(rows).unwrap().replace(',', ";").replace('.', ",");
    let read = read_as("a.csv", (head.to_owned() + &rows).into_bytes(), &given("--time-zero 0s")).unwrap();
    assert_eq!(read.test.mass_kg, Some(1719.0));
    assert!((3.6 * read.test.impact_speed_m_per_s.unwrap() - 57.1).abs() < 1e-9);
}

#[test]
fn a_refusal_asks_for_everything_at_once() {
    let file = String::from_utf8(table("t,x,y\n", &[&ramp, &ramp])).unwrap();
    let counted: String = file.lines().enumerate().fold(String::new(), |mut text, (k, line)| {
        text += &match (k, line.split_once(',')) {
            (0, _) | (_, None) => format!("{line}\n"),
            (k, Some((_, rest))) => format!("{k},{rest}\n"),
        };
        text
    });
    let error = read_as("a.csv", counted.clone().into_bytes(), &given("")).unwrap_err();
    for flag in ["--time-unit ms", "--unit g", "--channel x"] {
        assert!(error.hint().contains(flag), "{flag}: {}", error.hint());
    }
    assert!(
        read_as("a.csv", counted.into_bytes(), &given("--time-unit ms --unit g --channel x --time-zero 0s")).is_ok()
    );
}

#[test]
fn a_recorder_that_kept_a_lateral_change_alone_is_read() {
    let rows: String = (0..15).map(|k: i32| format!("{},{}\n", 10 * k, (3 * k).min(22))).collect();
    let file = format!("Time (ms),Lateral Delta-V (km/h)\n{rows}");
    let read = read_as("a.csv", file.into_bytes(), &given("--profile edr")).unwrap();
    assert_eq!(read.test.pulse.as_deref(), Some("Lateral_Delta-V"));
    assert_eq!(read.test.channels[0].axis, Some(Axis::Y));
}
