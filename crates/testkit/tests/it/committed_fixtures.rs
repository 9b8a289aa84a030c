//! The committed fixtures are what the generator makes.

use serde_json::Value;

/// Another platform's `exp`, `sin` and `cos` may differ in the last digit; the double model multiplies that by 2000
/// steps at most.
const RELATIVE: f64 = 1e-12;

fn close(found: f64, wanted: f64, scale: f64) -> bool {
    (found - wanted).abs() <= RELATIVE * scale.max(wanted.abs())
}

fn same(found: &Value, wanted: &Value, path: &str) {
    match (found, wanted) {
        (Value::Number(a), Value::Number(b)) => {
            // A checkpoint value near a zero crossing is compared on the scale of ordinary motion.
            assert!(close(a.as_f64().unwrap(), b.as_f64().unwrap(), 1e-2), "{path}: {a} {b}");
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{path}");
            for (k, (a, b)) in a.iter().zip(b).enumerate() {
                same(a, b, &format!("{path}[{k}]"));
            }
        }
        (Value::Object(a), Value::Object(b)) => {
            assert!(a.keys().eq(b.keys()), "{path}");
            for (key, a) in a {
                same(a, &b[key], &format!("{path}.{key}"));
            }
        }
        _ => assert_eq!(found, wanted, "{path}"),
    }
}

#[test]
fn committed_files_are_the_generators() {
    for fixture in crumple_testkit::fixture::fixtures().unwrap() {
        let folder = crumple_testkit::workspace().join("fixtures").join(fixture.name);
        let csv = std::fs::read_to_string(folder.join("crash.csv")).unwrap();
        let truth: Value = serde_json::from_str(&std::fs::read_to_string(folder.join("truth.json")).unwrap()).unwrap();
        same(&truth, &fixture.truth, fixture.name);
        assert_eq!(csv.lines().count(), fixture.csv.lines().count());
        for (line, (found, wanted)) in csv.lines().zip(fixture.csv.lines()).enumerate() {
            let numbers = |text: &str| text.split_once(',').and_then(|(t, a)| Some((t.parse().ok()?, a.parse().ok()?)));
            match (numbers(found), numbers(wanted)) {
                (Some((t, a)), Some((u, b))) => {
                    let _: (f64, f64) = (t, a);
                    // Rounding is that of the largest terms, some 30 g, also where the acceleration passes through
                    // zero.
                    assert!(t == u && close(a, b, 1.0), "{} line {}: {found} {wanted}", fixture.name, line + 1);
                }
                _ => assert_eq!(found, wanted, "{} line {}", fixture.name, line + 1),
            }
        }
    }
}

#[test]
fn records_are_quiet_before_contact_and_negative_after() {
    for fixture in crumple_testkit::fixture::fixtures().unwrap() {
        let samples: Vec<(f64, f64)> = fixture
            .csv
            .lines()
            .filter_map(|line| line.split_once(','))
            .filter_map(|(t, a)| Some((t.parse().ok()?, a.parse().ok()?)))
            .collect();
        assert_eq!(samples.len(), 2501);
        assert_eq!((samples[0].0, samples[500].0, samples[2500].0), (-0.05, 0.0, 0.2));
        let quiet = samples[..500].iter().all(|(_, a)| *a == 0.0);
        assert_eq!(quiet, fixture.name != "noisy");
        // SAE J211: a frontal pulse decelerates.
        assert!(samples[500..1000].iter().map(|(_, a)| a).sum::<f64>() < 0.0);
    }
}
