//! The program on records that are no crashes: any quantities, several inputs and outputs, no mass, speed or pulse.

use std::path::{Path, PathBuf};

use crumple_artifact::Artifact;
use crumple_artifact::records::{EvidenceV1, IdentificationV1, ModesV2, NotesV1, StateSpaceV1, TransferFunctionV1};
use crumple_numerics::lti::{Complex, StateSpace, discretize_first_order_hold, simulate};
use crumple_signal::{Channel, QuantityKind};
use crumple_testkit::uniform;
use nalgebra::DMatrix;

use crate::program::{Wave, identify, made, written};

const DT_S: f64 = 0.02;

/// Poles -0.6 +- 4.0i and -1.5 +- 11.0i.
fn truth() -> StateSpace {
    let a = nalgebra::dmatrix![
        -0.6, 4.0, 0.0, 0.0;
        -4.0, -0.6, 0.0, 0.0;
        0.0, 0.0, -1.5, 11.0;
        0.0, 0.0, -11.0, -1.5
    ];
    let b = DMatrix::from_fn(4, 2, |i, j| 3.0 * (1.0 + 0.3 * i as f64 - 0.9 * j as f64));
    let c = DMatrix::from_fn(2, 4, |i, j| 1.0 - 0.4 * j as f64 + 0.7 * i as f64);
    StateSpace::new(a, b, c, DMatrix::zeros(2, 2), None).unwrap()
}

/// Inputs `heater` and `fan`, outputs `inside` and `outside`: voltages and numbers without a unit.
fn artifact(folder: &Path) -> PathBuf {
    let sampled = discretize_first_order_hold(&truth(), DT_S).unwrap().state_space().unwrap();
    let random = |j: u32, k: u32| uniform(u64::from(k / 3 + 1000 * j));
    let u: Vec<Vec<f64>> =
        (0..2).map(|j| (0..600).map(|k| if k == 0 { 0.0 } else { random(j, k) }).collect()).collect();
    let y = simulate(&sampled, &u, &[0.3, -0.2, 0.1, 0.4]).unwrap();
    let ids = ["heater", "fan", "inside", "outside"];
    let channels = ids.iter().map(|id| Channel::new(*id, QuantityKind::Voltage)).collect();
    let samples = u.into_iter().chain(y);
    let waves: Vec<Wave> = ids.into_iter().zip(samples).map(|(id, x)| (id, QuantityKind::Voltage, x)).collect();
    written(&made(channels, 0.0, DT_S, &waves), folder, "ingest")
}

/// Distance of every true pole to the nearest found one, relative, the largest.
fn worst(modes: &ModesV2) -> f64 {
    let distance = |s: Complex| {
        let estimated = modes.modes.iter().map(|mode| (Complex::new(mode.re_per_s, mode.im_rad_per_s) - s).norm());
        estimated.fold(f64::INFINITY, f64::min) / s.norm()
    };
    truth().poles().unwrap().into_iter().map(distance).fold(0.0, f64::max)
}

#[test]
fn every_method_takes_several_inputs_and_outputs() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path());
    let output = folder.path().join("4.mcap");
    let methods = "--methods=tfest,n4sid,moesp,cva,arx";
    let flags = [methods, "--inputs=heater,fan", "--outputs=inside,outside", "--orders=4", "--zeros=3"];
    // The inputs stand still between jumps, but were made with straight lines.
    let run = identify(&input, &output, &[&flags[..], &["--hold=first-order"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    for id in ["tfest-4-3", "n4sid-4", "moesp-4", "cva-4", "arx-4"] {
        let modes: ModesV2 = result.record(&format!("/modes/{id}")).unwrap().unwrap();
        // Clean data of the model class: rounding times the condition of each method.
        assert!(worst(&modes) < 1e-6, "{id}: {:e} {modes:?}", worst(&modes));
        let identification: IdentificationV1 = result.record(&format!("/identification/{id}")).unwrap().unwrap();
        assert_eq!(identification.channel, "inside, outside");
        assert_eq!(identification.output_fits_percent.len(), 2);
        assert!(identification.fit_percent.unwrap() > 99.999, "{id}: {identification:?}");
        let second: EvidenceV1 = result.record(&format!("/evidence/{id}/2")).unwrap().unwrap();
        assert_eq!((second.input.as_deref(), second.output.as_str()), (Some("heater, fan"), "outside"));
        let model: StateSpaceV1 = result.record(&format!("/model/{id}/continuous")).unwrap().unwrap();
        assert_eq!((model.b[0].len(), model.c.len()), (2, 2));
        // The path from the second input to the first output, at one frequency.
        let tf: TransferFunctionV1 = result.record(&format!("/model/{id}/1-2/transfer-function")).unwrap().unwrap();
        assert!(tf.input.contains("fan") && tf.output.contains("inside"), "{tf:?}");
        let s = Complex::new(0.0, 5.0);
        let at = |p: &[f64]| p.iter().fold(Complex::new(0.0, 0.0), |sum, c| sum * s + c);
        let complex = |m: &DMatrix<f64>| m.map(|x| Complex::new(x, 0.0));
        let resolvent = (DMatrix::identity(4, 4) * s - complex(&truth().a)).lu().solve(&complex(&truth().b)).unwrap();
        let exact = (complex(&truth().c) * resolvent)[(0, 1)];
        let estimated = at(&tf.numerator) / at(&tf.denominator);
        assert!((estimated - exact).norm() < 1e-5 * exact.norm(), "{id}: {estimated} {exact}");
    }
}

#[test]
fn every_path_foretells_the_samples_kept_for_validation() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path());
    let output = folder.path().join("4.mcap");
    let flags = ["--methods=tfest,moesp", "--inputs=heater,fan", "--outputs=inside,outside", "--zeros=3"];
    let run = identify(&input, &output, &[&flags[..], &["--validate-from=8s", "--hold=first-order"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    for id in ["tfest-4-3", "moesp-4"] {
        for number in [1, 2] {
            let evidence: EvidenceV1 = result.record(&format!("/evidence/{id}/{number}")).unwrap().unwrap();
            // Clean data of the model class, as above.
            assert!(evidence.validation_fit_percent.unwrap() > 99.999, "{id}: {:?}", evidence.validation_fit_percent);
        }
    }
}

#[test]
fn one_output_of_two_inputs_and_the_old_names_of_the_options() {
    let folder = tempfile::tempdir().unwrap();
    let input = artifact(folder.path());
    let output = folder.path().join("4.mcap");
    let flags = ["--methods=output-error,arx,n4sid", "--inputs=heater,fan", "--output-channel=inside", "--orders=4"];
    let run = identify(&input, &output, &flags);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    for id in ["output-error-4", "arx-4", "n4sid-4"] {
        let modes: ModesV2 = result.record(&format!("/modes/{id}")).unwrap().unwrap();
        assert!(worst(&modes) < 1e-5, "{id}: {:e}", worst(&modes));
        assert!(result.record::<EvidenceV1>(&format!("/evidence/{id}")).unwrap().is_some());
    }
    let run =
        identify(&input, &output, &["--methods=arx", "--input-channel=fan", "--output-channel=inside", "--force"]);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let run = identify(&input, &output, &["--methods=arx", "--input-channel=fan", "--inputs=heater"]);
    assert_eq!(run.code, Some(2), "{}", run.said);
    // Without names there is no pulse to fall back on, and the error says what to name.
    let run = identify(&input, &output, &["--methods=arx"]);
    assert_eq!(run.code, Some(3), "{}", run.said);
    let run = identify(&input, &output, &["--methods=tfest", "--inputs=none", "--outputs=inside"]);
    assert!(run.code == Some(3) && run.said.contains("one input at least"), "{}", run.said);
}

#[test]
fn negative_poles_of_an_order_too_high_are_told_of() {
    let folder = tempfile::tempdir().unwrap();
    // y[k] = 0.4 y[k-1] + 0.3 y[k-2] + u[k-1] has a pole at -0.38.
    let u: Vec<f64> = (0..400_i32).map(|k| f64::from((k * k * 7 + k * 3) % 11) - 5.0).collect();
    let mut y = vec![0.0; 400];
    for k in 2..400 {
        y[k] = 0.4 * y[k - 1] + 0.3 * y[k - 2] + u[k - 1];
    }
    let channels = ["u", "y"].map(|id| Channel::new(id, QuantityKind::Other)).to_vec();
    let waves = [("u", QuantityKind::Other, u), ("y", QuantityKind::Other, y)];
    let input = written(&made(channels, 0.0, 1.0, &waves), folder.path(), "ingest");
    let output = folder.path().join("4.mcap");
    let flags = ["--methods=arx", "--orders=2", "--inputs=u", "--outputs=y", "--hold=zero-order"];
    let run = identify(&input, &output, &flags);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    let continuous: StateSpaceV1 = result.record("/model/arx-2/continuous").unwrap().unwrap();
    assert_eq!(continuous.a.len(), 3);
    let identification: IdentificationV1 = result.record("/identification/arx-2").unwrap().unwrap();
    assert!(identification.notes.iter().any(|n| n.contains("z = -0.38")), "{:?}", identification.notes);
    let _: Option<NotesV1> = result.record("/notes").unwrap();
}
