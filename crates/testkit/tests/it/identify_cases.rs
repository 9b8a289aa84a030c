//! Real situations of identification: what is typed, and what is right. Of the shared material.

use std::path::Path;

use crumple_testkit::programs::{Steps, binary, records};
use crumple_testkit::shared;
use serde_json::Value;

/// What `identify` prints of a record as JSON lines.
fn printed(root: &Path, record: &str, flags: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let ingest = binary("crumple-ingest");
    let steps = Steps { bin: ingest.parent().unwrap(), folder: folder.path(), pipeline: None };
    let record = root.join(record).to_string_lossy().into_owned();
    steps.run("ingest", &[&record, "--allow-missing", "-o", "1.mcap"]).unwrap();
    steps.run("identify", &[&["1.mcap", "--json", "-o", "4.mcap"], flags].concat()).unwrap()
}

/// The record of this topic.
fn topic(printed: &str, topic: &str) -> Value {
    records(printed, topic).find(|(rest, _)| rest.is_empty()).map_or(Value::Null, |(_, data)| data)
}

fn number(record: &Value, name: &str) -> f64 {
    record[name].as_f64().unwrap_or(f64::NAN)
}

fn hz(mode: &Value) -> f64 {
    number(mode, "natural_frequency_rad_per_s") / std::f64::consts::TAU
}

/// Frequencies in Hz and damping ratios of the modes above the real axis, by the model that is printed first.
fn modes(root: &Path, record: &str, flags: &[&str]) -> Vec<(f64, f64)> {
    let printed = printed(root, record, flags);
    let (_, found) = records(&printed, "/modes/").next().unwrap();
    let upper = found["modes"].as_array().unwrap().iter().filter(|mode| number(mode, "im_rad_per_s") > 0.0);
    upper.map(|mode| (hz(mode), number(mode, "damping_ratio"))).collect()
}

/// Values and deviations of numbers of these names in the evidence of a model.
fn numbers(evidence: &Value, names: &[&str]) -> Vec<(f64, f64)> {
    let known = evidence["parameter_names"].as_array().unwrap();
    let place = |name: &&str| known.iter().position(|known| known.as_str() == Some(name)).unwrap();
    let at = |list: &str, place: usize| evidence[list][place].as_f64().unwrap();
    names.iter().map(place).map(|k| (at("parameter_values", k), at("parameter_deviations", k))).collect()
}

/// Whether the notes of the run or of a model hold this text.
fn says(printed: &str, text: &str) -> bool {
    let notes = records(printed, "/notes").chain(records(printed, "/diagnosis"));
    notes.map(|(_, data)| data.to_string()).any(|notes| notes.contains(text))
}

const SINGLE_MASS: [&str; 3] = ["mass_kg", "damping_n_s_per_m", "stiffness_n_per_m"];

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

/// 4.001 Hz and 2.65 % of a displacement that no input drives.
#[test]
fn a_displacement_is_its_own_answer() {
    let Some(root) = shared("reference/cases") else { return };
    for record in ["ringdown-mm.csv", "two-quantities-right-today.csv"] {
        for flags in [["--methods=era", "--orders=2"], ["--methods=exponentials", "--terms=2"]] {
            let flags = [&flags[..], &["--channel=displacement"]].concat();
            let found = modes(&root, &format!("T4-m09-table-of-one-quantity/{record}"), &flags);
            let is_right = |(hz, damping): &(f64, f64)| (hz - 4.001).abs() < 0.02 && (damping - 0.0265).abs() < 1e-3;
            assert!(found.iter().all(is_right) && found.len() == 1, "{record} {flags:?}: {found:?}");
        }
    }
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

#[test]
fn a_staircase_is_taken_for_one_and_the_flag_wins() {
    let Some(root) = shared("reference/cases") else { return };
    let record = "T4-m07-hold-of-the-input/steps.csv";
    let asked = ["--methods=tfest", "--poles=2", "--zeros=0", "--inputs=force", "--outputs=displacement"];
    let found = printed(&root, record, &asked);
    let evidence = topic(&found, "/evidence/tfest-2-0");
    assert_eq!(evidence["hold"], "zero-order");
    assert!(says(&found, "force stands still between its jumps"), "{found}");
    for ((value, deviation), right) in numbers(&evidence, &SINGLE_MASS).into_iter().zip([2.5, 4.0, 1800.0]) {
        // Three deviations: one in 400 by chance.
        assert!((value - right).abs() < 3.0 * deviation && deviation < 0.005 * right, "{value} ± {deviation}, {right}");
    }
    let lines = printed(&root, record, &[&asked[..], &["--hold=first-order"]].concat());
    assert_eq!(topic(&lines, "/evidence/tfest-2-0")["hold"], "first-order");
    assert!(says(&lines, "--hold zero-order takes steps"), "{lines}");
}

#[test]
fn what_straight_lines_lose_of_a_smooth_input_is_in_the_deviations() {
    let Some(root) = shared("reference/cases") else { return };
    let asked = ["--methods=tfest", "--poles=2", "--zeros=0", "--inputs=force", "--outputs=position"];
    let found = printed(&root, "T4-m07-hold-of-the-input/sine.csv", &asked);
    let evidence = topic(&found, "/evidence/tfest-2-0");
    assert_eq!(evidence["hold"], "first-order");
    assert!(says(&found, "straight lines between the samples of force lose 3.2 %"), "{found}");
    for ((value, deviation), right) in numbers(&evidence, &SINGLE_MASS).into_iter().zip([2.0, 0.3, 0.2]) {
        assert!((value - right).abs() < 1.96 * deviation, "{value} ± {deviation}, {right}");
    }
}

#[test]
fn an_unstable_plant_in_a_loop_has_poles_where_they_are_asked_for() {
    let Some(root) = shared("reference/cases") else { return };
    let record = "T4-m13-unstable-plant-in-a-loop/loop.csv";
    let asked = ["--inputs=u", "--outputs=y", "--methods=arx", "--arx-orders=2,1,1"];
    let refused = printed(&root, record, &asked);
    assert!(says(&refused, "--allow-unstable"), "{refused}");
    let found = printed(&root, record, &[&asked[..], &["--allow-unstable"]].concat());
    let modes = topic(&found, "/modes/arx-2-1-1");
    let mut poles: Vec<f64> = modes["modes"].as_array().unwrap().iter().map(|z| number(z, "discrete_re")).collect();
    poles.sort_by(f64::total_cmp);
    // What the regression has on these samples.
    assert!((poles[0] - 0.88).abs() < 0.001 && (poles[1] - 1.117).abs() < 0.001, "{poles:?}");
    let evidence = topic(&found, "/evidence/arx-2-1-1");
    assert!(number(&evidence, "prediction_fit_percent") > 90.0 && evidence["loss"].is_null(), "{evidence}");
    assert!(topic(&found, "/identification/arx-2-1-1")["fit_percent"].is_null());
    assert!(says(&found, "cannot be simulated"), "{found}");
    // A(q) and B(q) of the regression, of the true 2.0, 0.99 and 0.1.
    for ((value, deviation), right) in numbers(&evidence, &["a_1", "a_2", "b_1"]).into_iter().zip([-2.0, 0.99, 0.1]) {
        assert!((value - right).abs() < 3.0 * deviation, "{value} ± {deviation}, {right}");
    }
}

#[test]
fn a_pair_that_a_zero_cancels_is_no_mode() {
    let Some(root) = shared("reference/cases") else { return };
    let record = "T4-m10-cancelling-pair-as-a-mode/order-two.csv";
    let asked = ["--inputs=u", "--outputs=y", "--methods=output-error,n4sid", "--orders=4"];
    let found = printed(&root, record, &asked);
    for id in ["output-error-4", "n4sid-4"] {
        let modes = topic(&found, &format!("/modes/{id}"));
        let own = modes["modes"].as_array().unwrap();
        assert!(own.len() == 2 && own.iter().all(|mode| (hz(mode) - 0.784).abs() < 0.005), "{id}: {own:?}");
        let others = modes["other_poles"].as_array().unwrap();
        assert!(others.len() == 2 && others.iter().all(|pole| pole["kind"] == "cancelled"), "{id}: {others:?}");
        let deviations = topic(&found, &format!("/evidence/{id}"))["frequency_deviations"].clone();
        assert!(deviations.as_array().unwrap().len() <= 2, "{id}: {deviations}");
        assert!(says(&found, &format!("{id}: zeros cancel the poles")), "{found}");
    }
    assert_eq!(modes(&root, record, &["--inputs=u", "--outputs=y", "--methods=output-error", "--orders=2"]).len(), 1);
}

#[test]
fn a_machine_that_runs_is_a_line_and_no_mode() {
    let Some(root) = shared("reference/cases") else { return };
    let asked = ["--inputs=none", "--outputs=a1,a2,a3", "--methods=n4sid", "--orders=auto"];
    let found = printed(&root, "T4-m11-machine-as-a-mode/ambient-with-machine.csv", &asked);
    let diagram = topic(&found, "/stabilisation/ambient");
    let clusters: Vec<f64> = diagram["clusters"].as_array().unwrap().iter().map(hz).collect();
    assert_eq!(clusters.len(), 3, "{clusters:?}");
    for (found, right) in clusters.iter().zip([2.516, 6.315, 8.968]) {
        assert!((found / right - 1.0).abs() < 0.005, "{found} {right}");
    }
    assert!(says(&found, "7.297 Hz is a harmonic line"), "{found}");
    let others = topic(&found, "/modes/n4sid-8")["other_poles"].clone();
    let lines: Vec<&Value> = others.as_array().unwrap().iter().filter(|pole| pole["kind"] == "harmonic").collect();
    assert_eq!(lines.len(), 2, "{others}");
}
