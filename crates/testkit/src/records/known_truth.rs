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

/// Two cars, two masses with a spring between them that lets go when it is as long as before.
#[derive(Debug, Clone, Copy)]
pub struct TwoVehicles {
    /// Test masses, kg.
    pub masses_kg: [f64; 2],
    /// Speeds before contact along each one's own forward axis, km/h.
    pub speeds_km_per_h: [f64; 2],
    /// The second heads the same way as the first, else towards it.
    pub same_heading: bool,
}

/// Natural frequency of the two on their spring, rad/s.
const OMEGA_RAD_PER_S: f64 = 20.0;
/// Samples before contact, and in all, 0.1 ms apart.
const SAMPLES: [i64; 2] = [500, 2500];

impl TwoVehicles {
    /// One standing car, hit head-on by a lighter one at 50 km/h.
    pub const STANDING: Self = Self { masses_kg: [1200.0, 1600.0], speeds_km_per_h: [50.0, 0.0], same_heading: false };

    fn sign(&self) -> f64 {
        if self.same_heading { 1.0 } else { -1.0 }
    }

    /// Closing speed, m/s.
    pub fn closing_speed_m_per_s(&self) -> f64 {
        (self.speeds_km_per_h[0] - self.sign() * self.speeds_km_per_h[1]) / 3.6
    }

    /// Velocity of both when they move alike, along the axis of the first, m/s.
    pub fn common_velocity_m_per_s(&self) -> f64 {
        let [m1, m2] = self.masses_kg;
        let [v1, v2] = self.speeds_km_per_h.map(|v| v / 3.6);
        (m1 * v1 + m2 * self.sign() * v2) / (m1 + m2)
    }

    /// How much closer they have come then, m, and when that is, s.
    pub fn relative_crush(&self) -> (f64, f64) {
        (self.closing_speed_m_per_s() / OMEGA_RAD_PER_S, std::f64::consts::PI / (2.0 * OMEGA_RAD_PER_S))
    }

    /// Acceleration of vehicle `k` along its own forward axis, m/s².
    pub fn acceleration_m_per_s2(&self, k: usize, time_s: f64) -> f64 {
        let [m1, m2] = self.masses_kg;
        let phase = OMEGA_RAD_PER_S * time_s;
        if !(0.0..=std::f64::consts::PI).contains(&phase) {
            return 0.0;
        }
        let force = m1 * m2 / (m1 + m2) * self.closing_speed_m_per_s() * OMEGA_RAD_PER_S * phase.sin();
        if k == 0 { -force / m1 } else { self.sign() * force / m2 }
    }

    /// The files of the test by name: `v90001.EV5` and its signal files. Curves 1 and 2 are left and right of the first
    /// car, 3 is its engine; 4 and 5 are the second car, 6 its missing sill sensor, 7 a driver of the second.
    pub fn files(&self) -> Vec<(String, String)> {
        let curves = [
            (1, "FLLR", "NA", "LEFT REAR SEAT CROSSMEMBER X"),
            (1, "FLRR", "NA", "NO COMMENTS"),
            (1, "ENGN", "NA", "TOP OF ENGINE X"),
            (2, "FLLR", "NA", "NO COMMENTS"),
            (2, "VECG", "NA", ""),
            (2, "DSLF", "NA", "No comments"),
            (2, "CHST", "01", "DRIVER CHEST X"),
        ];
        let mut files = vec![("v90001.EV5".to_owned(), self.specification(&curves))];
        for (k, (vehicle, attachment, ..)) in curves.iter().enumerate() {
            if *attachment != "DSLF" {
                files.push((format!("v90001.{:03}", k + 1), self.signal(*vehicle - 1)));
            }
        }
        files
    }

    fn specification(&self, curves: &[(usize, &str, &str, &str)]) -> String {
        let record = |count: usize, fields: &[(usize, String)]| {
            let mut cells = vec![String::new(); count];
            for (position, text) in fields {
                cells[position - 1].clone_from(text);
            }
            cells.join("|") + "\n"
        };
        let text = |text: &str| text.to_owned();
        let closing = format!("{:.2}", 3.6 * self.closing_speed_m_per_s());
        let title = text("2016 FIRST CAR SEDAN INTO 2014 SECOND CAR HATCHBACK");
        let test = [(1, text("V5")), (2, title), (9, text("VTV")), (15, closing), (20, text("NO COMMENTS"))];
        let mut ev5 = format!("# made record\n----- EV5 -----\n----- TEST -----\n{}", record(20, &test));
        ev5 += "----- VEHICLE -----\n";
        for (k, year) in ["2016", "2014"].into_iter().enumerate() {
            let mut fields = vec![
                (1, (k + 1).to_string()),
                (2, text("16")),
                (3, text("03")),
                (4, text(year)),
                (11, self.masses_kg[k].to_string()),
                (42, self.speeds_km_per_h[k].to_string()),
                (54, text("12FDEW2")),
                (81, text("NO COMMENTS")),
            ];
            fields.extend((0..6).map(|station| (48 + station, (100 * (k + 1) + 10 * station).to_string())));
            ev5 += &record(81, &fields);
        }
        ev5 += "----- INSTRUMENTATION -----\n";
        for (k, (vehicle, attachment, location, comment)) in curves.iter().enumerate() {
            let speed = self.speeds_km_per_h[vehicle - 1];
            let fields = [
                (1, vehicle.to_string()),
                (2, format!("{:03}", k + 1)),
                (3, text("AC")),
                (4, text(location)),
                (5, text(attachment)),
                (6, text("XG")),
                (7, text("SEC")),
                (8, text("G'S")),
                (9, text("3000")),
                (14, speed.to_string()),
                (15, (-SAMPLES[0]).to_string()),
                (16, (SAMPLES[1] - SAMPLES[0] - 1).to_string()),
                (17, text("100")),
                (18, text("AM")),
                (19, text("P")),
                (20, text(comment)),
            ];
            ev5 += &record(20, &fields);
        }
        ev5 + "----- END -----\n"
    }

    fn signal(&self, vehicle: usize) -> String {
        let mut rows = String::new();
        for k in 0..SAMPLES[1] {
            let time_s = (k - SAMPLES[0]) as f64 * 1e-4;
            let g = self.acceleration_m_per_s2(vehicle, time_s) / STANDARD_GRAVITY_M_PER_S2;
            let _ = writeln!(rows, "{time_s:.6}\t{g:.6}");
        }
        rows
    }
}
