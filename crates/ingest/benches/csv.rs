//! Time of reading two-column CSV text, beside a plain memory pass over the same bytes.

use std::fmt::Write;

use crumple_ingest::{Bundle, Settings, ingest};
use crumple_testkit::stopwatch::{best_ms, print_line};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    for rows in [10_000, 1_000_000] {
        let mut text = String::from("# mass: 873 kg\n# impact speed: 35 km/h\ntime_s,accel_g\n");
        for k in 0..rows {
            let t = f64::from(k) * 1e-5;
            writeln!(text, "{t:.5},{:.6}", -20.0 * (30.0 * t).sin())?;
        }
        let path = folder.path().join(format!("{rows}.csv"));
        std::fs::write(&path, &text)?;
        let bytes = text.as_bytes();
        let mut copy = bytes.to_vec();
        let pass_ms = best_ms(|| {
            copy.copy_from_slice(std::hint::black_box(bytes));
            copy[bytes.len() / 2]
        });
        let bundle = Bundle::open(&path)?;
        ingest(&bundle, &Settings::default())?;
        let ms = best_ms(|| ingest(&bundle, &Settings::default()).map(|found| found.waves.len()));
        let mb = bytes.len() as f64 / 1e6;
        print_line(&format!("csv, two columns, {rows} rows: {:.0} MB/s", 1e3 * mb / ms), ms, pass_ms);
    }
    Ok(())
}
