//! Real situations of identification: what is typed, and what is right. Of the shared material.

use std::path::Path;

use crumple_testkit::programs::{Steps, binary, records};
use crumple_testkit::shared;
use serde_json::Value;

/// Frequencies in Hz and damping ratios of the modes above the real axis, by the model that is printed first.
fn modes(root: &Path, record: &str, flags: &[&str]) -> Vec<(f64, f64)> {
    let folder = tempfile::tempdir().unwrap();
    let ingest = binary("crumple-ingest");
    let steps = Steps { bin: ingest.parent().unwrap(), folder: folder.path(), pipeline: None };
    let record = root.join(record).to_string_lossy().into_owned();
    steps.run("ingest", &[&record, "--allow-missing", "-o", "1.mcap"]).unwrap();
    let printed = steps.run("identify", &[&["1.mcap", "--json", "-o", "4.mcap"], flags].concat()).unwrap();
    let (_, found) = records(&printed, "/modes/").next().unwrap();
    let number = |mode: &Value, name: &str| mode[name].as_f64().unwrap_or(f64::NAN);
    let all = found["modes"].as_array().unwrap().iter();
    let upper = all.filter(|mode| number(mode, "im_rad_per_s") > 0.0);
    let of_mode = |mode: &Value| {
        let hz = number(mode, "natural_frequency_rad_per_s") / std::f64::consts::TAU;
        (hz, number(mode, "damping_ratio"))
    };
    upper.map(of_mode).collect()
}

#[test]
fn the_damping_of_an_exponential_window_is_taken_off() {
    let Some(root) = shared("reference/cases") else { return };
    let asked = ["--inputs=hammer", "--outputs=acceleration", "--methods=output-error", "--orders=4"];
    let with_window = [&asked[..], &["--window-time-constant=0.12s"]].concat();
    let found = modes(&root, "T4-m12-exponential-window/hammer-window.csv", &with_window);
    // Three deviations of the damping are 0.001 %, the record is rounded to 1e-5.
    for ((hz, damping), right) in found.iter().zip([(70.83, 0.00501), (163.24, 0.01050)]) {
        assert!((hz - right.0).abs() < 0.01 && (damping - right.1).abs() < 3e-5, "{found:?}");
    }
    assert_eq!(found.len(), 2, "{found:?}");
    let measured = modes(&root, "T4-m12-exponential-window/hammer-window.csv", &asked);
    // 1/(τω) more.
    assert!((measured[0].1 - 0.00501 - 0.01873).abs() < 3e-5, "{measured:?}");
}

#[test]
fn a_mean_is_removed_from_a_free_decay() {
    let Some(root) = shared("reference/cases") else { return };
    let record = "T4-m08-remove-mean-without-effect/ringdown-offset.csv";
    let asked = ["--orders=2", "--from=1s", "--remove-mean"];
    for method in [
        &["--methods=era", "--channel=acceleration"][..],
        &["--methods=exponentials", "--outputs=acceleration", "--terms=2"],
    ] {
        let found = modes(&root, record, &[method, &asked].concat());
        let [(hz, damping)] = found[..] else { panic!("{method:?}: {found:?}") };
        assert!((hz - 5.5).abs() < 0.02 && (damping - 0.026).abs() < 0.002, "{method:?}: {found:?}");
    }
}
