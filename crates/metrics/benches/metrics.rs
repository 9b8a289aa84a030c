//! HIC and ISO 18571 beside a plain pass over the same samples. Release, one thread: `cargo bench -p crumple-metrics`.
//! `--test` or a first argument of `quick` runs the small sizes once; `-- --long` rates curves of 10⁶ samples too (half
//! a minute or more), `-- --largest` nothing but curves of 10⁷ (an hour, 2 GB).

use std::hint::black_box;
use std::time::Instant;

use crumple_metrics::{HIC15_WINDOW_S, Iso18571Options, hic, hic_all_pairs, iso18571};
use crumple_signal::{Acceleration, Sampled, Signal};

/// Least of several runs, s.
fn least<T>(runs: usize, mut f: impl FnMut() -> T) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..runs {
        let start = Instant::now();
        black_box(f());
        best = best.min(start.elapsed().as_secs_f64());
    }
    best
}

/// Time to read every sample once.
fn memory_pass(x: &[f64]) -> f64 {
    let sum = |x: &[f64]| {
        let (chunks, rest) = x.as_chunks::<8>();
        let mut lanes = [0.0; 8];
        for chunk in chunks {
            lanes.iter_mut().zip(chunk).for_each(|(lane, x)| *lane += x);
        }
        lanes.iter().sum::<f64>() + rest.iter().sum::<f64>()
    };
    least(5, || sum(black_box(x)))
}

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

fn report(what: &str, n: usize, seconds: f64, pass: f64) {
    println!(
        "{what:<34} {n:>9} samples {:>12.4} ms, memory pass {:>9.4} ms, ratio {:>10.1}",
        1e3 * seconds,
        1e3 * pass,
        seconds / pass
    );
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
        let pass = memory_pass(test.samples());
        let options = Iso18571Options::default();
        let runs = if n > 10_000 { 1 } else { 5 };
        report("ISO 18571, alike", n, least(runs, || iso18571(black_box(&test), black_box(&model), &options)), pass);
        // Nothing in noise aligns: hardly a cell of the warping band can be left out.
        let noise = Sampled::new(0.0, 1e-4, resultant(n).iter().map(|a| (a * 7919.0) % 50.0 - 25.0).collect());
        let Ok(noise) = noise else { return };
        if n <= 100_000 {
            report(
                "ISO 18571, noise (worst)",
                n,
                least(runs, || iso18571(black_box(&test), black_box(&noise), &options)),
                pass,
            );
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
        let pass = memory_pass(&samples);
        let signal: Signal<Acceleration> = match Sampled::new(0.0, 1e-4, samples) {
            Ok(signal) => signal.into(),
            Err(error) => {
                eprintln!("error: {error}");
                return;
            }
        };
        let runs = if n > 1_000_000 { 3 } else { 20 };
        report("HIC15, pruned", n, least(runs, || hic(black_box(&signal), HIC15_WINDOW_S)), pass);
        if n <= 1_000_000 {
            report("HIC15, all pairs", n, least(3, || hic_all_pairs(black_box(&signal), HIC15_WINDOW_S)), pass);
        }
    }
    // Many windows that are nearly equal.
    let plateau = Signal::new(0.0, 1e-4, (0..10_000).map(|k| 600.0 + 1e-5 * f64::from(k % 7)).collect());
    if let Ok(plateau) = plateau {
        let pass = memory_pass(plateau.samples());
        report("HIC15, pruned, plateau (worst)", 10_000, least(20, || hic(black_box(&plateau), HIC15_WINDOW_S)), pass);
    }
}
