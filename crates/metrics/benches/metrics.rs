//! HIC and ISO 18571 beside a plain pass over the same samples. Release, one thread: `cargo bench -p crumple-metrics`.
//! `--test` or a first argument of `quick` runs the small sizes once; `-- --long` rates curves of 10⁶ samples too (half
//! a minute or more), `-- --largest` nothing but curves of 10⁷ (an hour, 2 GB).

use std::hint::black_box;

use crumple_metrics::{HIC15_WINDOW_S, Iso18571Options, hic, hic_all_pairs, iso18571};
use crumple_signal::{Acceleration, Sampled, Signal};
use crumple_testkit::benchmark::{Figure, best_s, memory_pass_s};

/// A head resultant at 10 kHz: pulses of different height and length every half second, and noise.
fn resultant(n: usize) -> Vec<f64> {
    let mut state = 7_u64;
    (0..n)
        .map(|k| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let noise = (state >> 11) as f64 / (1_u64 << 53) as f64;
            let (event, within) = (k / 5000, (k % 5000) as f64);
            let (height, width) = (400.0 + 30.0 * (event % 13) as f64, 120.0 + 25.0 * (event % 7) as f64);
            let u = (within - 1000.0) / width;
            let pulse = if (0.0..=1.0).contains(&u) { height * (std::f64::consts::PI * u).sin() } else { 0.0 };
            (pulse + 20.0 * noise).abs()
        })
        .collect()
}

/// The high-water mark of resident memory, where the system tells it.
fn peak_memory() -> Option<String> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    Some(status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().to_owned())
}

fn figure<T>(what: &str, samples: &[f64], work: impl FnMut() -> T) -> Figure {
    Figure::new(format!("{what}, {} samples", samples.len()), best_s(work), memory_pass_s(samples))
}

fn main() {
    let quick = std::env::args().any(|argument| argument == "--test" || argument == "quick");
    let long = std::env::args().any(|argument| argument == "--long");
    let largest = std::env::args().any(|argument| argument == "--largest");
    let sizes: &[usize] = match () {
        () if largest => &[10_000_000],
        () if long => &[1_000, 10_000, 100_000, 1_000_000],
        () if quick => &[1_000],
        () => &[1_000, 10_000, 100_000],
    };
    for &n in sizes {
        let at = |k: usize, late: f64, height: f64| {
            let u = (k as f64 / n as f64 - 0.1 - late) / 0.7;
            if (0.0..=1.0).contains(&u) {
                height * ((std::f64::consts::PI * u).sin() + 0.3 * (25.0 * u).sin())
            } else {
                0.0
            }
        };
        let curve = |late, height| Sampled::new(0.0, 1e-4, (0..n).map(|k| at(k, late, height)).collect());
        let (Ok(test), Ok(model)) = (curve(0.0, 25.0), curve(0.03, 23.0)) else { return };
        let options = Iso18571Options::default();
        let rated =
            figure("ISO/TS 18571, alike", test.samples(), || iso18571(black_box(&test), black_box(&model), &options));
        if n == 10_000 { rated.aim(0.1, "Python package 24 s") } else { rated }.print();
        // Nothing in noise aligns: hardly a cell of the warping band can be left out.
        let noise = Sampled::new(0.0, 1e-4, resultant(n).iter().map(|a| (a * 7919.0) % 50.0 - 25.0).collect());
        let Ok(noise) = noise else { return };
        if n <= 100_000 {
            let work = || iso18571(&test, black_box(&noise), &options);
            figure("ISO/TS 18571, noise (worst)", test.samples(), work).print();
        }
        if let Some(peak) = peak_memory() {
            println!("    peak memory of the process so far: {peak}");
        }
    }
    if largest {
        return;
    }
    for n in [10_000, 1_000_000, 10_000_000] {
        if quick && n > 10_000 {
            break;
        }
        let samples = resultant(n);
        let signal = match Sampled::new(0.0, 1e-4, samples) {
            Ok(signal) => Signal::<Acceleration>::from(signal),
            Err(error) => {
                eprintln!("error: {error}");
                return;
            }
        };
        let pruned = figure("HIC15", signal.samples(), || hic(black_box(&signal), HIC15_WINDOW_S));
        if n == 10_000 { pruned.aim(0.3e-3, "numpy 1.1 ms") } else { pruned }.print();
        if n <= 1_000_000 {
            figure("HIC15, all pairs", signal.samples(), || hic_all_pairs(black_box(&signal), HIC15_WINDOW_S)).print();
        }
    }
    // Many windows that are nearly equal.
    let plateau = Signal::new(0.0, 1e-4, (0..10_000).map(|k| 600.0 + 1e-5 * f64::from(k % 7)).collect());
    if let Ok(plateau) = plateau {
        let worst = || hic(black_box(&plateau), HIC15_WINDOW_S);
        figure("HIC15, plateau (worst)", plateau.samples(), worst).aim(0.3e-3, "").print();
    }
}
