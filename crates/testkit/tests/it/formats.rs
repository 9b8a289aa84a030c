//! Records of several formats through ingest, filter and integrate, and through the whole run.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_artifact::Artifact;
use crumple_artifact::records::EventsV1;
use crumple_signal::Sampled;
use crumple_testkit::programs::{ARTIFACTS, binary, code_and_error, number, summary_of};
use crumple_testkit::shared;

const G: f64 = crumple_signal::STANDARD_GRAVITY_M_PER_S2;

fn stage(name: &str, input: &Path, output: &Path, flags: &[&str]) {
    let mut command = Command::new(binary(name));
    let (code, text) = code_and_error(command.arg(input).arg("-o").arg(output).args(flags));
    assert_eq!(code, 0, "{name}: {text}");
}

/// The first three artifacts of a record, the samples left unfiltered.
fn three(folder: &Path, record: &Path, of_ingest: &[&str], of_integrate: &[&str]) -> [PathBuf; 3] {
    let path = |name: &str| folder.join(name);
    let made = [path(ARTIFACTS[0]), path(ARTIFACTS[1]), path(ARTIFACTS[2])];
    stage("crumple-ingest", record, &made[0], of_ingest);
    stage("crumple-filter", &made[0], &made[1], &["--cfc", "none", "--zero-level", "none"]);
    stage("crumple-integrate", &made[1], &made[2], of_integrate);
    made
}

/// The wave of the pulse that integrate adds under `what`.
fn motion(artifact: &Artifact, pulse: &str, what: &str) -> Sampled {
    let id = format!("{pulse}/{what}");
    artifact.waves().get(&id).unwrap_or_else(|| panic!("no {id} in {:?}", artifact.waves().keys())).sampled.clone()
}

#[test]
fn the_target_pulse_of_a_tdms_file_integrates_to_its_printed_velocity() {
    let Some(record) = shared("data/iihs-diadem-tdms/Target Pulse.tdms") else { return };
    let folder = tempfile::tempdir().unwrap();
    let made =
        three(folder.path(), &record, &["--mass", "1500kg", "--impact-speed", "10m/s"], &["--start", "time-zero"]);
    let artifact = Artifact::open(&made[2]).unwrap();
    let velocity = motion(&artifact, "IIWPG_Target_Pulse.IIWPG_Acceleration", "velocity");
    let v = velocity.samples();
    assert_eq!(v.len(), 92);
    // Printed in the file with 16 digits; 1e-12 is some thousand roundings of 14 m/s.
    assert!((v[91] - v[0] - 4.344_990_423_424_699).abs() < 1e-12, "{}", v[91] - v[0]);
}

const SPEED_M_PER_S: f64 = 14.0;
const LENGTH_S: f64 = 0.1;
const PEAK_G: f64 = 25.0;

/// A half sine of 25 g over 100 ms from t = 0; at contact and after it 0.
fn half_sine(t: f64) -> f64 {
    if (0.0..LENGTH_S).contains(&t) { -PEAK_G * (PI * t / LENGTH_S).sin() } else { 0.0 }
}

/// Dynamic crush of the half sine in closed form: v(t) = v0 - A T/pi (1 - cos(pi t/T)) is 0 at t_m.
fn crush() -> (f64, f64) {
    let at = PEAK_G * G * LENGTH_S / PI;
    let t = LENGTH_S / PI * (1.0 - SPEED_M_PER_S / at).acos();
    (t, (SPEED_M_PER_S - at) * t + at * LENGTH_S / PI * (PI * t / LENGTH_S).sin())
}

/// The trapezoidal rule errs in the velocity by dt^2/12 max|a''| t = 1e-8/12 * 2.4e5 * 0.08 = 1.6e-5 m/s at most, so by
/// 6e-7 m in the displacement, and by 1e-7 s in the time, where the deceleration is 150 m/s^2 and more. Samples are
/// printed to 1e-6 g.
fn assert_crush(artifact: &Path) {
    let events: EventsV1 = Artifact::open(artifact).unwrap().record("/events").unwrap().unwrap();
    let (t, c) = crush();
    let (found_t, found_c) = (events.time_of_dynamic_crush_s.unwrap(), events.dynamic_crush_m.unwrap());
    assert!((found_c - c).abs() < 1e-6 && (found_t - t).abs() < 1e-6, "{found_c} m at {found_t} s, {c} m at {t} s");
}

fn lvm() -> String {
    let mut text = "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\tNo\n\
        Date\t2024/01/02\nTime\t10:00:00\n***End_of_Header***\t\n\t\nChannels\t2\nSamples\t2500\t2500\n\
        Date\t2024/01/02\t2024/01/02\nTime\t10:00:00\t10:00:00\nY_Unit_Label\tg\tN\nX_Dimension\tTime\tTime\n\
        X0\t-5,0E-2\t-5,0E-2\nDelta_X\t1,0E-4\t1,0E-4\n***End_of_Header***\t\t\nX_Value\tacc\tforce\tComment\n"
        .to_owned();
    for k in 0..2500 {
        let a = half_sine(f64::from(k - 500) * 1e-4);
        writeln!(text, "\t{}\t{k}", format!("{a:.6}").replace('.', ",")).unwrap();
    }
    text
}

#[test]
fn a_labview_record_has_the_crush_of_its_closed_form() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("a.lvm");
    fs::write(&record, lvm()).unwrap();
    let made = three(folder.path(), &record, &["--mass", "1t", "--impact-speed", "14m/s"], &[]);
    assert_crush(&made[2]);
}

#[test]
fn a_real_shock_record_of_labview_goes_through() {
    let Some(record) = shared("data/shock-table-lvm/Test_002.lvm") else { return };
    let folder = tempfile::tempdir().unwrap();
    let flags = ["--mass", "1kg", "--impact-speed", "3m/s", "--channel", "1"];
    let made = three(folder.path(), &record, &flags, &[]);
    let (first, last) = (Artifact::open(&made[1]).unwrap(), Artifact::open(&made[2]).unwrap());
    let pulse = first.record::<crumple_artifact::records::TestV1>("/test").unwrap().unwrap().pulse.unwrap();
    let a = &first.waves()[&pulse].sampled;
    let v = motion(&last, &pulse, "velocity");
    // The sum of the trapezoids over the record, taken here once more; roundings of 1e5 sums of numbers up to 10.
    let from = a.len() - v.len();
    let sum: f64 = a.samples()[from..].windows(2).map(|w| 0.5 * (w[0] + w[1]) * a.dt_s()).sum();
    assert!((v.samples()[v.len() - 1] - v.samples()[0] - sum).abs() < 1e-9);
}

/// An ISO-MME test of 600 channels: six accelerometers on the structure, 94 on dummies, 500 cells of a barrier that
/// together carry the force of 1500 kg.
pub fn iso_mme(folder: &Path) -> PathBuf {
    let top = folder.join("T600");
    fs::create_dir_all(top.join("Channel")).unwrap();
    let mme = "Data format edition number  :1.6\r\nTitle                       :six hundred\r\nMass test object \
        1          :1500 kg\r\n\
        Velocity test object 1      :14 m/s\r\n";
    fs::write(top.join("T600.mme"), mme).unwrap();
    let mut codes: Vec<(String, f64, &str)> = Vec::new();
    for (place, side) in ["SECM", "SILB", "BPIL"].iter().flat_map(|place| [(place, "LE"), (place, "RI")]) {
        codes.push((format!("10{place}{side}RE00ACXP"), 1.0, "g"));
    }
    for k in 0..94 {
        codes.push((format!("1{}HEAD{:02}00H3ACXA", 1 + k % 4, k / 4), 0.5, "g"));
    }
    let newton_per_g = -1500.0 * G / 500.0;
    for k in 0..500 {
        codes.push((format!("B0LOMA{:02}{:02}00FOXP", k / 25, k % 25), newton_per_g, "N"));
    }
    for (k, (code, factor, unit)) in codes.iter().enumerate() {
        let mut text = format!(
            "Test object number          :1\r\nChannel code                :{code}\r\nUnit                        \
             :{unit}\r\n\
             Reference channel           :implicit\r\nSampling interval           :0.0001\r\n\
             Time of first sample        :-0.05\r\nNumber of samples           :2500\r\n"
        );
        for n in 0..2500 {
            write!(text, "{:.6}\r\n", factor * half_sine(f64::from(n - 500) * 1e-4)).unwrap();
        }
        fs::write(top.join(format!("Channel/T600.{:03}", k + 1)), text).unwrap();
    }
    top
}

/// A zip archive of a folder with folders in it, written into another.
pub fn zipped(test: &Path, into: &Path) -> PathBuf {
    let archive = into.join(test.file_name().unwrap()).with_extension("zip");
    let mut zip = zip::ZipWriter::new(File::create(&archive).unwrap());
    let mut folders = vec![test.to_owned()];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(test.parent().unwrap()).unwrap().to_str().unwrap();
            zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
            zip.write_all(&fs::read(&path).unwrap()).unwrap();
        }
    }
    zip.finish().unwrap();
    archive
}

#[test]
fn six_hundred_channels_of_an_iso_mme_test_go_through_from_folder_and_zip() {
    let folder = tempfile::tempdir().unwrap();
    let test = iso_mme(folder.path());
    let made = three(folder.path(), &test, &[], &[]);
    let artifact = Artifact::open(&made[0]).unwrap();
    assert_eq!(artifact.waves().len(), 600);
    assert_crush(&made[2]);

    let archive = zipped(&test, folder.path());
    let run = folder.path().join("run");
    let summary = summary_of(&[], &run, &archive, &[]);
    assert_eq!(summary["test"]["channel"], "10SECMLERE00ACXP");
    // CFC 60 rounds the corners of the half sine; its class keeps crush within 1 mm.
    assert!((number(&summary, &["events", "dynamic_crush_m"]) - crush().1).abs() < 1e-3);
    // All 500 cells together: impulse and change of momentum of the pulse agree but for the filter of both.
    let integrated = Artifact::open(&run.join(ARTIFACTS[2])).unwrap();
    let force = &integrated.waves()["barrier/force"].sampled;
    let peak = force.samples().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    assert!((peak / (1500.0 * PEAK_G * G) - 1.0).abs() < 0.01, "{peak}");
}

/// Runs a stage and returns its records, one JSON object a line.
fn notes_of_stage(name: &str, input: &Path, output: &Path, flags: &[&str]) -> Vec<serde_json::Value> {
    let mut command = Command::new(binary(name));
    command.arg(input).arg("-o").arg(output).args(flags).arg("--json");
    let run = command.output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{name} {flags:?}: {}", String::from_utf8_lossy(&run.stderr));
    String::from_utf8(run.stdout).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn record<'a>(records: &'a [serde_json::Value], topic: &str) -> &'a serde_json::Value {
    let found = records.iter().find(|record| record["topic"] == topic);
    &found.unwrap_or_else(|| panic!("no {topic} among {records:#?}"))["data"]
}

#[test]
fn a_made_table_of_two_inputs_and_one_output_gives_its_model() {
    let folder = tempfile::tempdir().unwrap();
    // y[k] = 1.5 y[k-1] - 0.7 y[k-2] + 0.5 p[k-1] - 0.2 q[k-1]: poles 0.75 +- 0.3708i.
    let mut table = "p,q,y\n".to_owned();
    let (mut y1, mut y2, mut before) = (0.3, -0.1, (0.0, 0.0));
    for k in 0..500_i32 {
        let y = 1.5 * y1 - 0.7 * y2 + 0.5 * before.0 - 0.2 * before.1;
        before = (f64::from((k * k * 7 + k * 3) % 11) - 5.0, f64::from((k * k * 5 + k * 2) % 13) - 6.0);
        writeln!(table, "{},{},{y}", before.0, before.1).unwrap();
        (y2, y1) = (y1, y);
    }
    let input = folder.path().join("process.csv");
    fs::write(&input, table).unwrap();
    let ingested = folder.path().join("1-ingest.mcap");
    notes_of_stage("crumple-ingest", &input, &ingested, &["--sample-time=2s", "--allow-missing"]);
    let output = folder.path().join("4-identify.mcap");
    let flags = ["--methods=n4sid,arx,output-error", "--orders=2", "--inputs=p,q", "--outputs=y"];
    let records = notes_of_stage("crumple-identify", &ingested, &output, &flags);
    for id in ["n4sid-2", "arx-2", "output-error-2"] {
        let mode = &record(&records, &format!("/modes/{id}"))["modes"][0];
        let (re, im) = (mode["discrete_re"].as_f64().unwrap(), mode["discrete_im"].as_f64().unwrap().abs());
        // Clean data: rounding times the condition of each method.
        assert!((re - 0.75).abs() < 1e-7 && (im - 0.370_809_924).abs() < 1e-7, "{id}: {mode}");
        assert!(record(&records, &format!("/identification/{id}"))["fit_percent"].as_f64().unwrap() > 99.9999);
    }
    // Without the names of the waveforms there is nothing to take for a crash pulse, and that is said.
    let (code, error) = code_and_error(
        Command::new(binary("crumple-identify"))
            .arg(&ingested)
            .arg("-o")
            .arg(&output)
            .arg("--methods=arx")
            .arg("--force"),
    );
    assert_eq!(code, 3, "{error}");
}

#[test]
fn the_hair_dryer_is_identified_from_its_table() {
    let Some(input) = shared("data/sysid/hair-dryer/dryer.dat") else { return };
    let folder = tempfile::tempdir().unwrap();
    let ingested = folder.path().join("1-ingest.mcap");
    let records = notes_of_stage("crumple-ingest", &input, &ingested, &["--sample-time=0.08s", "--allow-missing"]);
    let channels = record(&records, "/test")["channels"].as_array().unwrap();
    let ids: Vec<&str> = channels.iter().map(|channel| channel["id"].as_str().unwrap()).collect();
    assert_eq!(ids.len(), 2, "{ids:?}");
    let output = folder.path().join("4-identify.mcap");
    let (inputs, outputs) = (format!("--inputs={}", ids[0]), format!("--outputs={}", ids[1]));
    let flags = ["--methods=arx,n4sid,output-error", "--orders=4", &inputs, &outputs];
    let records = notes_of_stage("crumple-identify", &ingested, &output, &flags);
    let fit = record(&records, "/identification/output-error-4")["fit_percent"].as_f64().unwrap();
    // Peers fit 89 to 90 % of the first half with centred signals; the constant level counts as motion here.
    assert!(fit > 80.0, "{fit}");
}
