//! Models moved by something else than the impact.

use crumple_lumped::{Elastoplastic, Nonlinear1};

use crate::command::*;

#[test]
fn a_model_that_is_nearly_one_mass_gives_the_pulse_back_when_driven_by_it() {
    let folder = tempfile::tempdir().unwrap();
    // The shape of the transfer-function paper's best set: masses locked together, weak springs.
    let locked =
        DoubleSpringMassDamper { k1_n_per_m: 1.0, k2_n_per_m: 1.0, c1_n_s_per_m: 1.0, c2_n_s_per_m: 7e6, ..DOUBLE };
    let id = "double-spring-mass-damper/coefficient-matching/1";
    let locked = Model::DoubleSpringMassDamper(locked);
    write(&folder.path().join("5.mcap"), &[(id, candidate("double-spring-mass-damper", locked.parameters()))]);
    let output = run_with(folder.path(), &["--drive", "pulse-as-force"]);
    // The artifact has no pulse yet.
    assert_eq!(output.status.code(), Some(3));
    let pulse = write_pulse(folder.path());
    let output = run_with(folder.path(), &[&pulse, "--drive", "pulse-as-force"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("circular"), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let simulation: SimulationV1 = artifact.record(&format!("/simulation/{id}")).unwrap().unwrap();
    // The answer that went in, but for the give of the damper between the masses, m2 v0/c2 at most.
    assert!(simulation.rmse_displacement_m.unwrap() < 582.0 * 9.7 / 7e6, "{simulation:?}");
    assert!(simulation.energy_closure.unwrap() < 1e-9 && simulation.drive.unwrap().contains("circular"));
    let usage = run_with(folder.path(), &["--drive", "puls-as-force"]);
    assert_eq!(usage.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&usage.stderr).contains("'pulse-as-force'"));
    assert_eq!(run_with(folder.path(), &["--drive", "force"]).status.code(), Some(2));
}

#[test]
fn a_chain_is_moved_by_a_force_on_a_named_mass_or_by_the_barrier() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("5.mcap"), &[]);
    let mut builder = ArtifactBuilder::new();
    let constant = |value: f64| Sampled::new(0.0, 1e-4, vec![value; 1002]).unwrap();
    builder.wave("push", QuantityKind::Force, constant(5e4)).unwrap();
    builder.wave("sled", QuantityKind::Acceleration, constant(100.0)).unwrap();
    let second = folder.path().join("drives.mcap");
    builder.write(&second, &Provenance::new("x", "0", "{}".to_owned(), Vec::new()), Compression::None).unwrap();
    let masses = r#"masses = [{ name = "engine", mass = "200 kg", stiffness = [["0 m", "2 MN/m"],["0.1 m", "1 MN/m"]] },
                              { name = "cabin", mass = "800 kg", stiffness = "1 MN/m", damping = "5 kN*s/m" }]"#;
    let text = format!(
        "[simulate.chain.pushed]\ndrive = 'force'\ndrive_wave = 'push'\ndrive_mass = 'cabin'\n{masses}\n\
         [simulate.chain.rolling]\nspeed = '9 m/s'\ndrive = 'force'\ndrive_wave = 'push'\n{masses}\n\
         [simulate.chain.on-a-sled]\ndrive = 'base'\ndrive_wave = 'sled'\n{masses}\n"
    );
    std::fs::write(folder.path().join("p.toml"), text).unwrap();
    let pipeline = folder.path().join("p.toml");
    let output = run_with(folder.path(), &[second.to_str().unwrap(), "--pipeline", pipeline.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let wave = |id: &str, what: &str| artifact.waves()[&format!("chain/{id}/1/{what}")].sampled.samples().to_vec();
    // From rest only what the force acts on starts: F/m.
    assert_eq!((wave("pushed", "acceleration")[0], wave("pushed", "m1/acceleration")[0]), (5e4 / 800.0, 0.0));
    assert_eq!((wave("rolling", "velocity")[0], wave("rolling", "m1/velocity")[0]), (9.0, 9.0));
    // Force and the first spring at rest: (5e4 - 0)/200; the damper behind sees no speed yet.
    assert_eq!(wave("rolling", "m1/acceleration")[0], 250.0);
    assert_eq!(wave("on-a-sled", "velocity")[0], 0.0);
    assert!(wave("on-a-sled", "displacement")[1000] > 0.2);
    for id in ["pushed", "rolling", "on-a-sled"] {
        let simulation: SimulationV1 = artifact.record(&format!("/simulation/chain/{id}/1")).unwrap().unwrap();
        assert!(simulation.energy_closure.unwrap() < 1e-11 && simulation.drive.is_some(), "{id}");
    }
}

#[test]
fn a_sled_is_moved_by_a_pulse_of_a_family() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("5.mcap"), &[]);
    let text = "[simulate.chain.dummy]\ndrive = 'base'\ndrive_wave = 'half-sine 200m/s^2 80ms'\n\
                masses = [{ name = 'chest', mass = '40 kg', stiffness = '60 kN/m' }]\n";
    let pipeline = folder.path().join("p.toml");
    std::fs::write(&pipeline, text).unwrap();
    let output = run_with(folder.path(), &["--pipeline", pipeline.to_str().unwrap()]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let simulation: SimulationV1 = artifact.record("/simulation/chain/dummy/1").unwrap().unwrap();
    assert!(simulation.drive.unwrap().contains("half-sine 200m/s^2 80ms"));
    let x = artifact.waves()["chain/dummy/1/displacement"].sampled.samples().to_vec();
    // Undamped, z = x - y: z'' + w² z = -A sin(W t) from rest, and y = A/W (t - sin(W t)/W) while the pulse lasts.
    let (a, big, w) = (200.0, std::f64::consts::PI / 0.08, (60e3_f64 / 40.0).sqrt());
    for k in [100, 400, 800] {
        let t = f64::from(k) * 1e-4;
        let z = -a / (w * w - big * big) * ((big * t).sin() - big / w * (w * t).sin());
        let y = a / big * (t - (big * t).sin() / big);
        // Exact but for rounding.
        assert!((x[k as usize] - (y + z)).abs() < 1e-12, "{} {}", x[k as usize], y + z);
    }
    let usage = run_with(folder.path(), &["--drive", "force", "--drive-wave", "half-sine 200m/s^2 80ms"]);
    assert_eq!(usage.status.code(), Some(2));
}

#[test]
fn a_nonlinear_and_an_elastoplastic_model_are_driven_by_a_force() {
    let folder = tempfile::tempdir().unwrap();
    let nonlinear = Model::Nonlinear1(Nonlinear1 {
        mass_kg: 900.0,
        k1_n_per_m: 2e4,
        k2_n_per_m: 4e5,
        c1_n_s_per_m: 5e4,
        c2_n_s_per_m: 1e4,
        c3_n_s_per_m: 2e3,
        v_thresh_m_per_s: 3.0,
        crush_m: 0.5,
        v0_m_per_s: 9.7,
    });
    let plastic = Model::Elastoplastic(Elastoplastic {
        mass_kg: 900.0,
        loading_stiffness_n_per_m: 3e5,
        unloading_stiffness_n_per_m: 6e6,
        release: true,
    });
    let (id, other) = ("nonlinear-1/direct-fit/1", "elastoplastic/closed-form/1");
    write(
        &folder.path().join("5.mcap"),
        &[
            (id, candidate("nonlinear-1", nonlinear.parameters())),
            (other, candidate("elastoplastic", plastic.parameters())),
        ],
    );
    let mut builder = ArtifactBuilder::new();
    builder.wave("push", QuantityKind::Force, Sampled::new(0.0, 1e-4, vec![5e4; 1002]).unwrap()).unwrap();
    let second = folder.path().join("drives.mcap");
    builder.write(&second, &Provenance::new("x", "0", "{}".to_owned(), Vec::new()), Compression::None).unwrap();
    let output = run_with(folder.path(), &[second.to_str().unwrap(), "--drive", "force", "--drive-wave", "push"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    for id in [id, other] {
        let wave = |what: &str| artifact.waves()[&format!("{id}/{what}")].sampled.samples().to_vec();
        // From rest, F/m.
        assert_eq!((wave("velocity")[0], wave("acceleration")[0]), (0.0, 5e4 / 900.0), "{id}");
        let simulation: SimulationV1 = artifact.record(&format!("/simulation/{id}")).unwrap().unwrap();
        assert!(simulation.energy_closure.unwrap() < 1e-11 && simulation.drive.is_some(), "{id}");
    }
}

#[test]
fn a_drive_wave_that_filtering_dropped_is_answered_with_how_to_hand_it_on() {
    let folder = tempfile::tempdir().unwrap();
    let kelvin = ("kelvin/direct-fit/1", candidate("kelvin", Model::Kelvin(MODEL).parameters()));
    let forces = ["wall_force"].map(|id| Channel::new(id, QuantityKind::Force));
    write_channels(&folder.path().join("5.mcap"), &[kelvin], &forces);
    let refused = |wave: &str, more: &[&str]| {
        let output = run_with(folder.path(), &[more, &["--drive", "force", "--drive-wave", wave]].concat());
        assert_eq!(output.status.code(), Some(3), "{wave}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let stderr = refused("wall_force", &[]);
    let expected = "the drive wave wall_force is in none of the inputs\n  expected: a waveform of force in them: \
        none\n  hint: filtering drops it unless it is passed on: pass = [\"wall_force\"] in [filter], or \
        crumple-filter --pass wall_force\n";
    assert!(stderr.contains(expected), "{stderr}");
    // As its column is named.
    let stderr = refused("Wall force", &[]);
    assert!(stderr.contains("--pass wall_force, and drive_wave = \"wall_force\""), "{stderr}");

    // Handed on.
    let mut builder = ArtifactBuilder::new();
    builder.wave("wall_force", QuantityKind::Force, Sampled::new(0.0, 1e-4, vec![5e4; 1002]).unwrap()).unwrap();
    let second = folder.path().join("2.mcap");
    builder.write(&second, &Provenance::new("filter", "0", "{}".to_owned(), Vec::new()), Compression::None).unwrap();
    let second = second.to_str().unwrap();
    let stderr = refused("wal_force", &[second]);
    assert!(stderr.contains("in them: wall_force\n  hint: did you mean \"wall_force\"?"), "{stderr}");
    let output = run_with(folder.path(), &[second, "--drive", "force", "--drive-wave", "wall_force"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    // A fit beside a test that was driven otherwise assesses no model.
    assert!(stderr.contains("they assess and rank no model unless the test was driven in the same way"), "{stderr}");
}

const CHAINS: &str = r#"
[simulate.chain.two]
masses = [
  { name = "chassis", mass = "291 kg", stiffness = "300 kN/m", damping = "4 kN*s/m" },
  { name = "compartment", mass = "0.582 t", stiffness = "400 N/mm", damping = "6 N*s/mm" },
]

[simulate.chain.soft]
speed = "36 km/h"
masses = [
  { name = "subframe", mass = "90 kg", stiffness = [["0 mm", "900 kN/m"],
    ["200 mm", "150 kN/m"]], damping = "3 kN*s/m" },
  { name = "engine", mass = "201 kg", stiffness = "600 kN/m", damping = [["0 m/s", "9 kN*s/m"],
    ["18 km/h", "2 kN*s/m"]] },
  { mass = "582 kg", stiffness = "500 kN/m" },
]
"#;

#[test]
fn chains_of_the_pipeline_stand_beside_the_candidates() {
    let folder = tempfile::tempdir().unwrap();
    let double = Model::DoubleSpringMassDamper(DOUBLE);
    let id = "double-spring-mass-damper/direct-fit/1";
    write(&folder.path().join("5.mcap"), &[(id, candidate("double-spring-mass-damper", double.parameters()))]);
    let output = run_pipeline(folder.path(), CHAINS);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let simulation = |id: &str| -> SimulationV1 { artifact.record(&format!("/simulation/{id}")).unwrap().unwrap() };
    let wave = |id: &str, what: &str| artifact.waves()[&format!("{id}/{what}")].sampled.samples().to_vec();
    // The same two masses as the candidate, in other units.
    let (same, two) = (simulation(id), simulation("chain/two/1"));
    // Both exact; a thousand multiplications by matrices that differ by roundings.
    for what in ["displacement", "m1/displacement", "force/k2"] {
        for (a, b) in wave(id, what).iter().zip(wave("chain/two/1", what)) {
            assert!((a - b).abs() <= 1e-12 * (1.0 + a.abs()) + 1e-12 * 4e5, "{what}: {a} {b}");
        }
    }
    assert!((same.dynamic_crush_m.unwrap() - two.dynamic_crush_m.unwrap()).abs() < 1e-12);
    assert!((same.fit_percent.unwrap() - two.fit_percent.unwrap()).abs() < 1e-8);
    let stated: CandidateV1 = artifact.record("/parameters/chain/two/1").unwrap().unwrap();
    assert_eq!((stated.model.as_str(), stated.method.as_str()), ("chain", "two"));
    assert!((stated.parameters["k2_n_per_m"] - 4e5).abs() < 1e-9 && stated.parameters.len() == 6);
    assert_eq!(stated.notes[0], "masses from the barrier on: chassis, compartment");

    // Three masses, knots, a speed of its own.
    let soft = simulation("chain/soft/1");
    assert!(soft.energy_closure.unwrap() < 1e-11);
    assert!((soft.energy[0].kinetic_j - 0.5 * 873.0 * 100.0).abs() < 1e-8);
    assert_eq!(soft.drive.as_deref(), Some("an impact at 10 m/s, stated in the pipeline"));
    assert_eq!(wave("chain/soft/1", "m2/velocity")[0], 10.0);
    assert!(wave("chain/soft/1", "force/c3").iter().all(|force| *force == 0.0));
    let stated: CandidateV1 = artifact.record("/parameters/chain/soft/1").unwrap().unwrap();
    assert_eq!((stated.parameters["k1_knot2_m"], stated.parameters["k1_knot2_n_per_m"]), (0.2, 150e3));
    assert_eq!((stated.parameters["c2_knot2_m_per_s"], stated.parameters["c2_knot2_n_s_per_m"]), (5.0, 2e3));
    assert_eq!(stated.notes[0], "masses from the barrier on: subframe, engine, m3");
    // What was computed with stands in the provenance.
    let settings = &artifact.provenance().unwrap().config_json;
    assert!(
        settings.contains(r#""name":"two""#)
            && settings.contains(r#""stiffness_n_per_m":[[0.0,900000.0],[0.2,150000.0]]"#),
        "{settings}"
    );
    assert_eq!(run_pipeline(folder.path(), "[simulate]\n").status.code(), Some(0));
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    assert!(!artifact.provenance().unwrap().config_json.contains("chain"));
}

#[test]
fn a_chain_that_is_not_as_heavy_as_the_test_is_simulated_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("5.mcap"), &[]);
    let chain = |name: &str, kg: &str| {
        format!(
            "[simulate.chain.{name}]\nmasses = [{{ mass = '291 kg', stiffness = '300 kN/m' }}, {{ mass = '{kg} kg', \
             stiffness = '400 kN/m' }}]\n"
        )
    };
    let output = run_pipeline(folder.path(), &(chain("light", "500") + &chain("near", "576")));
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let said = "its masses add up to 791.0 kg, the test has 873.0 kg: 9.4 % less (noted above 1 %)";
    assert!(stderr.contains(&format!("chain/light/1: {said}")), "{stderr}");
    // 867 of 873 kg.
    assert!(!stderr.contains("chain/near/1: its masses"), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let light: CandidateV1 = artifact.record("/parameters/chain/light/1").unwrap().unwrap();
    assert!(light.notes.iter().any(|note| note.starts_with(said)), "{:?}", light.notes);
}

#[test]
fn a_chain_that_is_no_passive_structure_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("5.mcap"), &[]);
    let text = "[simulate.chain.odd]\nmasses = [{ mass = '900 kg', stiffness = [['0 mm', '300 kN/m'], ['400 mm', '-50 \
        kN/m']] }]\n";
    let output = run_pipeline(folder.path(), text);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let expected = "chain/odd/1: a spring or damper of [simulate.chain.odd] is negative somewhere";
    assert!(stderr.contains(expected), "{stderr}");
}

#[test]
fn a_bad_chain_is_answered_with_what_to_write() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("5.mcap"), &[("k/k/1", candidate("kelvin", Model::Kelvin(MODEL).parameters()))]);
    let answer = |text: &str| {
        let output = run_pipeline(folder.path(), text);
        assert_eq!(output.status.code(), Some(2), "{text}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let mass = |fields: &str| format!("[simulate.chain.car]\nmasses = [{{ mass = '900 kg', {fields} }}]\n");
    for (text, expected) in [
        (
            mass("stifness = '300 kN/m'"),
            "[simulate.chain.car], mass 1: unknown key \"stifness\"\n  hint: did you mean \"stiffness\"?",
        ),
        (
            mass("stiffness = 300"),
            "mass 1, stiffness: \"300\" has no unit: write a stiffness, e.g. 300 N/m (units: kN/m, N/m",
        ),
        (
            mass("stiffness = '300 kN/m', damping = '5 kN/m'"),
            "damping: \"kN/m\" in \"5 kN/m\" is not a unit of damping",
        ),
        (mass("stiffness = [['0 mm', '3 kN/m'], ['200', '1 kN/m']]"), "stiffness: \"200\" has no unit: write a length"),
        (
            mass("stiffness = [['0 mm', '3 kN/m'], ['0 mm', '1 kN/m']]"),
            "stiffness: knot is 0, expected above the knot before it",
        ),
        (mass("stiffness = ['3 kN/m', '1 kN/m']"), "expected one value, or a list of pairs"),
        (mass("name = 'cabin'"), "mass 1 has no stiffness"),
        ("[simulate.chain.car]\nmases = []".to_owned(), "unknown key \"mases\"\n  hint: did you mean \"masses\"?"),
        ("[simulate.chain.car]\nspeed = '3 m/s'".to_owned(), "[simulate.chain.car] has no masses"),
        (
            "[simulate.chian.car]\nmasses = []".to_owned(),
            "unknown key \"chian\" in [simulate]\n  hint: did you mean \"chain\"?",
        ),
        (
            mass("name = 'cabin', stiffness = '3 kN/m'") + "drive = 'force'\ndrive_wave = 'f'\ndrive_mass = 'cabbin'",
            "drive_mass \"cabbin\" is no mass of it\n  hint: did you mean \"cabin\"?",
        ),
        (mass("stiffness = '3 kN/m'") + "drive = 'base'", "[simulate.chain.car]: drive base needs a waveform"),
        (mass("stiffness = '3 kN/m'") + "speed = '0 m/s'", "speed is 0 m/s, expected a positive speed"),
        (mass("stiffness = '3 kN/m'").replace("900", "-900"), "mass_kg is -900, expected a positive number"),
    ] {
        let found = answer(&text);
        assert!(found.contains(expected), "{text}\n{found}");
    }
}

#[test]
fn a_chain_that_was_fitted_is_simulated_beside_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let parameters: BTreeMap<String, f64> = [
        ("m1_kg", 291.0),
        ("m2_kg", 582.0),
        ("k1_knot1_n_per_m", 3e5),
        ("k1_knot2_m", 0.2),
        ("k1_knot2_n_per_m", 5e5),
        ("k2_n_per_m", 4e5),
        ("c1_n_s_per_m", 4e3),
        ("c2_n_s_per_m", 6e3),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    let fitted = candidate("chain", parameters.clone());
    let mut odd = fitted.clone();
    odd.parameters.remove("k2_n_per_m");
    write(&folder.path().join("5.mcap"), &[("chain/car/1", fitted), ("chain/odd/1", odd)]);
    let output = run_pipeline(folder.path(), "[simulate]\n");
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(
        stderr.contains("chain/odd/1: not simulated, a chain of masses needs the parameter k2_n_per_m"),
        "{stderr}"
    );
    let artifact = Artifact::open(&folder.path().join("6.mcap")).unwrap();
    let found: SimulationV1 = artifact.record("/simulation/chain/car/1").unwrap().unwrap();
    let chain = Chain::from_parameters(&parameters).unwrap();
    let events = chain.events(9.7, 2.0).unwrap().pop().unwrap();
    assert_eq!(found.dynamic_crush_m, events.dynamic_crush_m);
    assert!(artifact.waves().contains_key("chain/car/1/m1/displacement"));
    // The same name twice would be one topic for two chains.
    let masses = "masses = [{ mass = \"873 kg\", stiffness = \"1 MN/m\" }]";
    let output = run_pipeline(folder.path(), &format!("[simulate.chain.car]\n{masses}\n"));
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("give one of them another name"));
}
