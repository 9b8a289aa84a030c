//! Made records with one fault each, and clean ones: what must be said is said, and nothing is said of a clean record.

use crumple_signal::{Channel, QuantityKind};
use crumple_testkit::identification::{chain, record};
use crumple_testkit::uniform;
use serde_json::json;

use crate::program::{Run, Wave, identify, made, written};

const DT_S: f64 = 0.01;

/// A system of two modes, 3.9 and 13.7 Hz, driven by uniform noise; `d`: what the noise of its output goes through.
const SYSTEM: [f64; 5] = [1.0, -2.6, 3.22, -2.254, 0.7644];

/// Waveforms by name.
type Signals = Vec<(&'static str, Vec<f64>)>;

fn with_noise(d: &[f64], sd: f64) -> Signals {
    let of = json!({"B": [0, 0.3, -0.2, 0.25, 0.1], "F": SYSTEM, "D": d, "N": 500, "sd": sd, "dt": DT_S,
                    "seed_u": 41, "seed_e": 42});
    let (mut u, mut y) = record(&of);
    vec![("u", u.swap_remove(0)), ("y", y.swap_remove(0))]
}

/// White noise of 10 % of the output.
fn clean() -> Signals {
    with_noise(&[1.0], 0.04)
}

fn deviation(y: &[f64]) -> f64 {
    (y.iter().map(|y| y * y).sum::<f64>() / y.len() as f64).sqrt()
}

/// The clean record with its output changed; `change` gets the number of a sample, its value and the deviation of all.
fn changed(change: impl Fn(usize, f64, f64) -> f64) -> Signals {
    let mut signals = clean();
    let size = deviation(&signals[1].1);
    signals[1].1.iter_mut().enumerate().for_each(|(k, y)| *y = change(k, *y, size));
    signals
}

/// The output of a system `b/a` from rest on the input of the clean record, and noise of 1 %.
fn answered(b: &[f64], a: &[f64]) -> Signals {
    let of = |sd: f64| -> serde_json::Value {
        json!({"B": b, "F": a, "N": 500, "sd": sd, "dt": DT_S, "input": "binary", "seed_u": 41, "seed_e": 42})
    };
    let size = 0.01 * deviation(&record(&of(0.0)).1[0]);
    let (mut u, mut y) = record(&of(size));
    vec![("u", u.swap_remove(0)), ("y", y.swap_remove(0))]
}

fn late(samples: usize) -> Signals {
    let mut signals = with_noise(&[1.0, -0.9], 0.02);
    let moved = std::iter::repeat_n(0.0, samples).chain(signals[1].1.iter().copied()).take(500).collect();
    signals[1].1 = moved;
    signals
}

fn and(mut signals: Signals, more: (&'static str, Vec<f64>)) -> Signals {
    signals.push(more);
    signals
}

/// With sums of twelve white samples, which no autoregression of six lags makes, as noise.
fn and_sums(mut signals: Signals) -> Signals {
    let size = 0.1 * deviation(&signals[1].1);
    let sum = |k: u64| (k..k + 12).map(|at| uniform(90_000 + at)).sum::<f64>() - 1.6 * uniform(90_000 + k);
    signals[1].1.iter_mut().zip(0..).for_each(|(y, k)| *y += size * sum(k));
    signals
}

/// Runs the program; `flags` are separated by blanks.
fn run(signals: &Signals, flags: &str) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let channels = signals.iter().map(|(id, _)| Channel::new(*id, QuantityKind::Voltage)).collect();
    let waves: Vec<Wave> = signals.iter().map(|(id, x)| (*id, QuantityKind::Voltage, x.clone())).collect();
    let input = written(&made(channels, 0.0, DT_S, &waves), folder.path(), "ingest");
    identify(&input, &folder.path().join("4.mcap"), &flags.split(' ').collect::<Vec<_>>())
}

const ALL: &str = "--methods=n4sid,moesp,cva,arx,okid,output-error,tfest --orders=4 --poles=4 --zeros=4 \
                   --hold=zero-order --inputs=u --outputs=y";
const AUTO: &str = "--methods=auto --validate-from=50% --inputs=u --outputs=y";
const TWO: &str = "--methods=n4sid,arx,output-error --orders=2 --inputs=u --outputs=y";

/// Record, flags, exit code, and words of the lines that must be said.
type Fault = (&'static str, Signals, String, i32, &'static [&'static str]);

fn all(more: &str) -> String {
    format!("{ALL} {more}").trim().to_owned()
}

/// Faults of channels.
fn faulty_channels() -> Vec<Fault> {
    let constant = |x: f64| vec![x; 500];
    let two_inputs = ALL.replace("=u ", "=u,v ");
    vec![
        (
            "constant input",
            and(clean(), ("v", constant(2.5))),
            two_inputs.clone(),
            0,
            &["without v, which is constant"],
        ),
        ("constant output", vec![clean().swap_remove(0), ("y", constant(2.5))], all(""), 3, &["output y is constant"]),
        (
            "constant inputs",
            vec![("u", constant(1.0)), ("v", constant(0.0)), clean().swap_remove(1)],
            two_inputs,
            3,
            &["input u, v is constant"],
        ),
        ("trend", changed(|k, y, size| y + 2.0 * size * k as f64 / 500.0), all(""), 0, &["--remove-trend"]),
        (
            "outlier",
            changed(|k, y, size| y + if k == 320 { 4.0 * size } else { 0.0 }),
            all(""),
            0,
            &["outliers in y", "3.200000 s"],
        ),
        (
            "outlier among unseen samples",
            changed(|k, y, size| y + if k == 401 { 4.0 * size } else { 0.0 }),
            AUTO.into(),
            0,
            &["outliers in y", "4.010000 s"],
        ),
        ("level", changed(|_, y, size| y + 20.0 * size), all(""), 0, &["the mean of y", "--remove-mean"]),
    ]
}

/// Faults of choices, and of what models say.
fn faulty_models() -> Vec<Fault> {
    let sine: Vec<f64> = (0..500).map(|k| (0.2 * f64::from(k)).sin()).collect();
    let cut = |signals: Signals, count: usize| -> Signals {
        signals.into_iter().map(|(id, x)| (id, x[..count].to_vec())).collect()
    };
    vec![
        (
            "delay beyond its range",
            late(5),
            "--methods=output-error --orders=4 --delay=auto=0-2 --inputs=u --outputs=y".into(),
            0,
            &["delay: 5 samples", "edge of the scan asked for, 0 to 2"],
        ),
        (
            "scan of arx",
            late(5),
            "--methods=arx --arx-scan=1-5,1-5,0-4 --inputs=u --outputs=y".into(),
            0,
            &["at the edge of the ranges", "delay"],
        ),
        (
            "unseen samples below zero",
            changed(|k, y, _| if k < 250 { y } else { -3.0 * y }),
            AUTO.into(),
            0,
            &["warning: n4sid-4: unseen samples", "validation -"],
        ),
        (
            "unseen samples far below",
            changed(|k, y, size| if k < 250 { y } else { y + 0.8 * size * (0.7 * k as f64).sin() }),
            AUTO.into(),
            0,
            &["warning: n4sid-4: unseen samples", "contradict"],
        ),
        (
            "errors of an autoregression",
            with_noise(&[1.0, -0.9], 0.02),
            all("--bootstrap=20"),
            0,
            &["errors        correlated"],
        ),
        ("errors of no model", and_sums(clean()), all("--bootstrap=20"), 0, &["neither noise model explains"]),
        ("integrator", answered(&[0.0, 0.01], &[1.0, -1.0]), TWO.replace("=2", "=1"), 0, &["an integrator"]),
        ("pole beyond Nyquist", answered(&[0.0, 0.5], &[1.0, 0.6]), TWO.replace("=2", "=1"), 0, &["beyond Nyquist"]),
        ("growing pair", answered(&[0.0, 0.01, 0.01], &[1.0, -1.97, 1.006]), TWO.into(), 0, &["grows", "unstable"]),
        ("few samples", cut(clean(), 9), all(""), 3, &["n4sid", "okid", "samples"]),
        (
            "unrelated output",
            vec![clean().swap_remove(0), ("y", late(0)[0].1.iter().rev().copied().collect())],
            AUTO.into(),
            0,
            &["below 29.3 %"],
        ),
        (
            "input of one frequency",
            vec![
                ("u", sine.clone()),
                ("y", sine.iter().enumerate().map(|(k, x)| x + 0.5 * (0.2 * k as f64).cos()).collect()),
            ],
            TWO.into(),
            0,
            &["excites"],
        ),
    ]
}

#[test]
fn a_fault_of_a_record_is_said() {
    let mut silent = Vec::new();
    for (name, signals, flags, code, words) in faulty_channels().into_iter().chain(faulty_models()) {
        let Run { code: ended, said } = run(&signals, &flags);
        let missing: Vec<&&str> = words.iter().filter(|word| !said.contains(**word)).collect();
        if ended != Some(code) || !missing.is_empty() {
            silent.push(format!("{name}: exit {ended:?}, without {missing:?}:\n{said}"));
        }
    }
    assert!(silent.is_empty(), "{}", silent.join("\n"));
}

#[test]
fn nothing_is_said_of_a_clean_record() {
    let storeys = json!({"masses": [25.0, 25.0, 25.0], "springs": [1e4, 1e4, 1e4], "damping": 0.02, "dt": DT_S,
        "N": 6000, "skip": 1000, "seed": 7, "noise": 0.1, "kind_of_noise": "deviation", "seed_e": 8});
    let ambient = ["y1", "y2", "y3"].into_iter().zip(chain(&storeys, false).1).collect();
    let delayed = |more: &str| format!("--methods=auto --inputs=u --outputs=y {more}");
    // Free motion: what the impulse of a record of one sample leaves.
    let struck = json!({"masses": [25.0, 25.0], "springs": [1e4, 1e4], "damping": 0.02, "dt": DT_S, "N": 500, "at": 0,
        "struck": 1, "pulse_samples": 1, "peak": 1.0, "noise": 0.01, "kind_of_noise": "largest", "seed_e": 9});
    let free = chain(&struck, true).1.into_iter().map(|y| ("y", y[1..].to_vec())).take(1).collect();
    let records: Vec<(&str, Signals, String)> = vec![
        ("white", clean(), ALL.into()),
        ("white, intervals", clean(), format!("{ALL} --bootstrap=30")),
        ("white, auto", clean(), AUTO.into()),
        ("AR 0.9", with_noise(&[1.0, -0.9], 0.02), ALL.replace("n4sid,moesp,cva,arx,okid,", "")),
        ("equation noise, auto", with_noise(&SYSTEM, 0.02), AUTO.into()),
        ("late", late(5), delayed("--delay=auto")),
        ("late, as given", late(5), delayed("--delay=5")),
        ("free motion", free, "--methods=era --channels=y --orders=4 --bootstrap=30".into()),
        ("ambient", ambient, "--methods=n4sid --orders=6 --inputs=none --outputs=y1,y2,y3".into()),
    ];
    let mut loud = Vec::new();
    for (name, signals, flags) in records {
        let Run { code, said } = run(&signals, &flags);
        if code != Some(0) || said.contains("warning") {
            loud.push(format!("{name}: exit {code:?}\n{said}"));
        }
    }
    assert!(loud.is_empty(), "{}", loud.join("\n"));
}
