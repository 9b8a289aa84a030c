//! The program on artifacts: what it reads, what it writes, what it refuses.

use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_artifact::records::{DiagnosisV1, EventsV1, MetricV1, MetricsV2, NotesV1, TestV1};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};
use crumple_signal::{
    Axis, Channel, Contact, Distribution, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G, Sampled, Spread,
    TestDescription,
};
use crumple_testkit::write_filtered;

use crate::{PROGRAM, events, result, run};

/// A test with one channel of constant deceleration 200 m/s² from time zero, 50 ms at rest before it.
fn constant(impact_speed_m_per_s: Option<f64>, mass_kg: Option<f64>, cfc: Option<u16>) -> TestDescription {
    TestDescription {
        title: "constant".to_owned(),
        mass_kg,
        impact_speed_m_per_s,
        channels: vec![Channel { cfc, ..Channel::new("a", QuantityKind::Acceleration) }],
        ..TestDescription::default()
    }
}

/// Writes what the filter stage would have written.
fn filtered(folder: &Path, test: &TestDescription) -> PathBuf {
    let samples = (0..2000).map(|k| if k < 500 { 0.0 } else { -200.0 }).collect();
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &TestV1::from(test)).unwrap();
    builder.wave("a", test.channels[0].quantity, Sampled::new(-0.05, 1e-4, samples).unwrap()).unwrap();
    let path = folder.join("2-filter.mcap");
    builder.write(&path, &Provenance::new("filter", "0", "{}".to_owned(), vec![]), Compression::None).unwrap();
    path
}

#[test]
fn writes_motion_events_and_metrics_of_the_pulse() {
    let folder = tempfile::tempdir().unwrap();
    let artifact = result(&filtered(folder.path(), &constant(Some(20.0), Some(900.0), None)), &[]);
    assert_eq!(artifact.waves().keys().collect::<Vec<_>>(), ["a/displacement", "a/force", "a/velocity"]);
    let velocity = &artifact.waves()["a/velocity"];
    assert_eq!(
        (velocity.quantity, velocity.sampled.t0_s(), velocity.sampled.len()),
        (QuantityKind::Velocity, 0.0, 1500)
    );

    let events = events(&artifact);
    // x = v0²/2a = 1 m at v0/a = 100 ms; the trapezoid is exact for a constant, the rest is rounding.
    assert!((events.dynamic_crush_m.unwrap() - 1.0).abs() < 1e-12);
    assert!((events.time_of_dynamic_crush_s.unwrap() - 0.1).abs() < 1e-12);
    assert!((events.centroid_time_s.unwrap() - 0.05).abs() < 1e-12);
    assert_eq!((events.rule.as_deref(), events.start.as_deref()), (Some("trapezoid"), Some("time-zero")));
    assert_eq!((events.time_zero_s, events.time_zero_rule.as_str(), events.channel.as_str()), (0.0, "file", "a"));
    assert_eq!(artifact.waves()["a/force"].sampled.samples()[7], 180_000.0);
    let metrics: MetricsV2 = artifact.record("/metrics").unwrap().unwrap();
    let stiffness = metrics.metrics.iter().find(|metric| metric.name == "average_stiffness").unwrap();
    assert!((stiffness.value.unwrap() / 360_000.0 - 1.0).abs() < 1e-12);
    assert_eq!((stiffness.unit.as_str(), stiffness.channel.as_str()), ("N/m", "a"));
}

#[test]
fn a_filtered_channel_is_integrated_from_the_start_of_the_record() {
    let folder = tempfile::tempdir().unwrap();
    let artifact = result(&filtered(folder.path(), &constant(Some(20.0), None, Some(60))), &[]);
    assert_eq!(events(&artifact).start.as_deref(), Some("record-start"));
    let displacement = &artifact.waves()["a/displacement"].sampled;
    assert_eq!((displacement.t0_s(), displacement.len()), (-0.05, 2000));
    assert_eq!(displacement.samples()[500], 0.0);
    assert!(!artifact.waves().contains_key("a/force"));
}

#[test]
fn a_velocity_that_never_reaches_zero_is_a_result_with_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let artifact = result(&filtered(folder.path(), &constant(Some(40.0), Some(900.0), None)), &[]);
    let events = events(&artifact);
    assert_eq!((events.dynamic_crush_m, events.rebound_velocity_m_per_s), (None, None));
    // 40 m/s less what is left; rounding of 1500 sums.
    assert!((events.delta_v_m_per_s.unwrap() - 29.98).abs() < 1e-9, "{events:?}");
    assert_eq!(events.end_of_event_rule.as_deref(), Some("end of the record"));
    let notes: NotesV1 = artifact.record("/notes").unwrap().unwrap();
    // The speed is not doubted: what the record does not show may stop it.
    assert_eq!(
        notes.notes[..],
        ["warning: the velocity never reaches zero: dynamic crush and rebound are not in the record. It is lowest, \
          36.1 km/h, at 149.9 ms: delta-v 107.9 km/h, a lower bound, for it still changes there"]
    );
}

#[test]
fn a_missing_impact_speed_leaves_the_pulse_and_a_flag_gives_it() {
    let folder = tempfile::tempdir().unwrap();
    let input = filtered(folder.path(), &constant(None, None, None));
    let output = run(&input, &[]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("change of velocity 29.980 m/s"), "{stderr}");
    assert!(stderr.contains("no impact speed") && stderr.contains("--impact-speed 35km/h"), "{stderr}");
    assert_eq!(run(&input, &["--impact-speed", "20"]).status.code(), Some(2));

    let artifact = result(&input, &["--impact-speed", "72km/h"]);
    assert_eq!(events(&artifact).impact_speed_m_per_s, Some(20.0));
    // Later stages work with the same speed.
    assert_eq!(artifact.record::<TestV1>("/test").unwrap().unwrap().impact_speed_m_per_s, Some(20.0));
}

#[test]
fn a_time_zero_is_for_ingest_and_one_that_was_moved_here_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let input = filtered(folder.path(), &constant(Some(20.0), None, None));
    for flags in [["--time-zero", "0s"], ["--time-zero-rule", "edr"], ["--time-zero-uncertainty", "1 ms"]] {
        let output = run(&input, &flags);
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains("give it to ingest"), "{output:?}");
    }
    // What the test says of contact is what the events say.
    let mut test = constant(Some(20.0), None, None);
    test.contact =
        Some(Contact { rule: "auto".to_owned(), source_time_s: 0.7, uncertainty_s: None, earlier_by_s: 0.0 });
    let events = events(&result(&filtered(folder.path(), &test), &[]));
    assert_eq!((events.time_zero_s, events.time_zero_rule.as_str()), (0.0, "auto"));
}

#[test]
fn refuses_a_channel_that_is_not_there_or_no_acceleration() {
    let folder = tempfile::tempdir().unwrap();
    let input = filtered(folder.path(), &constant(Some(20.0), None, None));
    let output = run(&input, &["--channel", "b"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("the test has no channel \"b\""));
    let mut force = constant(Some(20.0), None, None);
    force.channels[0].quantity = QuantityKind::Force;
    let input = filtered(folder.path(), &force);
    let output = run(&input, &["--channel", "a"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("channel a is no accelerometer"));
}

#[test]
fn stated_uncertainties_give_intervals_and_none_gives_none() {
    let folder = tempfile::tempdir().unwrap();
    let uncertainty_s = Some(Spread { size: 5e-4, distribution: Distribution::Normal });
    let contact = Contact { rule: "auto".to_owned(), source_time_s: 0.0, uncertainty_s, earlier_by_s: 0.004 };
    let test = TestDescription { contact: Some(contact), ..constant(Some(20.0), Some(900.0), Some(60)) };
    let input = filtered(folder.path(), &test);
    let flags = ["--speed-uncertainty", "0.36km/h uniform", "--gain-uncertainty", "1%"];
    let artifact = result(&input, &flags);
    let crush = events(&artifact);
    let interval = crush.intervals.iter().find(|interval| interval.name == "dynamic_crush_m").unwrap();
    let value = crush.dynamic_crush_m.unwrap();
    assert!(interval.low < value && value < interval.high, "{interval:?} {value}");
    assert_eq!(interval.interval_by, "5-95 % of 128 replicates");
    let metrics: MetricsV2 = artifact.record("/metrics").unwrap().unwrap();
    let olc = metrics.metrics.iter().find(|metric| metric.name == "olc").unwrap();
    assert_eq!(olc.definition_id.as_deref(), Some("olc-tb027"));
    assert!(olc.low < olc.value && olc.value < olc.high && olc.from_s < olc.to_s, "{olc:?}");
    let notes: NotesV1 = artifact.record("/notes").unwrap().unwrap();
    assert!(
        notes.notes.iter().any(|note| note.starts_with(
            "intervals are 5-95 % of 128 replicates (seed 1) with impact speed +-0.36 km/h (uniform), gain 1 % \
             (standard deviation, normal), contact 0.5 ms (standard deviation, normal), contact up to 4 ms earlier \
             for a soft front. An error of contact moves"
        )),
        "{:?}",
        notes.notes
    );

    let without = result(&input, &[&flags[..], &["--uncertainty-replicates", "0"]].concat());
    assert_eq!(events(&without).intervals, []);
    for wrong in [
        ["--speed-uncertainty", "0.1"],
        ["--gain-uncertainty", "1 km/h"],
        ["--zero-level-uncertainty", "0.1g triangular"],
        ["--uncertainty-replicates", "5"],
    ] {
        assert_eq!(run(&input, &wrong).status.code(), Some(2), "{wrong:?}");
    }
}

#[test]
fn the_bytes_do_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let input = filtered(folder.path(), &constant(Some(20.0), Some(900.0), Some(60)));
    let written = |threads: &str| {
        let output = input.with_file_name(format!("{threads}.mcap"));
        let status = Command::new(env!("CARGO_BIN_EXE_crumple-integrate"))
            .arg(&input)
            .args(["--speed-uncertainty", "0.1m/s", "--zero-level-uncertainty", "0.05g"])
            .arg("-o")
            .arg(&output)
            .env("RAYON_NUM_THREADS", threads)
            .status()
            .unwrap();
        assert!(status.success());
        std::fs::read(output).unwrap()
    };
    assert_eq!(written("1"), written("3"));
}

#[test]
fn the_pulse_may_be_named_by_code_or_pattern() {
    let folder = tempfile::tempdir().unwrap();
    let mut test = constant(Some(20.0), None, None);
    test.channels[0].code = Some("10VEHCCG0000ACXP".to_owned());
    let input = filtered(folder.path(), &test);
    for name in ["a", "10VEHCCG0000ACXP", "1?VEHC*X?"] {
        assert_eq!(events(&result(&input, &["--channel", name])).channel, "a", "{name}");
    }
    assert_eq!(run(&input, &["--channel", "1?ENGN*"]).status.code(), Some(3));
}

#[test]
fn without_an_impact_speed_the_metrics_that_need_none_are_those_with_one() {
    let folder = tempfile::tempdir().unwrap();
    let with = result(&filtered(folder.path(), &constant(Some(20.0), Some(900.0), None)), &[]);
    let without = result(&filtered(folder.path(), &constant(None, Some(900.0), None)), &[]);
    let metrics = |artifact: &Artifact| artifact.record::<MetricsV2>("/metrics").unwrap().unwrap().metrics;
    let (with, without_speed) = (metrics(&with), metrics(&without));
    assert_eq!(with.len(), without_speed.len());
    let value = |metrics: &[MetricV1], name: &str| metrics.iter().find(|metric| metric.name == name).unwrap().value;
    for name in ["peak_acceleration", "time_of_peak_acceleration", "sm25", "olc", "vpi"] {
        let (a, b) = (value(&with, name).unwrap(), value(&without_speed, name).unwrap());
        // The sums start at 20 and at 0: rounding.
        assert!((a - b).abs() <= 1e-9 * a.abs(), "{name}: {a} {b}");
    }
    // 150 ms at 200 m/s² take 30 m/s off, whatever the speed was.
    assert!((value(&without_speed, "delta_v").unwrap() - 0.1499 * 200.0).abs() < 1e-9);
    for name in ["dynamic_crush", "coefficient_of_restitution", "impact_energy", "average_stiffness"] {
        let metric = without_speed.iter().find(|metric| metric.name == name).unwrap();
        assert_eq!(metric.value, None, "{name}");
        assert!(metric.definition.contains("the impact speed is not stated"), "{}", metric.definition);
    }
    assert_eq!(without.waves().keys().collect::<Vec<_>>(), ["a/velocity_change"]);
    assert!(without.record::<EventsV1>("/events").unwrap().is_none());
}

#[test]
fn a_speed_that_does_not_fit_the_pulse_is_questioned_before_anything_else() {
    let folder = tempfile::tempdir().unwrap();
    // 30 m/s are taken off: at 15 m/s the vehicle would leave the wall as fast as it came.
    for (speed, words) in [(15.0, "rebound at 100 % of it"), (18.0, "rebound at 67 % of it")] {
        let artifact = result(&filtered(folder.path(), &constant(Some(speed), Some(900.0), None)), &[]);
        let notes: NotesV1 = artifact.record("/notes").unwrap().unwrap();
        assert!(notes.notes[0].starts_with("warning: check the impact speed"), "{:?}", notes.notes);
        assert!(notes.notes[0].contains(words) && notes.notes[0].contains("94 km/h would fit"), "{:?}", notes.notes);
        // Not where the reader of the record has asked for an exchange, unless the speed is another one.
        let asked = TestDescription { exchange_asked: true, ..constant(Some(speed), Some(900.0), None) };
        for (flags, is_questioned) in [(&[][..], false), (&["--impact-speed", "14m/s"][..], true)] {
            let notes: NotesV1 = result(&filtered(folder.path(), &asked), flags).record("/notes").unwrap().unwrap();
            let first = &notes.notes[0];
            assert_eq!(first.starts_with("warning: check the impact speed"), is_questioned, "{:?}", notes.notes);
        }
    }
}

fn accelerometer(id: &str, axis: Axis, cfc: u16) -> Channel {
    Channel { axis: Some(axis), cfc: Some(cfc), ..Channel::new(id, QuantityKind::Acceleration) }
}

/// Half sine of `peak` over `length_s` from `from_s` on, 50 ms at rest before time zero; ends at `end_s`.
fn half_sine(peak: f64, from_s: f64, length_s: f64, end_s: f64) -> Sampled {
    let at = |t: f64| {
        let share = (t - from_s) / length_s;
        if (0.0..=1.0).contains(&share) { peak * (std::f64::consts::PI * share).sin() } else { 0.0 }
    };
    let samples = ((0.05 + end_s) * 1e4).round() as i32;
    Sampled::new(-0.05, 1e-4, (0..=samples).map(|k| at(f64::from(k) * 1e-4 - 0.05)).collect()).unwrap()
}

/// Written as the filter would have, without a mass.
fn filtered_channels(
    folder: &Path,
    channels: &[(Channel, Option<Sampled>)],
    impact_speed_m_per_s: Option<f64>,
) -> PathBuf {
    let test = TestDescription { title: "unusual".to_owned(), impact_speed_m_per_s, ..TestDescription::default() };
    write_filtered(folder, test, channels).unwrap()
}

fn metrics(artifact: &Artifact) -> Vec<MetricV1> {
    artifact.record::<MetricsV2>("/metrics").unwrap().map(|record| record.metrics).unwrap_or_default()
}

fn find(metrics: &[MetricV1], channel: &str, name: &str) -> MetricV1 {
    let found = metrics.iter().find(|metric| metric.channel == channel && metric.name == name);
    found.unwrap_or_else(|| panic!("no {name} of {channel}")).clone()
}

fn notes(artifact: &Artifact) -> String {
    artifact.record::<NotesV1>("/notes").unwrap().map(|notes| notes.notes.join("\n")).unwrap_or_default()
}

#[test]
fn a_vehicle_that_does_not_stop_has_its_delta_v_and_the_end_of_its_event() {
    let folder = tempfile::tempdir().unwrap();
    // 2·A·D/π = 10.19 m/s of 15 m/s.
    let (peak, length_s) = (160.0, 0.1);
    let change = 2.0 * peak * length_s / std::f64::consts::PI;
    let pulse = half_sine(-peak, 0.0, length_s, 0.3);
    let input = filtered_channels(folder.path(), &[(accelerometer("p", Axis::X, 60), Some(pulse))], Some(15.0));
    let artifact = result(&input, &["--gain-uncertainty", "1% uniform"]);
    let found = events(&artifact);
    assert_eq!((found.dynamic_crush_m, found.time_of_rebound_s), (None, None));
    // The trapezoid of a half sine errs by (πT/D)²/12: 8e-7 of it.
    assert!((found.delta_v_m_per_s.unwrap() / change - 1.0).abs() < 1e-6, "{found:?}");
    // Of the samples of a sum that ends flat the lowest may be a few before the end.
    assert!((found.time_of_delta_v_s.unwrap() - length_s).abs() < 1e-3, "{found:?}");
    // The 20 ms with 0.2222 m/s begin at t with (1 + cos(πt/D))·A·D/π = 0.2222.
    let quiet = length_s / std::f64::consts::PI * ((0.8 / 3.6) * std::f64::consts::PI / (peak * length_s) - 1.0).acos();
    assert!((found.end_of_event_s.unwrap() - quiet - 0.02).abs() < 1.1e-4, "{found:?} {quiet}");
    assert_eq!(found.end_of_event_rule.as_deref(), Some("20 ms with no more than 0.8 km/h (49 CFR 563)"));
    // A percent of gain is a percent of the change.
    let interval = found.intervals.iter().find(|interval| interval.name == "delta_v_m_per_s").unwrap();
    assert!((interval.high / change - 1.009).abs() < 5e-4, "{interval:?}");
    let metric = find(&metrics(&artifact), "p", "delta_v");
    assert!(metric.definition.contains("never reaches zero, the event ends at"), "{}", metric.definition);
    assert!(
        // 10.186 m/s of 15.
        notes(&artifact).contains("not in the record. It is lowest, 17.3 km/h, at 100.0 ms: delta-v 36.7 km/h\n"),
        "{}",
        notes(&artifact)
    );

    let cut = half_sine(-peak, 0.0, length_s, 0.06);
    let input = filtered_channels(folder.path(), &[(accelerometer("p", Axis::X, 60), Some(cut))], Some(15.0));
    let artifact = result(&input, &["--force"]);
    assert_eq!(events(&artifact).end_of_event_rule.as_deref(), Some("end of the record"));
    assert!(notes(&artifact).contains("a lower bound, for it still changes there"), "{}", notes(&artifact));
}

#[test]
fn an_interval_that_cannot_be_says_why() {
    let folder = tempfile::tempdir().unwrap();
    // The record ends in the pulse, after 14.45 of 15.28 m/s: at 14.3 m/s some replicates do not stop in it.
    let pulse = half_sine(-240.0, 0.0, 0.1, 0.085);
    let input = filtered_channels(folder.path(), &[(accelerometer("p", Axis::X, 60), Some(pulse))], Some(14.3));
    let artifact = result(&input, &["--speed-uncertainty", "0.3 m/s uniform"]);
    let found = events(&artifact);
    assert!(
        found.dynamic_crush_m.is_some() && found.intervals.iter().all(|i| i.name != "dynamic_crush_m"),
        "{found:?}"
    );
    let without = found.without_interval.iter().find(|without| without.name == "dynamic_crush_m").unwrap();
    let said = "of 128 replicates with perturbed inputs do not have it";
    assert!(without.reason.starts_with("no interval: ") && without.reason.ends_with(said), "{without:?}");
    let metric = find(&metrics(&artifact), "p", "dynamic_crush");
    assert_eq!((metric.low, metric.interval_by.as_deref()), (None, Some(without.reason.as_str())));
    assert_eq!(find(&metrics(&artifact), "p", "energy_closure").interval_by, None);
    // The peak is in all of them.
    assert!(find(&metrics(&artifact), "p", "peak_acceleration").low.is_some());
}

#[test]
fn a_recorder_without_a_speed_has_its_maximum_delta_v() {
    let folder = tempfile::tempdir().unwrap();
    let km_per_h = [0, -4, -11, -20, -31, -40, -46, -49, -50, -50, -49, -49];
    let change = Sampled::new(0.0, 0.01, km_per_h.iter().map(|v| f64::from(*v) / 3.6).collect()).unwrap();
    let acceleration = Sampled::new(0.0, 0.01, vec![-100.0; 12]).unwrap();
    let lateral = Sampled::new(0.0, 0.01, vec![0.0, 1.0, 2.0]).unwrap();
    let channels = [
        (accelerometer("dv_derivative", Axis::X, 60), Some(acceleration)),
        (Channel::new("across", QuantityKind::VelocityChange), Some(lateral)),
        (Channel::new("dv", QuantityKind::VelocityChange), Some(change)),
    ];
    let input = filtered_channels(folder.path(), &channels, None);
    for _ in 0..2 {
        assert_eq!(PROGRAM.run(&input, &[]).status.code(), Some(0));
    }
    let artifact = result(&input, &[]);
    let found = find(&metrics(&artifact), "dv", "maximum_delta_v");
    // 50 km/h; rounding of the division only.
    assert!((found.value.unwrap() + 50.0 / 3.6).abs() < 1e-12, "{found:?}");
    assert!((find(&metrics(&artifact), "dv", "time_of_maximum_delta_v").value.unwrap() - 0.08).abs() < 1e-12);
    assert_eq!(metrics(&artifact)[0].channel, "dv", "what the pulse is made of comes first");
    let diagnosis: DiagnosisV1 = artifact.record("/diagnosis").unwrap().unwrap();
    assert!(diagnosis.has_result && diagnosis.reason.contains("no impact speed"), "{diagnosis:?}");
    // With one it is there beside the motion.
    let input = filtered_channels(folder.path(), &channels, Some(20.0));
    let artifact = result(&input, &["--force"]);
    assert!(events(&artifact).delta_v_m_per_s.is_some());
    find(&metrics(&artifact), "dv", "maximum_delta_v");
}

#[test]
fn a_vehicle_without_a_speed_has_its_change_of_velocity_beside_what_its_dummies_measured() {
    let folder = tempfile::tempdir().unwrap();
    let channels = [
        (accelerometer("p", Axis::X, 60), Some(half_sine(-200.0, 0.0, 0.1, 0.2))),
        (accelerometer("head_x_g", Axis::X, 1000), Some(half_sine(-60.0 * G, 0.03, 0.05, 0.2))),
    ];
    let input = filtered_channels(folder.path(), &channels, None);
    let artifact = result(&input, &[]);
    assert!(find(&metrics(&artifact), "head_x_g", "hic15").value.is_some());
    assert!(find(&metrics(&artifact), "p", "delta_v").value.is_some());
    let diagnosis: DiagnosisV1 = artifact.record("/diagnosis").unwrap().unwrap();
    assert!(diagnosis.has_result && diagnosis.reason.contains("no impact speed"), "{diagnosis:?}");
}

#[test]
fn columns_of_one_head_are_one_resultant_and_no_twin_of_the_vehicle() {
    let folder = tempfile::tempdir().unwrap();
    let mut channels = vec![(accelerometer("sill_x_g", Axis::X, 60), Some(half_sine(-250.0, 0.0, 0.1, 0.2)))];
    for (id, axis, peak) in [("head_x_g", Axis::X, 20.0), ("head_y_g", Axis::Y, 30.0), ("head_z_g", Axis::Z, 60.0)] {
        channels.push((accelerometer(id, axis, 1000), Some(half_sine(-peak * G, 0.03, 0.06, 0.2))));
    }
    let input = filtered_channels(folder.path(), &channels, Some(14.0));
    let artifact = result(&input, &["--channels", "all"]);
    let hic = find(&metrics(&artifact), "head_x_g+head_y_g+head_z_g", "hic15");
    // A half sine of 70 g: sqrt(400 + 900 + 3600). 15 ms about its peak of 60 ms are less than 70^2.5 times the window
    // by 5 %.
    let flat = 70.0_f64.powf(2.5) * 0.015;
    assert!((0.9..1.0).contains(&(hic.value.unwrap() / flat)), "{hic:?} {flat}");
    assert!(!hic.definition.contains("lower bound"), "{}", hic.definition);
    assert!(!artifact.waves().contains_key("head_x_g/displacement"));
    assert!(!metrics(&artifact).iter().any(|metric| metric.channel.contains("sill_x_g+")), "no spread with a head");
}

#[test]
fn a_filter_that_left_the_pulse_out_leaves_the_criteria() {
    let folder = tempfile::tempdir().unwrap();
    let head = (accelerometer("head_x_g", Axis::X, 1000), Some(half_sine(-60.0 * G, 0.03, 0.05, 0.2)));
    let input = filtered_channels(folder.path(), &[(accelerometer("p", Axis::X, 60), None), head], Some(14.0));
    let artifact = result(&input, &[]);
    assert!(find(&metrics(&artifact), "head_x_g", "hic15").value.is_some());
    let diagnosis: DiagnosisV1 = artifact.record("/diagnosis").unwrap().unwrap();
    assert!(diagnosis.reason.contains("the pulse p is not in the inputs"), "{diagnosis:?}");

    // Another part of the vehicle has no criteria: the program is named that left the pulse out.
    let engine = (accelerometer("engine", Axis::X, 60), Some(half_sine(-300.0, 0.0, 0.05, 0.2)));
    let input = filtered_channels(folder.path(), &[(accelerometer("p", Axis::X, 60), None), engine], Some(14.0));
    let output = PROGRAM.run(&input, &[]);
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(
        text.contains("hint: crumple-filter --channels ID leaves out what it does not name: name p there too"),
        "{text}"
    );
}

#[test]
fn a_sensor_of_unknown_place_that_moves_otherwise_is_not_held_against_the_vehicle_unless_named() {
    let folder = tempfile::tempdir().unwrap();
    let channels = [
        (accelerometer("a", Axis::X, 60), Some(half_sine(-250.0, 0.0, 0.1, 0.2))),
        (accelerometer("b", Axis::X, 60), Some(half_sine(-252.0, 0.0, 0.1, 0.2))),
        (accelerometer("c", Axis::X, 60), Some(half_sine(-600.0, 0.03, 0.05, 0.2))),
    ];
    let input = filtered_channels(folder.path(), &channels, Some(14.0));
    let artifact = result(&input, &["--channels", "all"]);
    let motions: Vec<_> =
        ["a", "b", "c"].map(|id| artifact.waves().contains_key(&format!("{id}/displacement"))).to_vec();
    assert_eq!(motions, [true, true, false]);
    assert!(
        notes(&artifact).contains("warning: channel c does not move as the pulse does, and nothing says where it sits")
    );
    find(&metrics(&artifact), "a+b", "dynamic_crush");
    let artifact = result(&input, &["--channels", "all,c", "--force"]);
    assert!(artifact.waves().contains_key("c/displacement"));

    let asked = result(&input, &["--metrics", "head", "--force"]);
    assert!(notes(&asked).contains("nothing says where channels a, b, c sit"), "{}", notes(&asked));
    // What a pipeline names and the record has not: what it has, and the key.
    let output = PROGRAM.run(&input, &["--channels", "all,95"]);
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3));
    for said in ["no channel \"95\"", "channels of [integrate]", "inputs: a, b, c", "sensors of [parameter-solve]"] {
        assert!(text.contains(said), "{said}: {text}");
    }
}
