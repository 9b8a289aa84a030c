//! Time of reading two-column CSV text, beside a plain memory pass over the same bytes: the table alone (numbers, time
//! grid, SI), the digest alone, and the whole of ingest (both, and the checks of quality).

use std::fmt::Write;

use crumple_ingest::{Bundle, IngestSettings, ingest};
use crumple_testkit::benchmark::{Figure, best_s, memory_pass_s};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for rows in [10_000, 1_000_000, 10_000_000] {
        let mut text = String::from("# mass: 873 kg\n# impact speed: 35 km/h\ntime_s,accel_g\n");
        for k in 0..rows {
            let t = f64::from(k) * 1e-5;
            writeln!(text, "{t:.5},{:.6}", -20.0 * (30.0 * t).sin())?;
        }
        let bytes = text.as_bytes();
        let pass_s = memory_pass_s(bytes);
        // In memory, as `Bundle::open` leaves a file of up to 64 MiB.
        let bundle = Bundle::from_bytes("crash.csv", bytes.to_vec())?;
        let settings = IngestSettings::default();
        ingest(&bundle, &settings)?;
        let mb = bytes.len() as f64 / 1e6;
        let line = |what: &str, s: f64| {
            println!("{:.0} MB/s:", mb / s);
            let figure = Figure::new(format!("CSV, {rows} rows, {what}"), s, pass_s);
            if (rows, what) == (1_000_000, "table") { figure.aim(50e-3, "pandas 70 ms") } else { figure }.print();
        };
        line("table", best_s(|| bundle.read(&settings).map(|found| found.channels.len())));
        line("digest", best_s(|| bundle.digest()));
        line("ingest", best_s(|| ingest(&bundle, &settings).map(|found| found.waves.len())));
    }
    Ok(())
}
