//! The routes of the three papers end with a result, whatever the record: a wild candidate takes no other with it.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use crumple_artifact::Artifact;
use crumple_lumped::{Model, ModelKind};
use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;
use crumple_testkit::programs::run;
use crumple_testkit::workspace;

const PIPELINES: [&str; 3] = ["papers/civic", "papers/era", "papers/firefly"];

fn assert_result(record: &Path, flags: &[&str]) {
    for pipeline in PIPELINES {
        let folder = tempfile::tempdir().unwrap();
        let output = run(&[&format!("pipeline={pipeline}")], folder.path(), record, flags);
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{pipeline} of {}: {error}", record.display());
        let solved = Artifact::open(&folder.path().join("5-parameter-solve.mcap")).unwrap();
        let candidates = solved.records().iter().filter(|record| record.topic.starts_with("/parameters/")).count();
        assert!(candidates > 0, "{pipeline} of {}: no candidate", record.display());
    }
}

#[test]
fn every_fixture_has_a_result_by_the_route_of_every_paper() {
    for name in ["kelvin", "elastoplastic", "double", "noisy"] {
        assert_result(&workspace().join("fixtures").join(name).join("crash.csv"), &[]);
    }
}

#[test]
fn so_have_the_motions_of_the_cases_of_the_era_paper() {
    // Munyazikwiye et al., Table I, cases 1 and 4, with the impact speed of 35 km/h: m1, m2, k1, k2, c1, c2.
    let cases =
        [[291.0, 582.0, 45929.0, 40731.0, 13687.0, 9952.0], [654.75, 218.25, 74681.0, 45821.0, 18176.0, 11196.0]];
    let names = ["m1_kg", "m2_kg", "k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m"];
    let folder = tempfile::tempdir().unwrap();
    for (number, values) in cases.iter().enumerate() {
        let parameters: BTreeMap<String, f64> = names.iter().map(|name| (*name).to_owned()).zip(*values).collect();
        let model = Model::from_parameters(ModelKind::DoubleSpringMassDamper, &parameters).unwrap();
        let response = model.respond(35.0 / 3.6, 1e-4, 3001).unwrap();
        let mut csv = "time [s],acceleration [g]\n".to_owned();
        for k in 0..3501_usize {
            let a = k.checked_sub(500).map_or(0.0, |k| response.compartment().acceleration_m_per_s2[k] / G);
            let _infallible = writeln!(csv, "{:.4},{:.9}", k as f64 * 1e-4 - 0.05, a + 0.0);
        }
        let record = folder.path().join(format!("case-{number}.csv"));
        std::fs::write(&record, csv).unwrap();
        assert_result(&record, &["--mass", "873kg", "--impact-speed", "35km/h"]);
    }
}
