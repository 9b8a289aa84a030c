//! The runs that readings are taken from: a real car, a recorder made of it, made cars, damage.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_artifact::Artifact;
use crumple_lumped::{Elastoplastic, Model};
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::atlas::Failure;
use crate::places::{shared, workspace};
use crate::prediction_error::{self, KINDS, Kind};
use crate::programs::Steps;
use crate::records::write_camry_with_load_cells;

/// Speeds that the Camry is asked at, beside 40 to 64 km/h of the pipeline.
const ASKED: &str = "8km/h,15.5km/h,24km/h,44km/h,52km/h";
/// Made cars a kind that go through the whole chain.
const CARS: usize = 2;
/// Made cars a kind whose pulse alone is taken.
const PULSES: usize = 10;
/// Closing speeds of the Camry against itself, mph.
pub(crate) const CLOSING_MPH: [f64; 4] = [5.0, 7.0, 10.0, 70.0];
const M_PER_S_PER_MPH: f64 = 0.447_04;

/// Two equal cars on a linear spring: stiffness of both in a row, N/m, restitution, closing speed, m/s.
pub(crate) const PAIRS: [[f64; 3]; 2] = [[265_930.099, 0.382_628, 2.2352], [404_747.304, 0.339_413, 3.129_28]];
const PAIR_MASS_KG: f64 = 1587.5733;

/// What all runs have left.
#[derive(Debug)]
pub(crate) struct Runs {
    /// `summary.json` of the Camry with one sensor, at all speeds.
    pub camry: Value,
    /// The same with the load cells of its barrier.
    pub wall: Value,
    /// The same of the pipeline with two sensors.
    pub two_sensors: Value,
    /// The Camry against itself at [`CLOSING_MPH`].
    pub closing: Vec<Value>,
    /// A recorder in the Camry.
    pub recorder: Value,
    /// A car in a small overlap.
    pub overlap: Value,
    /// Made cars of plastic kinds.
    pub cars: Vec<Value>,
    /// What tests of the same cars would show, in the form of predictions.
    pub tested: Vec<Value>,
    /// Crush, m, and peak, m/s², of more of them, as the programs read their records.
    pub pulses: Vec<[f64; 2]>,
    /// The pairs of [`PAIRS`].
    pub pairs: Vec<Value>,
    /// One test, then 10 % stiffer; four tests; two vehicles.
    pub damage: [Value; 4],
}

/// Programs and where they write.
struct Programs<'a> {
    bin: &'a Path,
    folder: &'a Path,
}

impl Programs<'_> {
    fn crumple(&self, arguments: &[&str]) -> Result<(), Failure> {
        let mut command = Command::new(self.bin.join("crumple"));
        let output = command.args(arguments).current_dir(self.folder).output()?;
        match output.status.code() {
            Some(0 | 4) => Ok(()),
            _ => Err(format!("crumple {}: {}", arguments.join(" "), String::from_utf8_lossy(&output.stderr)).into()),
        }
    }

    fn json(&self, path: &str) -> Result<Value, Failure> {
        Ok(serde_json::from_slice(&fs::read(self.folder.join(path))?)?)
    }

    /// `summary.json` of a run of a record into the folder of this name.
    fn run(&self, name: &str, record: &Path, flags: &[&str]) -> Result<Value, Failure> {
        let record = record.to_str().ok_or("a path that is no text")?;
        self.crumple(&[&["run", record, "-q", "-o", name], flags].concat())?;
        self.json(&format!("{name}/summary.json"))
    }

    /// The same after a question.
    fn predicted(&self, name: &str, flags: &[&str]) -> Result<Value, Failure> {
        self.crumple(&[&["predict", name, "-q"], flags].concat())?;
        self.json(&format!("{name}/summary.json"))
    }

    fn damage(&self, flags: &[&str]) -> Result<Value, Failure> {
        self.crumple(&[&["damage", "-o", "damage.json"], flags].concat())?;
        self.json("damage.json")
    }

    fn write(&self, name: &str, text: &str) -> Result<PathBuf, Failure> {
        let path = self.folder.join(name);
        fs::write(&path, text)?;
        Ok(path)
    }
}

/// A record of the shared folder.
fn record(path: &str) -> Result<PathBuf, Failure> {
    Ok(shared(path).ok_or("the atlas needs the reference records: CRUMPLE_SHARED")?)
}

impl Runs {
    /// Makes them by the programs in `bin`. Errors: the reference records are not here, a program fails.
    pub fn made(bin: &Path, folder: &Path) -> Result<Self, Failure> {
        fs::create_dir_all(folder)?;
        let programs = Programs { bin, folder };
        let ev5 = record("data/nhtsa-v10146-camry-frontal/v10146.EV5")?;
        let pipeline = workspace().join("pipelines/two-sensors.toml");
        programs.run("camry", &ev5, &[])?;
        let camry = programs.predicted("camry", &["--speed", ASKED])?;
        let closing = CLOSING_MPH
            .iter()
            .map(|mph| {
                let speed = format!("{}m/s", mph * M_PER_S_PER_MPH);
                programs.predicted("camry", &["--partner", "camry", "--closing-speed", &speed])
            })
            .collect::<Result<_, _>>()?;
        let two = programs.run("two", &ev5, &["--pipeline", &pipeline.display().to_string()])?;
        let cells = folder.join("cells");
        write_camry_with_load_cells(&ev5, &record("data/nhtsa-v10146-camry-frontal/v10146_barrier_fx.zip")?, &cells)?;
        let table = programs.write("recorder.csv", &recorder(&folder.join("camry/3-integrate.mcap"))?)?;
        let overlap = record("data/iihs-cep1705-accord/CEP1705_ACXD.csv")?;
        Ok(Self {
            two_sensors: two,
            wall: programs.run("wall", &cells.join("v10146.EV5"), &[])?,
            recorder: programs.run("recorder", &table, &["--profile", "edr", "--mass", "1719kg"])?,
            overlap: programs.run(
                "overlap",
                &overlap,
                &["--unit", "g", "--impact-speed", "64.4km/h", "--mass", "1600kg"],
            )?,
            cars: cars(&programs)?,
            tested: tested(),
            pulses: pulses(&programs)?,
            pairs: PAIRS.iter().map(|pair| self::pair(&programs, *pair)).collect::<Result<_, _>>()?,
            damage: damage(&programs)?,
            camry,
            closing,
        })
    }
}

/// What a recorder would keep of a run: change of velocity every 10 ms in whole km/h, for 250 ms.
fn recorder(integrated: &Path) -> Result<String, Failure> {
    let artifact = Artifact::open(integrated)?;
    let events: Value = artifact
        .records()
        .iter()
        .find(|record| record.topic == "/events")
        .map(|record| serde_json::from_slice(&record.payload))
        .ok_or("no events")??;
    let id = format!("{}/velocity", events["channel"].as_str().unwrap_or_default());
    let velocity = &artifact.waves().get(&id).ok_or(format!("no wave {id}"))?.sampled;
    let at = |time_s: f64| velocity.at(time_s).ok_or("the velocity ends before 250 ms");
    let start = at(0.0)?;
    let mut csv = "Time (ms),Longitudinal Delta-V (km/h)\n".to_owned();
    for ms in (0..=250).step_by(10) {
        let change = (3.6 * (at(f64::from(ms) / 1e3)? - start)).round() + 0.0;
        writeln!(csv, "{ms},{change}")?;
    }
    Ok(csv)
}

/// Made cars whose structure stays crushed, but at the pole, which is tested slower.
fn plastic(numbers: usize) -> Vec<(&'static Kind, usize)> {
    let kinds = KINDS.iter().filter(|kind| kind.is_plastic && kind.speed_factor() == 1.0);
    kinds.flat_map(|kind| (0..numbers).map(move |number| (kind, number))).collect()
}

fn cars(programs: &Programs<'_>) -> Result<Vec<Value>, Failure> {
    let run = |(place, (kind, number)): (usize, (&Kind, usize))| {
        let path = programs.write(&format!("car-{place}.csv"), &prediction_error::made(kind, number).0)?;
        programs.run(&format!("car-{place}"), &path, &["--time-zero", "0s"])
    };
    plastic(CARS).into_iter().enumerate().collect::<Vec<_>>().into_par_iter().map(run).collect()
}

/// The two tests of each car at 40 and 56 km/h.
fn tested() -> Vec<Value> {
    let of_car = |(kind, number): (&Kind, usize)| {
        let car = prediction_error::made(kind, number).1;
        let test = |km_per_h: f64| {
            let [crush_m, _, _, peak_m_per_s2] = car.impact(km_per_h / 3.6, 1.0);
            json!({
                "recommended": true,
                "impact_speed_m_per_s": km_per_h / 3.6,
                "dynamic_crush_m": crush_m,
                "peak_acceleration_m_per_s2": peak_m_per_s2,
            })
        };
        json!({ "predictions": [test(40.0), test(56.0)] })
    };
    plastic(CARS).into_par_iter().map(of_car).collect()
}

fn pulses(programs: &Programs<'_>) -> Result<Vec<[f64; 2]>, Failure> {
    let integrated = |(place, (kind, number)): (usize, (&Kind, usize))| -> Result<[f64; 2], Failure> {
        let folder = programs.folder.join(format!("pulse-{place}"));
        let steps = Steps { bin: programs.bin, folder: &folder, pipeline: None };
        steps.write("crash.csv", &prediction_error::made(kind, number).0)?;
        steps.run("ingest", &["crash.csv", "--time-zero", "0s", "-o", "1.mcap"])?;
        steps.run("filter", &["1.mcap", "-o", "2.mcap"])?;
        let printed = steps.run("integrate", &["2.mcap", "--uncertainty-replicates", "0", "--json", "-o", "3.mcap"])?;
        steps.remove_folder()?;
        let metric = |name: &str| super::pulses::metric(&printed, name).ok_or(format!("{}: no {name}", kind.name));
        Ok([metric("dynamic_crush")?, metric("peak_acceleration")?.abs()])
    };
    plastic(PULSES).into_iter().enumerate().collect::<Vec<_>>().into_par_iter().map(integrated).collect()
}

/// A car that has the given spring in each of its ends, tested at a wall, then against itself.
fn pair(programs: &Programs<'_>, [in_a_row, restitution, closing]: [f64; 3]) -> Result<Value, Failure> {
    let stiffness_n_per_m = 2.0 * in_a_row;
    let model = Model::Elastoplastic(Elastoplastic {
        mass_kg: PAIR_MASS_KG,
        loading_stiffness_n_per_m: stiffness_n_per_m,
        unloading_stiffness_n_per_m: stiffness_n_per_m / restitution.powi(2),
        release: true,
    });
    let (dt_s, speed) = (1e-4, 10.0);
    let motion = model.respond(speed, dt_s, 3001)?;
    let mut csv = format!("# mass: {PAIR_MASS_KG} kg\n# impact speed: {speed} m/s\ntime [s],acceleration [m/s^2]\n");
    for k in -500..3001_i32 {
        let a = usize::try_from(k).map_or(0.0, |k| motion.compartment().acceleration_m_per_s2[k]);
        writeln!(csv, "{:.4},{}", f64::from(k) * dt_s, a + 0.0)?;
    }
    let name = format!("pair-{closing}");
    let path = programs.write(&format!("{name}.csv"), &csv)?;
    programs.run(&name, &path, &["--time-zero", "0s"])?;
    programs.predicted(&name, &["--partner", &name, "--closing-speed", &format!("{closing}m/s")])
}

/// The tests of the manual; the pair of the guide book, in SI.
fn damage(programs: &Programs<'_>) -> Result<[Value; 4], Failure> {
    let profile = ["--profile", "10,25,38,40,31,12 cm", "--width", "150cm", "--mass", "1450kg"];
    let with = |more: &[&str]| programs.damage(&[more, &profile].concat());
    let tests = ["1400kg,40km/h,32cm,150cm", "1410kg,48km/h,41cm,150cm", "1395kg,56km/h,48cm,150cm"];
    let mut four: Vec<&str> = tests.iter().flat_map(|test| ["--test", test]).collect();
    four.extend(["--test", "1405kg,64km/h,59cm,150cm"]);
    let pair = [
        "--stiffness",
        "84.0083427kN/m,359.9063307kN/m^2",
        "--profile",
        "0.3556,0.3556 m",
        "--width",
        "1m",
        "--mass",
        "1400kg",
        "--other-stiffness",
        "62.3101279kN/m,234.4217480kN/m^2",
        "--other-width",
        "1m",
        "--other-mass",
        "1400kg",
    ];
    Ok([
        with(&["--stiffness", "60kN/m,700kN/m^2"])?,
        with(&["--stiffness", "66kN/m,770kN/m^2"])?,
        with(&four)?,
        programs.damage(&pair)?,
    ])
}
