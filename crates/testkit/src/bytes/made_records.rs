//! Records made for the cases: two sensors, a test with occupants and barrier cells, a process that is no crash.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::Path;

use crumple_lumped::{DoubleSpringMassDamper, Model};
use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;

use crate::random::uniform;

const DT_S: f64 = 1e-4;
const BEFORE: usize = 500;
const AFTER: usize = 2001;

/// Writes all of them below `folder`.
pub fn write_records(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    fs::write(folder.join("two-sensors.csv"), two_sensors()?)?;
    fs::write(folder.join("two-sensors.csv.toml"), "channel = \"accel\"\n")?;
    fs::write(folder.join("process.csv"), process())?;
    occupants(&folder.join("occupants"))
}

fn number(text: &mut String, value: f64) {
    let _infallible = write!(text, ",{value:.9}");
}

/// Compartment and engine (channel 95) of a double model.
fn two_sensors() -> io::Result<String> {
    let model = Model::DoubleSpringMassDamper(DoubleSpringMassDamper {
        m1_kg: 375.0,
        m2_kg: 1125.0,
        k1_n_per_m: 900_000.0,
        k2_n_per_m: 1_000_000.0,
        c1_n_s_per_m: 6_000.0,
        c2_n_s_per_m: 9_000.0,
    });
    let response = model.respond(50.0 / 3.6, DT_S, AFTER).map_err(io::Error::other)?;
    let mut csv =
        "# title: two sensors\n# mass: 1500 kg\n# impact speed: 50 km/h\ntime (s),accel (g),95 (g)\n".to_owned();
    for k in 0..BEFORE + AFTER {
        let _infallible = write!(csv, "{:.4}", (k as f64 - BEFORE as f64) * DT_S);
        for motion in [response.compartment(), &response.motions[0]] {
            let a = k.checked_sub(BEFORE).map_or(0.0, |k| motion.acceleration_m_per_s2[k] / G);
            number(&mut csv, a + 0.05 * uniform(k as u64));
        }
        csv.push('\n');
    }
    Ok(csv)
}

/// `y` answers to `p` and `q` by a pair of poles, `z` to both of them a step later.
fn process() -> String {
    let mut csv = "p,q,y,z\n".to_owned();
    let (mut y1, mut y2, mut before) = (0.3, -0.1, (0.0, 0.0));
    for k in 0..400_u64 {
        let y = 1.5 * y1 - 0.7 * y2 + 0.5 * before.0 - 0.2 * before.1;
        let z = 0.4 * y1 + 0.3 * before.1 + 0.05 * uniform(3 * k);
        before = (5.0 * uniform(3 * k + 1), 6.0 * uniform(3 * k + 2));
        let _infallible = writeln!(csv, "{:.9},{:.9},{:.9},{z:.9}", before.0, before.1, y + 0.02 * uniform(7 * k));
        (y2, y1) = (y1, y);
    }
    csv
}

/// An ISO-MME test: structure, engine, two occupants, cells of the barrier, yaw rate.
fn occupants(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder.join("Channel"))?;
    let test = "Data format edition number  :1.6\r\nTitle                       :occupants\r\nMass test object \
        1          :1500 kg\r\n\
                Velocity test object 1      :14 m/s\r\n";
    fs::write(folder.join("T1.mme"), test)?;
    let force = -1500.0 * G / 4.0;
    let channels = [
        ("10SECMLERE00ACXP", "g", 1.0),
        ("10SECMRIRE00ACXP", "g", 0.98),
        ("10SILBLERE00ACXP", "g", 1.02),
        ("10ENGN000000ACXP", "g", 1.6),
        ("10VEHCCG0000ACXP", "g", 1.0),
        ("10VEHCCG0000ACYP", "g", 0.2),
        ("10VEHCCG0000AVZP", "deg/s", 3.0),
        ("11HEAD0000H3ACXA", "g", 1.4),
        ("11HEAD0000H3ACYA", "g", 0.3),
        ("11HEAD0000H3ACZA", "g", 0.7),
        ("11CHST0000H3ACXC", "g", 1.2),
        ("13HEAD0000H3ACXA", "g", 1.1),
        ("B0LOMA010100FOXP", "N", force),
        ("B0LOMA010200FOXP", "N", force),
        ("B0LOMA020100FOXP", "N", force),
        ("B0LOMA020200FOXP", "N", force),
    ];
    for (place, (code, unit, factor)) in channels.iter().enumerate() {
        let mut text = format!(
            "Test object number          :1\r\nChannel code                :{code}\r\nUnit                        \
             :{unit}\r\n\
             Reference channel           :implicit\r\nSampling interval           :0.0001\r\n\
             Time of first sample        :-0.05\r\nNumber of samples           :2501\r\n"
        );
        for k in 0..2501 {
            let t = (k as f64 - BEFORE as f64) * DT_S;
            let pulse = if (0.0..0.1).contains(&t) { -25.0 * (PI * t / 0.1).sin() } else { 0.0 };
            let noise = 0.1 * uniform((place * 10_007 + k) as u64);
            let _infallible = write!(text, "{:.6}\r\n", factor * (pulse + noise));
        }
        fs::write(folder.join(format!("Channel/T1.{:03}", place + 1)), text)?;
    }
    Ok(())
}
