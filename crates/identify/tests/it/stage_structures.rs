//! The program: structures of ARX models, several outputs of output error, papers' curve fit, and fits that do not
//! pass.

use std::path::{Path, PathBuf};

use crumple_artifact::Artifact;
use crumple_artifact::records::{
    ArxScanV1, EvidenceV1, ExponentialSumV1, IdentificationV1, ModesV2, NotesV1, StateSpaceV1,
};
use crumple_numerics::lti::{Complex, StateSpace, simulate};
use crumple_signal::{Channel, QuantityKind};
use crumple_testkit::uniform;

use crate::program::{Wave, identify, made, written};

const DT_S: f64 = 1e-3;

/// Uniform from -1 to 1 by place.
fn noise(stream: u64, k: u64) -> f64 {
    uniform(stream * 1_000_003 + k)
}

fn artifact(folder: &Path, waves: &[Wave]) -> PathBuf {
    let channels = waves.iter().filter(|(id, ..)| !id.contains('/')).map(|(id, kind, _)| Channel::new(*id, *kind));
    written(&made(channels.collect(), 0.0, DT_S, waves), folder, "ingest")
}

/// `y[k] = 1.6 y[k-1] - 0.8 y[k-2] + 0.5 u[k-2] + 0.3 u[k-3] + e`.
fn delayed(folder: &Path) -> PathBuf {
    let u: Vec<f64> = (0..800).map(|k| noise(1, k)).collect();
    let mut y = vec![0.0; 800];
    for k in 3..800 {
        y[k] = 1.6 * y[k - 1] - 0.8 * y[k - 2] + 0.5 * u[k - 2] + 0.3 * u[k - 3] + 0.05 * noise(2, k as u64);
    }
    artifact(folder, &[("u", QuantityKind::Voltage, u), ("y", QuantityKind::Voltage, y)])
}

#[test]
fn a_structure_of_arx_is_fitted_as_asked_and_a_scan_finds_it() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (delayed(folder.path()), folder.path().join("4.mcap"));
    let common = ["--methods=arx", "--inputs=u", "--outputs=y"];
    let run = identify(&input, &output, &[&common[..], &["--arx-orders=2,2,2;3,3,1"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    let evidence: EvidenceV1 = result.record("/evidence/arx-2-2-2").unwrap().unwrap();
    // Four coefficients, and three states of the longest memory for the simulation.
    assert_eq!(evidence.parameters, 7);
    assert!(result.record::<EvidenceV1>("/evidence/arx-3-3-1").unwrap().is_some());
    assert!(evidence.aic.is_some() && evidence.minimum_description_length.unwrap() > 0.0);
    assert!(evidence.vaf_percent.unwrap() > 95.0, "{evidence:?}");
    let run = identify(&input, &output, &[&common[..], &["--arx-scan=1-3,1-3,0-4", "--force"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    let scan: ArxScanV1 = result.record("/scan/y").unwrap().unwrap();
    assert_eq!((scan.models.len(), scan.best_by_bic.as_deref()), (45, Some("arx-2-2-2")));
    // The longest memory of the ranges is seven samples less one; all structures are judged on the rest.
    assert_eq!(scan.samples, 794);
    assert!(scan.models.iter().all(|model| model.failure.is_none() && model.bic.is_some() && model.mdl.is_some()));
    let whole: IdentificationV1 = result.record("/identification/arx-2-2-2").unwrap().unwrap();
    assert!(whole.notes.iter().any(|note| note.contains("smallest BIC")), "{:?}", whole.notes);
    // A scan of two outputs, and numbers that are no structure.
    let run = identify(&input, &output, &["--methods=arx", "--inputs=u", "--outputs=y,u", "--arx-scan", "--force"]);
    assert_eq!(run.code, Some(3), "{}", run.said);
    let run = identify(&input, &output, &[&common[..], &["--arx-orders=2,2"]].concat());
    assert_eq!(run.code, Some(2), "{}", run.said);
}

#[test]
fn structures_of_arx_tell_of_the_delay_and_of_those_without_a_model() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (delayed(folder.path()), folder.path().join("4.mcap"));
    let common = ["--methods=arx", "--inputs=u", "--outputs=y", "--delay=2", "--samples=60"];
    // A delay of 70 samples is more than the window has.
    for flags in ["--arx-orders=2,2,0;2,2,70", "--arx-scan=2,2,0-70"] {
        let run = identify(&input, &output, &[&common[..], &[flags, "--force"]].concat());
        assert_eq!(run.code, Some(0), "{flags} {}", run.said);
        let result = Artifact::open(&output).unwrap();
        let whole: IdentificationV1 = result.record("/identification/arx-2-2-0").unwrap().unwrap();
        assert!(whole.notes.iter().any(|note| note.contains("acts 2 samples late")), "{:?}", whole.notes);
        let notes: NotesV1 = result.record("/notes").unwrap().unwrap();
        let told = notes.notes.iter().filter(|note| note.contains("60 samples, arx needs"));
        assert_eq!(told.count(), 1, "{:?}", notes.notes);
    }
    // The answer where nothing is left, told once.
    let run = identify(&input, &output, &[&common[..], &["--arx-orders=2,2,70", "--force"]].concat());
    assert_eq!((run.code, run.said.matches("arx needs").count()), (Some(3), 1), "{}", run.said);
}

#[test]
fn output_error_of_two_inputs_and_outputs_has_common_poles_with_deviations() {
    let folder = tempfile::tempdir().unwrap();
    let a = nalgebra::dmatrix![0.9, 0.3; -0.3, 0.9];
    let (b, c) = (nalgebra::dmatrix![1.0, 0.2; 0.5, -1.0], nalgebra::dmatrix![1.0, 0.3; 0.0, 1.0]);
    let truth = StateSpace::new(a, b, c, nalgebra::DMatrix::zeros(2, 2), Some(DT_S)).unwrap();
    let u: Vec<Vec<f64>> = (0..2).map(|j| (0..400).map(|k| noise(j, k)).collect()).collect();
    let mut y = simulate(&truth, &u, &[1.0, 0.0]).unwrap();
    for (j, y) in y.iter_mut().enumerate() {
        y.iter_mut().enumerate().for_each(|(k, y)| *y += 0.05 * noise(10 + j as u64, k as u64));
    }
    let kind = QuantityKind::Voltage;
    let waves: Vec<(&str, QuantityKind, Vec<f64>)> =
        ["u", "v", "y", "z"].into_iter().zip(u.into_iter().chain(y)).map(|(id, x)| (id, kind, x)).collect();
    let (input, output) = (artifact(folder.path(), &waves), folder.path().join("4.mcap"));
    let run =
        identify(&input, &output, &["--methods=output-error,n4sid", "--orders=2", "--inputs=u,v", "--outputs=y,z"]);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    let model: StateSpaceV1 = result.record("/model/output-error-2/discrete").unwrap().unwrap();
    assert_eq!(model.a.len(), 4);
    let modes: ModesV2 = result.record("/modes/output-error-2").unwrap().unwrap();
    let evidence: EvidenceV1 = result.record("/evidence/output-error-2/1").unwrap().unwrap();
    let exact = (Complex::new(0.9, 0.3).ln() / DT_S).norm();
    assert_eq!(evidence.frequency_deviations.len(), 4);
    for (mode, deviation) in modes.modes.iter().zip(&evidence.frequency_deviations) {
        // Four standard deviations.
        let miss = (mode.natural_frequency_rad_per_s - exact).abs();
        assert!(miss < 4.0 * deviation.unwrap(), "{miss} {deviation:?}");
    }
    assert!(evidence.no_deviations.is_none() && evidence.condition.is_some() && !evidence.losses.is_empty());
    let whole: IdentificationV1 = result.record("/identification/output-error-2").unwrap().unwrap();
    assert!(whole.notes.iter().any(|note| note.contains("share 2 poles")), "{:?}", whole.notes);
}

#[test]
fn what_was_left_out_is_answered_with_one_line_and_what_to_do_instead() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (delayed(folder.path()), folder.path().join("4.mcap"));
    let pipeline = folder.path().join("p.toml");
    std::fs::write(&pipeline, "base = 'none'\n[identify]\nmethods = ['fir', 'arx']\ntaps = 80\n").unwrap();
    let file = format!("--pipeline={}", pipeline.display());
    for (flags, told) in [
        (vec!["--methods=fir"], "fir of methods is left out"),
        (vec!["--methods", "era,era-dc"], "era-dc of methods is left out"),
        (vec!["--methods=tfest", "--starts=svf,gpmf"], "gpmf of starts is left out"),
        (vec!["--methods=okid", "--okid-states=joint"], "okid_states is left out"),
        (vec![file.as_str()], "p.toml: fir of methods is left out"),
    ] {
        let run = identify(&input, &output, &flags);
        assert_eq!(run.code, Some(2), "{flags:?} {}", run.said);
        let lines: Vec<&str> = run.said.lines().collect();
        assert!(lines[0].ends_with(told) && lines[1].contains("hint: ") && lines.len() == 2, "{flags:?} {}", run.said);
    }
}

/// A compartment that comes to rest: 10 m/s at contact, no deceleration yet; its velocity beside it.
fn contact(folder: &Path) -> PathBuf {
    let (a, b, v0) = (-20.0, 25.0, 10.0);
    // C + A = 0, a A + b B = v0, (a² - b²) A + 2 a b B = 0.
    let big_a = 2.0 * a * v0 / (a * a + b * b);
    let big_b = (v0 - a * big_a) / b;
    let wave = |t: f64| (a * t).exp() * (big_a * (b * t).cos() + big_b * (b * t).sin()) - big_a;
    let slope = |t: f64| {
        let (c, s) = ((b * t).cos(), (b * t).sin());
        (a * t).exp() * ((a * big_a + b * big_b) * c + (a * big_b - b * big_a) * s)
    };
    let over = |f: &dyn Fn(f64) -> f64, level: f64| {
        (0..150).map(|k| f(k as f64 * DT_S) + level * noise(5, k)).collect::<Vec<f64>>()
    };
    let waves = [
        ("93", QuantityKind::Acceleration, vec![0.0; 150]),
        ("93/displacement", QuantityKind::Displacement, over(&wave, 1e-4)),
        ("93/velocity", QuantityKind::Velocity, over(&slope, 0.0)),
    ];
    artifact(folder, &waves)
}

#[test]
fn the_papers_curve_fit_is_labelled_and_the_way_of_the_stage_stands_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (contact(folder.path()), folder.path().join("4.mcap"));
    let run = identify(&input, &output, &["--paper=curve-fit", "--channel=93"]);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    let printed: ExponentialSumV1 = result.record("/model/exponentials-4-paper").unwrap().unwrap();
    assert!(printed.terms.len() == 4 && printed.terms.iter().all(|term| term.im_rad_per_s == 0.0), "{printed:?}");
    let evidence: EvidenceV1 = result.record("/evidence/exponentials-4-paper").unwrap().unwrap();
    assert_eq!(evidence.paper.as_deref(), Some("curve-fit"));
    let whole: IdentificationV1 = result.record("/identification/exponentials-4-paper").unwrap().unwrap();
    assert!(whole.notes[0].starts_with("exponentials-4-paper: paper curve-fit: equation 16"), "{:?}", whole.notes);
    let own: EvidenceV1 = result.record("/evidence/exponentials-4").unwrap().unwrap();
    assert!(own.paper.is_none() && own.initial_conditions.contains("velocity 1.0"), "{}", own.initial_conditions);
    // What belongs to the procedure is not given again, but with the same value.
    for (flags, code) in [(vec!["--terms=3"], 2), (vec!["--conditions=position"], 2), (vec!["--terms=4", "--real"], 0)]
    {
        let run = identify(&input, &output, &[&["--paper=curve-fit", "--channel=93", "--force"], &flags[..]].concat());
        assert_eq!(run.code, Some(code), "{flags:?} {}", run.said);
    }
}

#[test]
fn conditions_at_the_start_take_values_and_terms_have_deviations() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (contact(folder.path()), folder.path().join("4.mcap"));
    let common = ["--methods=exponentials", "--terms=3", "--outputs=93/displacement"];
    let held = "--conditions=position,velocity,acceleration";
    let flags = [&common[..], &[held, "--start-velocity=36km/h", "--start-acceleration=-2m/s^2"]].concat();
    let run = identify(&input, &output, &flags);
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    let sum: ExponentialSumV1 = result.record("/model/exponentials-3").unwrap().unwrap();
    let derivative = |d: u32| {
        let term = |t: &crumple_artifact::records::ExponentialTermV1| {
            Complex::new(t.re_amplitude, t.im_amplitude) * Complex::new(t.re_per_s, t.im_rad_per_s).powu(d)
        };
        sum.terms.iter().map(term).sum::<Complex>().re
    };
    // Exact by construction, but for the cancellation among the terms.
    assert!((derivative(1) - 10.0).abs() < 1e-9 && (derivative(2) + 2.0).abs() < 1e-7, "{}", derivative(2));
    let run = identify(&input, &output, &[&common[..], &["--force"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.said);
    let result = Artifact::open(&output).unwrap();
    let evidence: EvidenceV1 = result.record("/evidence/exponentials-3").unwrap().unwrap();
    let at = evidence.parameter_names.iter().position(|name| name.starts_with("im_rad_per_s")).unwrap();
    let miss = (evidence.parameter_values[at] - 25.0).abs();
    // Four standard deviations.
    assert!(miss < 4.0 * evidence.parameter_deviations[at], "{miss} {:?}", evidence.parameter_deviations);
    assert!(evidence.parameter_correlations.iter().enumerate().all(|(i, row)| row[i] == 1.0));
    assert!(evidence.frequency_deviations.iter().all(Option::is_some), "{evidence:?}");
    // Values without their conditions, and a bare number.
    for flags in [vec!["--start-velocity=10m/s"], vec!["--conditions=position,velocity", "--start-velocity=10"]] {
        let run = identify(&input, &output, &[&common[..], &flags[..], &["--force"]].concat());
        assert_eq!(run.code, Some(2), "{flags:?} {}", run.said);
    }
}
