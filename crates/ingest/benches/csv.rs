//! Reading a two-column table, beside a plain pass over the same bytes: `cargo bench -p crumple-ingest`.
//!
//! Best of several runs, one thread, text in memory. The pass adds up all bytes as 64-bit words.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed measurement")]

use std::hint::black_box;
use std::time::{Duration, Instant};

use crumple_ingest::{Bundle, Settings, ingest};

fn text(rows: usize) -> Vec<u8> {
    let mut text = "# mass: 1500 kg\n# impact speed: 50 km/h\ntime_s,accel_g\n".to_owned();
    for k in 0..rows {
        let t = k as f64 * 1e-5 - 0.05;
        text.push_str(&format!("{t:.5},{:.3}\n", -20.0 * (t * 31.0).sin()));
    }
    text.into_bytes()
}

fn best(runs: usize, mut work: impl FnMut()) -> Duration {
    (0..runs)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed()
        })
        .min()
        .unwrap()
}

fn main() {
    println!("{:>10}  {:>9}  {:>10}  {:>9}  {:>10}", "rows", "text MB", "read ms", "MB/s", "pass ms");
    for (rows, runs) in [(10_000, 50), (1_000_000, 7), (10_000_000, 3)] {
        let bytes = text(rows);
        let megabytes = bytes.len() as f64 / 1e6;
        let settings = Settings::default();
        let bundle = Bundle::from_bytes("a.csv", bytes).unwrap();
        let read = best(runs, || {
            black_box(ingest(&bundle, &settings).unwrap());
        });
        let pass = best(runs, || {
            let words = bundle.main.bytes.chunks_exact(8).map(|w| u64::from_le_bytes(w.try_into().unwrap()));
            black_box(words.fold(0_u64, u64::wrapping_add));
        });
        println!(
            "{rows:>10}  {megabytes:>9.2}  {:>10.3}  {:>9.0}  {:>10.3}",
            read.as_secs_f64() * 1e3,
            megabytes / read.as_secs_f64(),
            pass.as_secs_f64() * 1e3
        );
    }
}
