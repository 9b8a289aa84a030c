//! A run made from closed forms, as artifacts: what the report's tests and its example look at.

#![allow(clippy::unwrap_used, reason = "test data: a failure here is the test's failure")]

mod candidates;
mod crash;
mod kelvin;
mod models;

use std::path::{Path, PathBuf};

use crumple_artifact::records::{
    NotesV1, RatedCandidateV1, RecommendationV1, SimulationV1, TestV1, TransferFunctionV1,
};
use crumple_artifact::{ArtifactBuilder, Compression, InputDigest, Provenance};
use crumple_signal::QuantityKind;

use candidates::sketches;
use crash::{channel_filter, events, metrics, test};
use kelvin::{AFTER, TEST, record_wave, wave};
use models::{identification, modes, response, stabilization};

/// A title that would break a careless page.
pub const TITLE: &str = "Frontal <b>impact</b> & \"pole\" </script><script>window.broken = true</script>";

/// One artifact on its way to a file.
struct Stage {
    name: &'static str,
    file: &'static str,
    builder: ArtifactBuilder,
}

impl Stage {
    fn new(name: &'static str, file: &'static str, notes: &[&str]) -> Self {
        let mut builder = ArtifactBuilder::new();
        builder.put("/test", &TestV1::from(&test())).unwrap();
        if !notes.is_empty() {
            let notes = notes.iter().map(|&text| text.to_owned()).collect();
            builder.put("/notes", &NotesV1 { stage: name.to_owned(), notes }).unwrap();
        }
        Self { name, file, builder }
    }

    fn write(self, folder: &Path) -> PathBuf {
        let path = folder.join(self.file);
        let inputs = vec![InputDigest { kind: "csv".to_owned(), digest: "blake3:0123456789abcdef0123".to_owned() }];
        let provenance = Provenance::new(self.name, "0.1.0", r#"{"cfc":60,"mode":"iso6487"}"#.to_owned(), inputs);
        self.builder.write(&path, &provenance, Compression::None).unwrap();
        path
    }
}

/// Writes the six artifacts of the run into `folder`, in the order of the pipeline.
///
/// `simulated: false` leaves every candidate without a response.
pub fn write_artifacts(folder: &Path, simulated: bool) -> Vec<PathBuf> {
    write_with_longer_crush(folder, simulated, 0.0)
}

/// The same with events that state a crush longer by `more_m`.
pub fn write_with_longer_crush(folder: &Path, simulated: bool, more_m: f64) -> Vec<PathBuf> {
    let mut paths = Vec::new();
    // Swells and fades away, so that it moves the pulse neither way: a filter without phase takes all of it out.
    let swell = |t: f64| if (0.0..0.1).contains(&t) { (10.0 * std::f64::consts::PI * t).sin().powi(2) } else { 0.0 };
    let ripple = |t: f64| 22.0 * (1_900.0 * t).sin() * swell(t);

    let mut ingest = Stage::new(
        "ingest",
        "1-ingest.mcap",
        &["31 channels are listed", "warning: the zero level is -0.02 g; it is reported, not removed"],
    );
    ingest.builder.wave("accel", QuantityKind::Acceleration, record_wave(|t| TEST.at(t)[2] + ripple(t))).unwrap();
    paths.push(ingest.write(folder));

    let mut filter = Stage::new("filter", "2-filter.mcap", &[]);
    filter.builder.wave("accel", QuantityKind::Acceleration, record_wave(|t| TEST.at(t)[2])).unwrap();
    filter.builder.put("/filter/accel", &channel_filter()).unwrap();
    paths.push(filter.write(folder));

    let mut integrate =
        Stage::new("integrate", "3-integrate.mcap", &["dynamic crush from CFC 60 and CFC 180 agrees within 0.1 mm"]);
    for (what, quantity, index) in
        [("velocity", QuantityKind::Velocity, 1), ("displacement", QuantityKind::Displacement, 0)]
    {
        integrate.builder.wave(&format!("accel/{what}"), quantity, record_wave(|t| TEST.at(t)[index])).unwrap();
    }
    let force = record_wave(|t| -TEST.mass_kg * TEST.at(t)[2]);
    integrate.builder.wave("accel/force", QuantityKind::Force, force).unwrap();
    let mut events = events();
    events.dynamic_crush_m = events.dynamic_crush_m.map(|crush| crush + more_m);
    integrate.builder.put("/events", &events).unwrap();
    integrate.builder.put("/metrics", &metrics()).unwrap();
    paths.push(integrate.write(folder));

    let mut identify = Stage::new("identify", "4-identify.mcap", &["warning: order 3 has an unstable pole"]);
    let (sigma, omega) = TEST.poles();
    for (id, order, far) in [("era-2", 2, None), ("era-3", 3, Some(31.0))] {
        identify.builder.put(&format!("/identification/{id}"), &identification(order)).unwrap();
        identify.builder.put(&format!("/modes/{id}"), &modes(sigma, omega, far)).unwrap();
    }
    let tf = TransferFunctionV1 {
        numerator: vec![-27.8, -3_675.0],
        denominator: vec![1.0, 2.0 * sigma, sigma * sigma + omega * omega],
        input: "impulse".to_owned(),
        output: "acceleration".to_owned(),
        delay_s: None,
    };
    identify.builder.put("/model/era-2/transfer-function", &tf).unwrap();
    identify.builder.put("/response/era-2", &response()).unwrap();
    identify.builder.put("/stabilisation/era", &stabilization()).unwrap();
    paths.push(identify.write(folder));

    let mut solve = Stage::new("parameter-solve", "5-parameter-solve.mcap", &[]);
    let mut simulate =
        Stage::new("simulate", "6-simulate.mcap", &["warning: maxwell/closed-form/1 could not be simulated"]);
    let t_m = TEST.time_of_crush();
    for sketch in sketches() {
        solve.builder.put(&format!("/parameters/{}", sketch.id), &sketch.candidate()).unwrap();
        let Some(response) = sketch.response.filter(|_| simulated) else { continue };
        let crush_time = response.time_of_crush();
        let simulation = SimulationV1 {
            dynamic_crush_m: Some(response.at(crush_time)[0]),
            time_of_dynamic_crush_s: Some(crush_time),
            rmse_displacement_m: Some(0.45 * (1.0 - sketch.fit_percent / 100.0)),
            fit_percent: Some(sketch.fit_percent),
            dynamic_crush_error_m: Some(response.at(crush_time)[0] - TEST.at(t_m)[0]),
            time_of_dynamic_crush_error_s: Some(crush_time - t_m),
            to_s: t_m,
            ..SimulationV1::default()
        };
        simulate.builder.put(&format!("/simulation/{}", sketch.id), &simulation).unwrap();
        for (what, quantity, index) in [
            ("displacement", QuantityKind::Displacement, 0),
            ("velocity", QuantityKind::Velocity, 1),
            ("acceleration", QuantityKind::Acceleration, 2),
        ] {
            let id = format!("{}/{what}", sketch.id);
            simulate.builder.wave(&id, quantity, wave(0, AFTER, |t| response.at(t)[index])).unwrap();
        }
    }
    if simulated {
        solve.builder.put("/recommendation", &recommendation()).unwrap();
    }
    paths.push(solve.write(folder));
    paths.push(simulate.write(folder));
    paths
}

/// The double model before the Kelvin model with a negative damper, which fits better.
fn recommendation() -> RecommendationV1 {
    let rated = |id: &str, adequate: bool, difference: f64| RatedCandidateV1 {
        id: id.to_owned(),
        class: "damped".to_owned(),
        adequate,
        parameters: 4,
        determined: 4,
        aicc: Some(100.0 + difference),
        aicc_difference: Some(difference),
        difference_with_priors: Some(difference),
        ..RatedCandidateV1::default()
    };
    let double = "double-spring-mass-damper/displacement-fit/1";
    RecommendationV1 {
        recommended: Some(double.to_owned()),
        recommended_because: "the lowest criterion of the adequate".to_owned(),
        simplest_because: "none has all numbers determined".to_owned(),
        closest: Some("kelvin/coefficient-matching/1".to_owned()),
        closest_because: "the lowest misfit".to_owned(),
        candidates: vec![rated(double, true, 0.0), rated("kelvin/coefficient-matching/1", false, 3.0)],
        ..RecommendationV1::default()
    }
}
