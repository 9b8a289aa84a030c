//! Writes an artifact as ingest would, with one channel of as many samples as asked for, to measure memory and time:
//! `cargo run --release -p crumple-artifact --example big_record -- 100000000 1-ingest.mcap`.

use std::path::Path;

use crumple_artifact::records::TestV1;
use crumple_artifact::{ArtifactBuilder, Compression, Provenance};
use crumple_signal::{Channel, QuantityKind, Sampled, TestDescription};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(count), Some(path)) = (arguments.next(), arguments.next()) else {
        return Err("usage: big_record <samples> <file>".into());
    };
    let count: u32 = count.parse()?;
    let test = TestDescription {
        title: format!("{count} samples"),
        impact_speed_m_per_s: Some(15.0),
        mass_kg: Some(1500.0),
        channels: vec![Channel::new("accel", QuantityKind::Acceleration)],
        ..TestDescription::default()
    };
    // 1 MHz, a half-sine pulse of 100 ms after 100 ms of rest, then vibration.
    let samples = (0..count).map(|k| {
        let t = f64::from(k) * 1e-6 - 0.1;
        let pulse = if (0.0..0.1).contains(&t) { -260.0 * (std::f64::consts::PI * t / 0.1).sin() } else { 0.0 };
        pulse + 0.5 * (2.0 * std::f64::consts::PI * 37.0 * t).sin()
    });
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &TestV1::from(&test))?;
    builder.wave("accel", QuantityKind::Acceleration, Sampled::new(-0.1, 1e-6, samples.collect())?)?;
    builder.write(Path::new(&path), &Provenance::new("ingest", "0", "{}".to_owned(), vec![]), Compression::None)?;
    Ok(())
}
