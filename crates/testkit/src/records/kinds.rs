//! A record of every kind that people bring, for what must hold of all of them.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::{fs, io};

use crate::places::{shared, workspace};
use crate::records::known_truth::TwoVehicles;

/// A record and how it is run.
#[derive(Debug, Clone)]
pub struct KindOfRecord {
    /// What it is of.
    pub name: &'static str,
    /// The record.
    pub path: PathBuf,
    /// Variables of `just`.
    pub variables: &'static [&'static str],
    /// Flags of ingest.
    pub flags: &'static [&'static str],
}

/// A title that commands a terminal and a browser.
const HOSTILE_TITLE: &str = "</script><script>alert(1)</script><img src=x onerror=alert(2)>&\u{1b}[2J\u{202e}%s";

/// The table of an event data recorder: 41 km/h lost in 120 ms, in whole km/h.
pub(crate) fn recorder() -> String {
    let velocity = |k: i32| -41.0 * (1.0 - (PI * f64::from(k.min(12)) / 12.0).cos()) / 2.0;
    let rows: String = (0..=25).map(|k| format!("{},{:.0}\n", 10 * k, velocity(k))).collect();
    format!("Time (msec),\"Delta-V, longitudinal (km/h)\"\n{rows}")
}

/// The fixtures, and made records of other kinds, written to a folder.
pub fn made_kinds(folder: &Path) -> io::Result<Vec<KindOfRecord>> {
    let fixture = |name: &'static str| KindOfRecord {
        name,
        path: workspace().join("fixtures").join(name).join("crash.csv"),
        variables: &[],
        flags: &[],
    };
    let mut kinds: Vec<KindOfRecord> = ["double", "elastoplastic", "kelvin", "noisy"].map(fixture).into();
    let mut add = |name: &'static str, file: &str, text: &str, flags: &'static [&'static str]| -> io::Result<()> {
        let path = folder.join(file);
        fs::write(&path, text)?;
        kinds.push(KindOfRecord { name, path, variables: &[], flags });
        Ok(())
    };
    for (name, content) in TwoVehicles::STANDING.files() {
        fs::write(folder.join(name), content)?;
    }
    let table = |head: &str, values: &dyn Fn(f64) -> f64| {
        let rows = (0..2000).map(|k| f64::from(k) * 1e-4).map(|t| format!("{t:.4},{:.6}\n", values(t)));
        format!("{head}{}", rows.collect::<String>())
    };
    let pulse = |t: f64| if t < 0.09 { -25.0 * (PI * t / 0.09).sin() } else { 0.0 };
    let states = ["--mass", "900kg", "--impact-speed", "50km/h"].as_slice();
    add("no impact speed", "no-speed.csv", &table("time [s],acceleration [g]\n", &pulse), &[])?;
    add("constant", "constant.csv", &table("time [s],acceleration [g]\n", &|_| 0.0), states)?;
    let hostile = format!("# title: {HOSTILE_TITLE}\n# mass: 900 kg\n# impact_speed: 50 km/h\ntime [s],a_<b>&x [g]\n");
    add("hostile texts", "hostile.csv", &table(&hostile, &pulse), &[])?;
    add(
        "recorder",
        "recorder.csv",
        &recorder(),
        &["--profile", "edr", "--mass", "1500kg", "--impact-speed", "45km/h"],
    )?;
    let two = KindOfRecord { name: "two vehicles", path: folder.join("v90001.EV5"), variables: &[], flags: &[] };
    kinds.push(two);
    Ok(kinds)
}

/// Records of real tests, those that lie at hand.
pub fn real_kinds() -> Vec<KindOfRecord> {
    const CAMRY: &str = "data/nhtsa-v10146-camry-frontal/v10146.EV5";
    type Row = (&'static str, &'static str, &'static [&'static str], &'static [&'static str]);
    let rows: [Row; 5] = [
        ("Camry", CAMRY, &[], &[]),
        ("Camry, two sensors", CAMRY, &["pipeline=two-sensors"], &[]),
        (
            "IIHS",
            "data/iihs-cep1705-accord/CEP1705_ACXD.csv",
            &[],
            &["--unit", "g", "--impact-speed", "64.4km/h", "--mass", "1600kg"],
        ),
        ("ISO-MME", "data/iso-mme-98_7707/98_7707.001", &[], &["--allow-missing"]),
        ("TDMS", "data/iihs-diadem-tdms/Target Pulse.tdms", &[], &["--mass", "1500kg", "--impact-speed", "10m/s"]),
    ];
    let there = rows.into_iter().filter_map(|(name, path, variables, flags)| {
        Some(KindOfRecord { name, path: shared(path)?, variables, flags })
    });
    there.collect()
}
