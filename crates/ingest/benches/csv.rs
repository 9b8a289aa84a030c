//! Time of reading two-column CSV text, beside a plain memory pass over the same bytes: the table alone (numbers, time
//! grid, SI), the digest alone, and the whole of ingest (both, and the checks of quality).

use std::fmt::Write;

use crumple_ingest::{Bundle, IngestSettings, ingest};
use crumple_testkit::benchmark::{best_ms, print_line};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for rows in [10_000, 1_000_000, 10_000_000] {
        let mut text = String::from("# mass: 873 kg\n# impact speed: 35 km/h\ntime_s,accel_g\n");
        for k in 0..rows {
            let t = f64::from(k) * 1e-5;
            writeln!(text, "{t:.5},{:.6}", -20.0 * (30.0 * t).sin())?;
        }
        let bytes = text.as_bytes();
        let mut copy = bytes.to_vec();
        let pass_ms = best_ms(|| {
            copy.copy_from_slice(std::hint::black_box(bytes));
            copy[bytes.len() / 2]
        });
        // In memory, as `Bundle::open` leaves a file of up to 64 MiB.
        let bundle = Bundle::from_bytes("crash.csv", bytes.to_vec())?;
        let settings = IngestSettings::default();
        ingest(&bundle, &settings)?;
        let mb = bytes.len() as f64 / 1e6;
        let line = |what: &str, ms: f64| {
            print_line(&format!("csv, {rows} rows, {what}: {:.0} MB/s", 1e3 * mb / ms), ms, pass_ms);
        };
        line("table", best_ms(|| bundle.read(&settings).map(|found| found.channels.len())));
        line("digest", best_ms(|| bundle.digest()));
        line("ingest", best_ms(|| ingest(&bundle, &settings).map(|found| found.waves.len())));
    }
    Ok(())
}
