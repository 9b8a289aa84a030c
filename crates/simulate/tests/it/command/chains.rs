//! Chains that the pipeline states or that were fitted.

use super::*;

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
    assert_eq!((same.effective_samples, same.fitted_parameters), (two.effective_samples, Some(4)));
    assert_eq!(two.fitted_parameters, Some(4));
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
    let mut fitted = candidate("chain", parameters.clone());
    let mut odd = fitted.clone();
    odd.parameters.remove("k2_n_per_m");
    let order = vec!["k2_n_per_m".to_owned(), "m1_kg".to_owned()];
    fitted.uncertainty = Some(UncertaintyV1 { order, ..UncertaintyV1::default() });
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
    // The spring and the mass that were free, by its record.
    assert_eq!(found.fitted_parameters, Some(2));
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
