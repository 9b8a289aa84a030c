//! The program on the artifacts of a synthetic run.

use crate::sample;
use std::path::Path;
use std::process::{Command, Output};

fn report(folder: &Path, inputs: &[std::path::PathBuf], more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crumple-report"))
        .args(inputs)
        .arg("-o")
        .arg(folder.join("report.html"))
        .args(more)
        .output()
        .unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn the_summary_holds_the_run_in_the_order_of_the_contract() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), true);
    let output = report(folder.path(), &inputs, &["--pipeline-name", "papers/synthetic", "-q", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
    let summary = std::fs::read_to_string(folder.path().join("summary.json")).unwrap();
    assert_eq!(String::from_utf8(output.stdout).unwrap(), summary);
    // Every number of the sample is a literal or a short closed form; the last digits of sin and exp may differ between
    // mathematics libraries, so the numbers are shown with ten digits.
    insta::assert_snapshot!(ten_digits(&summary));
}

/// The text with every long number cut to ten significant digits.
fn ten_digits(json: &str) -> String {
    json.lines()
        .map(|line| {
            let start = line.rfind(' ').map_or(0, |blank| blank + 1);
            let number = line[start..].trim_end_matches(',');
            match number.parse::<f64>() {
                Ok(x) if number.len() > 11 => {
                    let cut: f64 = format!("{x:.9e}").parse().unwrap();
                    format!("{}{cut}{}\n", &line[..start], &line[start + number.len()..])
                }
                _ => format!("{line}\n"),
            }
        })
        .collect()
}

#[test]
fn the_order_is_that_of_the_choice_and_a_dual_stands_behind_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), true);
    report(folder.path(), &inputs, &[]);
    let text = std::fs::read_to_string(folder.path().join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    let double = ["double-spring-mass-damper/displacement-fit/1", "double-spring-mass-damper/displacement-fit/2"];
    assert_eq!(summary["ranking"].as_array().unwrap()[..2], double);
    // It fits better than the double, but has a negative damping.
    assert_eq!(summary["ranking"][2], "kelvin/coefficient-matching/1");
    assert_eq!((&summary["best"], &summary["recommended"]), (&double[0].into(), &double[0].into()));
    assert_eq!(summary["candidates"][5]["simulation"], serde_json::Value::Null);
}

#[test]
fn inputs_in_any_order_give_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let mut inputs = sample::write_artifacts(folder.path(), true);
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    report(folder.path(), &inputs, &[]);
    let first = (read("report.html"), read("summary.json"));
    inputs.reverse();
    report(folder.path(), &inputs, &[]);
    assert!(first == (read("report.html"), read("summary.json")));
}

#[test]
fn the_page_carries_the_summary_to_the_last_byte() {
    use base64::Engine;
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), true);
    report(folder.path(), &inputs, &[]);
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    let packed = page.split("id=\"summary-data\">").nth(1).unwrap().split('<').next().unwrap();
    let bytes = base64::engine::general_purpose::STANDARD.decode(packed).unwrap();
    let mut text = String::new();
    std::io::Read::read_to_string(&mut flate2::read::GzDecoder::new(&bytes[..]), &mut text).unwrap();
    assert_eq!(text, std::fs::read_to_string(folder.path().join("summary.json")).unwrap());
}

#[test]
fn the_page_loads_nothing_and_the_test_cannot_break_it() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), true);
    report(folder.path(), &inputs, &[]);
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    // The name of the vector graphics' vocabulary is an address that nobody opens; links within the page load nothing.
    let without_name = page.replace("http://www.w3.org/2000/svg", "").replace(" href=\"#", " within=\"#");
    for reference in ["http:", "https:", "//cdn", "<link", " src=", " href=", "@import", "url("] {
        assert!(!without_name.contains(reference), "{reference}");
    }
    assert!(page.contains("default-src 'none'"));
    assert!(!page.contains("<script>window.broken"), "the title has opened a script");
    assert!(page.contains("Frontal &lt;b&gt;impact&lt;/b&gt; &amp; &quot;pole&quot;"));
    assert!(!page.contains("sled <1>") && page.contains("sled &lt;1&gt;"));
    // As many scripts are closed as opened: summary, figures, what if and its data.
    assert_eq!((page.matches("<script").count(), page.matches("</script>").count()), (4, 4));
    assert!(page.len() < 600_000, "{}", page.len());
}

#[test]
fn evidence_of_the_models_is_drawn_with_its_settings() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), true);
    report(folder.path(), &inputs, &[]);
    let html = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    for text in [
        "Band of era-2: bootstrap of 200 replicates, 5 to 95 %.",
        "stable is a frequency within 1 %, a damping ratio within 5 %.",
        "damping ratio above 2.0, above 95 % of the Nyquist",
        "Marked: modes present in 50 % of the orders or more (1).",
        "1 zero lies farther out than these poles.",
        "to a unit sample, from rest.",
    ] {
        assert!(html.contains(text), "{text}");
    }
    // The magnitude and the phase have a band each, which ends where it is not determined.
    assert_eq!(html.matches("<path class=\"b s0 e0\"").count(), 2);
}

#[test]
fn every_figure_is_written_as_a_file_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), true);
    let svgs = folder.path().join("pictures/of the run");
    let output = report(folder.path(), &inputs, &["-q", "--svg", svgs.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let mut names: Vec<String> =
        std::fs::read_dir(&svgs).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(
        names,
        [
            "bode.svg",
            "curves.svg",
            "mass-split.svg",
            "poles.svg",
            "residual.svg",
            "responses.svg",
            "singular-values.svg",
            "stabilisation.svg"
        ]
    );
    let curves = std::fs::read_to_string(svgs.join("curves.svg")).unwrap();
    assert!(curves.starts_with("<svg xmlns=") && curves.ends_with("</svg>\n"));
    for part in
        ["acceleration, g", "velocity, km/h", "displacement, mm", "force, kN", "tₘ = 77.2\u{a0}ms", "C = 447.7\u{a0}mm"]
    {
        assert!(curves.contains(part), "{part}");
    }
}

#[test]
fn a_hundred_channels_and_more_are_folded() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), true);
    report(folder.path(), &inputs, &[]);
    let html = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(html.contains("<details><summary>Show all 31 channels</summary>"));
    assert!(html.contains("The test lists 31 channels in all: 30 valid, 1 not installed."));
    // On paper a list of hundreds has those with data alone, and says so.
    assert_eq!(html.matches("<tr class=\"no-paper\">").count(), 1);
    assert!(html.contains("<p class=\"on-paper\">Left out on paper, for want of valid data: 1.</p>"));
}

#[test]
fn what_is_missing_is_said_and_the_rest_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), true);
    let output = report(folder.path(), &inputs[1..3], &[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let said = stderr(&output).replace('\u{a0}', " ");
    assert!(
        said.starts_with("usable with care: use what was measured: no model was fitted.\nThe dynamic crush was 448 mm"),
        "{said}"
    );
    for what in [
        "It holds no models: their stages did not run.",
        "not in it",
        "acceleration as read (ingest writes it)",
        "identified models (identify writes them)",
        "physical parameters (parameter-solve writes them)",
        "report.html",
    ] {
        assert!(said.contains(what), "{what} in {said}");
    }
    let html = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(html.contains("<h2>Not in this report</h2>"));
    assert!(html.contains("id=\"curves-3\"") && !html.contains("id=\"poles\"") && !html.contains("id=\"residual\""));
}

#[test]
fn each_artifact_alone_makes_a_report() {
    let folder = tempfile::tempdir().unwrap();
    for input in sample::write_artifacts(folder.path(), true) {
        let output = report(folder.path(), std::slice::from_ref(&input), &["-q"]);
        assert_eq!(output.status.code(), Some(0), "{}: {}", input.display(), stderr(&output));
    }
}

#[test]
fn candidates_of_which_none_could_be_simulated_end_with_4_and_both_files() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), false);
    let output = report(folder.path(), &inputs, &["-q"]);
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    let summary = std::fs::read_to_string(folder.path().join("summary.json")).unwrap();
    assert!(summary.contains("\"best\": null"));
    assert!(folder.path().join("report.html").exists());
}

#[test]
fn a_damaged_artifact_is_refused_and_an_old_report_stays() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), true);
    report(folder.path(), &inputs, &[]);
    let before = std::fs::read(folder.path().join("report.html")).unwrap();
    let mut bytes = std::fs::read(&inputs[2]).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&inputs[2], bytes).unwrap();
    let output = report(folder.path(), &inputs, &[]);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    assert!(std::fs::read(folder.path().join("report.html")).unwrap() == before);
}

#[test]
fn a_pipeline_that_is_not_there_is_a_usage_error() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = sample::write_artifacts(folder.path(), true);
    let output = report(folder.path(), &inputs, &["--pipeline", "pipelines/no-such.toml"]);
    assert_eq!(output.status.code(), Some(2));
    insta::assert_snapshot!(stderr(&output), @r"
    error: cannot read the pipeline file pipelines/no-such.toml: No such file or directory (os error 2)
      hint: there are: default, unfiltered, two-sensors, papers/civic, papers/era, papers/firefly
    ");
}
