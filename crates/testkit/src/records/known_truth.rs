//! Records with known lumped parameters: what is in a folder of them, and how to make another one.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crumple_lumped::{DoubleSpringMassDamper, Elastoplastic, Kelvin, LumpedError, Maxwell, Model, Nonlinear1};
use crumple_signal::STANDARD_GRAVITY_M_PER_S2;
use serde_json::{Value, json};

use crate::places::shared;

/// Sampling of records made here.
const RATE_HZ: u32 = 10_000;
const BEFORE: usize = 200;
const AFTER: usize = 2501;

/// One record: a folder with `accel.csv` and `truth.json`.
#[derive(Debug, Clone)]
pub struct KnownTruth {
    /// Name of its folder.
    pub name: String,
    /// The folder.
    pub folder: PathBuf,
    /// Content of `truth.json`.
    pub truth: Value,
}

impl KnownTruth {
    /// The model as the file names it: `kelvin`, `double`, `modal`, ...
    pub fn model(&self) -> &str {
        self.truth["model"].as_str().unwrap_or_default()
    }

    /// Whether a lumped model made it. Sums of modes (`modal`) are the only others.
    pub fn is_lumped(&self) -> bool {
        self.model() != "modal"
    }
}

/// Every record of the folder `CRUMPLE_KNOWN_TRUTH`, else of the shared reference material, by name; none (and the skip
/// line) where that is absent.
pub fn known_truths() -> Vec<KnownTruth> {
    match std::env::var_os("CRUMPLE_KNOWN_TRUTH") {
        Some(folder) => known_truths_in(Path::new(&folder)),
        None => shared("reference/known-truth").map_or_else(Vec::new, |folder| known_truths_in(&folder)),
    }
}

/// Every record of a folder, by name.
///
/// # Panics
/// If there is none, or a `truth.json` cannot be read: a folder that is there is to be tested.
pub fn known_truths_in(folder: &Path) -> Vec<KnownTruth> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut records: Vec<KnownTruth> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.join("truth.json").is_file())
        .map(|folder| {
            let path = folder.join("truth.json");
            let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            let truth = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
            KnownTruth { name, folder, truth }
        })
        .collect();
    records.sort_by(|a, b| a.name.cmp(&b.name));
    assert!(!records.is_empty(), "{} holds no record", folder.display());
    records
}

/// `truth.json` of the record of this name, for tests that need one and no other; [`known_truths`] goes over all.
///
/// Looks in the folder `CRUMPLE_KNOWN_TRUTH`, else among the shared reference material; prints the skip line
/// where the record is absent. A file that is there and cannot be read is the test's failure, not a skip.
pub fn known_truth(record: &str) -> Option<Value> {
    let known = known_truths().into_iter().find(|known| known.name == record);
    if known.is_none() {
        eprintln!("SKIPPED: no record {record} among those with known parameters");
    }
    known.map(|known| known.truth)
}

/// Writes a record as the reference material has them: 10 kHz, 20 ms before contact, 250 ms after it, exact samples.
pub fn write_known_truth(
    folder: &Path,
    name: &str,
    model: &Model,
    impact_speed_m_per_s: f64,
) -> Result<(), LumpedError> {
    let v0 = impact_speed_m_per_s;
    let response = model.respond(v0, 1.0 / f64::from(RATE_HZ), AFTER)?;
    let events = model.events(v0)?;
    let mut csv = format!("# synthetic record {name}\n# v0 = {v0} m/s\ntime_s,accel_g\n");
    for k in 0..BEFORE + AFTER {
        let t = (k as f64 - BEFORE as f64) / f64::from(RATE_HZ);
        let a = k.checked_sub(BEFORE).map_or(0.0, |k| response.compartment().acceleration_m_per_s2[k]);
        let _infallible = writeln!(csv, "{t},{}", a / STANDARD_GRAVITY_M_PER_S2 + 0.0);
    }
    let mut expected = json!({
        "t_m": events.time_of_dynamic_crush_s,
        "C": events.dynamic_crush_m,
        "t_rebound": events.time_of_rebound_s,
        "v_rebound": events.rebound_velocity_m_per_s,
    });
    let (kind, parameters, mass) = match model {
        Model::Kelvin(m) => {
            ("kelvin", json!({ "m": m.mass_kg, "k": m.stiffness_n_per_m, "c": m.damping_n_s_per_m }), json!(m.mass_kg))
        }
        Model::Maxwell(m) => {
            ("maxwell", json!({ "m": m.mass_kg, "k": m.stiffness_n_per_m, "c": m.damping_n_s_per_m }), json!(m.mass_kg))
        }
        Model::Elastoplastic(m) => {
            let (e, p) = (m.loading_stiffness_n_per_m, m.unloading_stiffness_n_per_m);
            ("elastoplastic", json!({ "m": m.mass_kg, "k_E": e, "k_P": p, "release": m.release }), json!(m.mass_kg))
        }
        Model::Nonlinear1(m) => {
            let parameters = json!({
                "m": m.mass_kg,
                "k_knots": [0.0, m.crush_m], "k_values": [m.k1_n_per_m, m.k2_n_per_m],
                "c_knots": [0.0, m.v_thresh_m_per_s, m.v0_m_per_s],
                "c_values": [m.c1_n_s_per_m, m.c2_n_s_per_m, m.c3_n_s_per_m],
            });
            ("nonlinear", parameters, json!(m.mass_kg))
        }
        Model::Nonlinear2(m) => {
            let parameters = json!({
                "m": m.mass_kg,
                "k_knots": [0.0, m.x1_m, m.crush_m], "k_values": [m.k1_n_per_m, m.k2_n_per_m, m.k3_n_per_m],
                "c_knots": [0.0, m.v1_m_per_s, m.v2_m_per_s, m.v0_m_per_s],
                "c_values": [m.c1_n_s_per_m, m.c2_n_s_per_m, m.c3_n_s_per_m, m.c4_n_s_per_m],
            });
            ("nonlinear", parameters, json!(m.mass_kg))
        }
        Model::DoubleSpringMassDamper(m) => {
            let dual = m.dual();
            expected["dual_parameters"] = json!({
                "k1": dual.k1_n_per_m, "k2": dual.k2_n_per_m, "c1": dual.c1_n_s_per_m, "c2": dual.c2_n_s_per_m,
            });
            let parameters = json!({
                "m1": m.m1_kg, "m2": m.m2_kg, "k1": m.k1_n_per_m, "k2": m.k2_n_per_m,
                "c1": m.c1_n_s_per_m, "c2": m.c2_n_s_per_m,
            });
            ("double", parameters, json!([m.m1_kg, m.m2_kg]))
        }
        other => panic!("no records are made of {}", other.kind()),
    };
    let truth = json!({
        "schema": "known-truth-1",
        "id": name,
        "model": kind,
        "parameters": parameters,
        "sampling": {
            "rate_hz": RATE_HZ,
            "t_first_s": -(BEFORE as f64) / f64::from(RATE_HZ),
            "samples": BEFORE + AFTER,
            "trigger_sample_index": BEFORE,
        },
        "v0_m_s": v0,
        "mass_kg": mass,
        "expected": expected,
    });
    let target = folder.join(name);
    let write = |name: &str, text: String| {
        let path = target.join(name);
        std::fs::write(&path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    };
    std::fs::create_dir_all(&target).unwrap_or_else(|error| panic!("{}: {error}", target.display()));
    write("accel.csv", csv);
    write("truth.json", format!("{truth:#}\n"));
    Ok(())
}

/// Records with other parameters than those of the reference material: name, model and impact speed in m/s.
pub fn other_records() -> Vec<(&'static str, Model, f64)> {
    let double = |m1_kg, m2_kg, k1_n_per_m, k2_n_per_m, c1_n_s_per_m, c2_n_s_per_m| {
        Model::DoubleSpringMassDamper(DoubleSpringMassDamper {
            m1_kg,
            m2_kg,
            k1_n_per_m,
            k2_n_per_m,
            c1_n_s_per_m,
            c2_n_s_per_m,
        })
    };
    let mass_kg = 1420.0;
    vec![
        ("kelvin", Model::Kelvin(Kelvin { mass_kg, stiffness_n_per_m: 9.1e5, damping_n_s_per_m: 2.1e4 }), 15.6),
        ("maxwell", Model::Maxwell(Maxwell { mass_kg, stiffness_n_per_m: 1.9e6, damping_n_s_per_m: 5.2e4 }), 15.6),
        (
            "elastoplastic",
            Model::Elastoplastic(Elastoplastic {
                mass_kg,
                loading_stiffness_n_per_m: 7.7e5,
                unloading_stiffness_n_per_m: 2.6e7,
                release: true,
            }),
            13.1,
        ),
        (
            "nonlinear-1",
            Model::Nonlinear1(Nonlinear1 {
                mass_kg,
                k1_n_per_m: 5e4,
                k2_n_per_m: 6e5,
                c1_n_s_per_m: 2e5,
                c2_n_s_per_m: 3e4,
                c3_n_s_per_m: 2e3,
                v_thresh_m_per_s: 2.0,
                crush_m: 0.7,
                v0_m_per_s: 13.1,
            }),
            13.1,
        ),
        ("double-light-front", double(300.0, 1100.0, 6e5, 9e5, 9e3, 5e3), 14.0),
        ("double-heavy-front", double(800.0, 600.0, 4.2e5, 2.6e5, 2.1e3, 3.3e3), 11.0),
    ]
}
