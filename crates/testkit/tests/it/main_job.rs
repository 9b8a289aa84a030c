//! `just run` on the project's fixtures and on real and reference records.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use crumple_testkit::programs::{ARTIFACTS, binary, number, run, summary_of};
use crumple_testkit::truth::{self, Explained, Extent, Net, cases};
use crumple_testkit::{shared, workspace};

fn fixture(name: &str) -> PathBuf {
    workspace().join("fixtures").join(name).join("crash.csv")
}

fn truth(name: &str) -> serde_json::Value {
    let text = std::fs::read_to_string(workspace().join("fixtures").join(name).join("truth.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn candidate<'a>(summary: &'a serde_json::Value, id: &str) -> &'a serde_json::Value {
    let candidates = summary["candidates"].as_array().unwrap();
    candidates.iter().find(|c| c["id"] == id).unwrap_or_else(|| panic!("no candidate {id} in {candidates:?}"))
}

#[test]
fn a_run_folder_holds_what_the_design_says() {
    let folder = tempfile::tempdir().unwrap();
    let summary = summary_of(&[], folder.path(), &fixture("kelvin"), &[]);
    for name in ARTIFACTS.iter().chain(&["report.html", "summary.json"]) {
        assert!(folder.path().join(name).is_file(), "{name} is missing");
    }
    assert_eq!(summary["schema"], "crumple.summary.v1");
    assert_eq!(summary["pipeline"], "default");
    assert_eq!(number(&summary, &["test", "mass_kg"]), 873.0);
    assert_eq!(number(&summary, &["test", "sample_rate_hz"]), 10_000.0);
    assert_eq!(summary["test"]["channel"], "accel_g");
    for key in ["events", "metrics", "models", "candidates", "best", "recommended", "predictions", "notes"] {
        assert!(!summary[key].is_null(), "{key} is missing");
    }
    for candidate in summary["candidates"].as_array().unwrap() {
        assert!(candidate["simulation"]["fit_percent"].is_number(), "{candidate}");
    }
    let leftovers = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(leftovers, 10, "something else lies in the run folder");
}

/// A true model, compared as the record was measured, is not charged with what the filter does to the jump at contact.
#[test]
fn a_true_model_fits_its_record_as_measured() {
    let folder = tempfile::tempdir().unwrap();
    let summary = summary_of(&[], folder.path(), &fixture("double"), &[]);
    let simulation = &candidate(&summary, "double-spring-mass-damper/direct-fit/1")["simulation"];
    let (measured, plain) = (number(simulation, &["fit_as_measured_percent"]), number(simulation, &["fit_percent"]));
    // CFC 60 moves the displacement by some 1e-5 m at contact, of half a metre.
    assert!(measured > 99.999_99 && plain < 99.999_9, "{measured} as measured, {plain} of the motion itself");
}

/// Unfiltered, the only error is the trapezoidal rule's: dt² max|a'| / 12 times the loading time is below 2e-6 m for
/// pulses of these lengths at 10 kHz.
#[test]
fn the_unfiltered_crush_of_every_fixture_is_the_truth() {
    for name in ["kelvin", "elastoplastic", "double"] {
        let folder = tempfile::tempdir().unwrap();
        let summary = summary_of(&["pipeline=unfiltered"], folder.path(), &fixture(name), &[]);
        let expected = number(&truth(name), &["expected", "dynamic_crush_m"]);
        let found = number(&summary, &["events", "dynamic_crush_m"]);
        assert!((found - expected).abs() < 2e-6, "{name}: {found} against {expected}");
        // Without noise the family that made the record is recommended, which leaves the digits of the file and what
        // the trapezoidal rule does to the jump at contact: 2e-6 m of half a metre.
        let best = candidate(&summary, summary["recommended"].as_str().unwrap());
        let fit = number(&best["simulation"], &["fit_as_measured_percent"]);
        assert!(fit > 99.999, "{name}: {fit}");
    }
}

#[test]
fn the_default_pipeline_finds_the_model_that_made_each_fixture() {
    for (name, model) in [("kelvin", "kelvin"), ("double", "double-spring-mass-damper")] {
        let folder = tempfile::tempdir().unwrap();
        let summary = summary_of(&[], folder.path(), &fixture(name), &[]);
        let best = summary["best"].as_str().unwrap();
        let best = candidate(&summary, best);
        // A double mass contains the single one as a limit, so it may fit a Kelvin record as well; the fit must be near
        // 100 %.
        assert!(number(best, &["simulation", "fit_percent"]) > 99.0, "{name}: {best}");
        let of_model: Vec<_> =
            summary["candidates"].as_array().unwrap().iter().filter(|c| c["model"] == model).collect();
        assert!(!of_model.is_empty(), "{name}: no candidate of {model}");
        assert!(of_model.iter().any(|c| number(c, &["simulation", "fit_percent"]) > 99.0), "{name}: {of_model:?}");
    }
}

#[test]
fn both_duals_of_a_double_mass_are_reported_and_linked() {
    let folder = tempfile::tempdir().unwrap();
    let summary = summary_of(&["pipeline=unfiltered"], folder.path(), &fixture("double"), &[]);
    let first = candidate(&summary, "double-spring-mass-damper/direct-fit/1");
    let second = candidate(&summary, "double-spring-mass-damper/direct-fit/2");
    assert_eq!(second["equivalent_to"], first["id"]);
    let truth = truth("double");
    let sets = [&truth["parameters"], &truth["equivalent_parameters"]];
    for found in [first, second] {
        // The displacement is integrated by the trapezoidal rule, relative error about 1e-6; stiffness and damping of
        // the stiffer spring are some hundred times less certain than the displacement they are fitted to.
        let near = |set: &&serde_json::Value| {
            ["k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m"].iter().all(|name| {
                let (a, b) = (number(found, &["parameters", name]), number(set, &[name]));
                (a - b).abs() < 1e-3 * b.abs()
            })
        };
        assert!(sets.iter().any(near), "{found} is neither of {sets:?}");
    }
    let (a, b) =
        (number(first, &["simulation", "dynamic_crush_m"]), number(second, &["simulation", "dynamic_crush_m"]));
    assert!((a - b).abs() < 1e-9, "duals give the same compartment record: {a} {b}");
}

/// Mass and speed of this record stand in its prose, so they are given by flags.
#[test]
fn the_reference_kelvin_record_comes_back() {
    let Some(record) = shared("reference/known-truth/kelvin-underdamped/accel.csv") else { return };
    let text = std::fs::read_to_string(record.with_file_name("truth.json")).unwrap();
    let truth: serde_json::Value = serde_json::from_str(&text).unwrap();
    let flags = ["--mass", &format!("{} kg", truth["mass_kg"]), "--impact-speed", &format!("{} m/s", truth["v0_m_s"])];

    let folder = tempfile::tempdir().unwrap();
    let summary = summary_of(&["pipeline=unfiltered"], folder.path(), &record, &flags);
    let (found, expected) = (number(&summary, &["events", "dynamic_crush_m"]), number(&truth, &["expected", "C"]));
    assert!((found - expected).abs() < 2e-6, "unfiltered crush {found} against {expected}");

    let folder = tempfile::tempdir().unwrap();
    let summary = summary_of(&[], folder.path(), &record, &flags);
    let kelvin = candidate(&summary, "kelvin/closed-form/1");
    let relative = |name: &str, short: &str| {
        let (found, expected) = (number(kelvin, &["parameters", name]), number(&truth, &["parameters", short]));
        (found / expected - 1.0).abs()
    };
    assert!(relative("stiffness_n_per_m", "k") < 0.005, "{kelvin}");
    assert!(relative("damping_n_s_per_m", "c") < 0.03, "{kelvin}");
}

const CAMRY: &str = "data/nhtsa-v10146-camry-frontal";

fn assert_camry(summary: &serde_json::Value, channel: &str) {
    assert_eq!(number(summary, &["test", "mass_kg"]), 1719.0);
    assert!((number(summary, &["test", "impact_speed_m_per_s"]) - 57.09 / 3.6).abs() < 1e-12);
    assert_eq!(summary["test"]["channel"], channel);
    let crush = number(summary, &["events", "dynamic_crush_m"]);
    assert!((0.730..=0.755).contains(&crush), "channel {channel}: {crush} m");
    let notes: Vec<&str> = summary["notes"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
    assert!(notes.iter().any(|n| n.contains("No valid data after 67ms")), "channel 96's comment: {notes:?}");
}

#[test]
fn a_real_nhtsa_test_goes_all_the_way_from_folder_and_zip() {
    let Some(folder) = shared(CAMRY) else { return };
    let out = tempfile::tempdir().unwrap();
    for channel in ["93", "94", "99", "100"] {
        let run_folder = out.path().join(channel);
        let summary = summary_of(&[], &run_folder, &folder.join("v10146.EV5"), &["--channel", channel]);
        assert_camry(&summary, channel);
    }
    let summary = summary_of(&[], &out.path().join("default"), &folder.join("v10146.EV5"), &[]);
    assert_camry(&summary, "93");
    let report = std::fs::read_to_string(out.path().join("default/report.html")).unwrap();
    assert!(report.to_lowercase().contains("rear seat crossmember"), "the report names the channel taken");

    let archive = out.path().join("v10146.zip");
    zip_folder(&folder, "v10146ascii", &archive);
    let summary = summary_of(&[], &out.path().join("zip"), &archive, &[]);
    assert_camry(&summary, "93");
}

/// Packs the EV5 file and the signal files of a folder under one top folder, as downloads come.
fn zip_folder(folder: &Path, top: &str, archive: &Path) {
    let mut writer = zip::ZipWriter::new(File::create(archive).unwrap());
    let options = zip::write::SimpleFileOptions::default();
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    for path in paths.iter().filter(|p| !p.extension().is_some_and(|e| e == "zip" || e == "md")) {
        let name = path.file_name().unwrap().to_str().unwrap();
        writer.start_file(format!("{top}/{name}"), options).unwrap();
        writer.write_all(&std::fs::read(path).unwrap()).unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn a_channel_that_was_not_installed_is_refused_as_that() {
    let Some(folder) = shared(CAMRY) else { return };
    let out = tempfile::tempdir().unwrap();
    let output = run(&[], out.path(), &folder.join("v10146.EV5"), &["--channel", "45"]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{error}");
    assert!(error.to_lowercase().contains("not installed"), "{error}");
}

#[test]
fn a_python_program_that_writes_json_serves_as_identify() {
    let python = workspace().join(".venv/bin/python");
    assert!(python.exists(), "{} is missing: run scripts/setup.sh test", python.display());
    let script = workspace().join("docs/examples/identify.py");
    let folder = tempfile::tempdir().unwrap();
    let variable = format!("identify='{}' '{}'", python.display(), script.display());
    let summary = summary_of(&[&variable], folder.path(), &workspace().join("fixtures/kelvin/crash.csv"), &[]);
    let models = summary["models"].as_array().unwrap();
    assert_eq!(models.len(), 1, "{models:?}");
    assert_eq!(models[0]["id"], "ar-2");
    // The record is one decaying mode of sqrt(330000/873) = 19.442 rad/s; the coarse AR fit through the filter's
    // smeared contact finds it to a few percent.
    let found = models[0]["modes"][0]["natural_frequency_rad_per_s"].as_f64().unwrap();
    assert!((found / 19.442 - 1.0).abs() < 0.1, "{found}");
    assert!(!summary["candidates"].as_array().unwrap().is_empty(), "the stages after it went on");
}

#[test]
fn nothing_that_a_run_says_contradicts_the_truth() {
    let folder = tempfile::tempdir().unwrap();
    let bin = binary("crumple-run").parent().unwrap().to_owned();
    let cases = cases(Extent::Short, folder.path()).unwrap();
    let mut net = Net::new(Explained::by(&bin).unwrap());
    let runs = truth::run_all(&cases.iter().collect::<Vec<_>>(), &bin, folder.path());
    runs.into_iter().for_each(|made| net.read(&made.unwrap()));
    assert!(net.holds(), "{}", net.table());
}
