//! The runs whose sentences are read: records of known truth, each with the pipelines and the questions it is put to.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{fs, io};

use crumple_lumped::Model;
use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;

use crate::contact_cover;
use crate::interval_cover::{DRAWN, made as made_by_family};
use crate::places::workspace;
use crate::prediction_error::{KINDS, made as made_by_kind};
use crate::records::TwoVehicles;
use crate::records::fixture::fixture_models;
use crate::truth::known::{Impact, Known, Maker, Subject};

/// What is asked of a run behind it, as flags of `just predict`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Question {
    /// The flags.
    pub flags: &'static [&'static str],
    /// The speed asked for, m/s.
    pub speed_m_per_s: Option<f64>,
    /// The mass asked for, kg.
    pub mass_kg: Option<f64>,
    /// The partner, by a word of its name.
    pub partner: Option<&'static str>,
}

/// A run.
#[derive(Debug, Clone)]
pub struct RunCase {
    /// What it is called in tables.
    pub name: String,
    /// The record.
    pub record: PathBuf,
    /// Variables of `just`: a pipeline, a swapped stage.
    pub variables: Vec<String>,
    /// Flags of `just run`.
    pub flags: Vec<String>,
    /// What is asked after it.
    pub question: Option<Question>,
    /// Its artifacts, by place in the chain, that alone are reported; empty: all.
    pub reported: &'static [usize],
    /// What is true of it.
    pub known: Known,
}

/// How many runs there are: one a template, or all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// What every change must pass.
    Short,
    /// All, with this many made cars a family and a kind.
    Long(usize),
}

/// Impacts that are asked for.
const QUESTIONS: [Question; 5] = [
    Question { flags: &["--speed", "30km/h"], speed_m_per_s: Some(30.0 / 3.6), mass_kg: None, partner: None },
    Question { flags: &["--speed", "100km/h"], speed_m_per_s: Some(100.0 / 3.6), mass_kg: None, partner: None },
    Question { flags: &["--mass", "1100kg"], speed_m_per_s: None, mass_kg: Some(1100.0), partner: None },
    Question {
        flags: &["--speed", "25km/h", "--mass", "1250kg"],
        speed_m_per_s: Some(25.0 / 3.6),
        mass_kg: Some(1250.0),
        partner: None,
    },
    Question {
        flags: &["--partner", "mpdb", "--speed", "50km/h"],
        speed_m_per_s: Some(50.0 / 3.6),
        mass_kg: None,
        partner: Some("mpdb"),
    },
];

/// Pipelines that are shipped.
const PIPELINES: [&str; 5] = ["default", "unfiltered", "papers/civic", "papers/era", "papers/firefly"];

/// Records are written to `folder`. Errors: one cannot be.
pub fn cases(extent: Extent, folder: &Path) -> io::Result<Vec<RunCase>> {
    let mut all = of_fixtures(extent, folder)?;
    all.extend(of_families(extent, folder)?);
    all.extend(of_kinds(extent, folder)?);
    all.extend(of_other_records(folder)?);
    all.extend(of_contacts(extent, folder)?);
    Ok(all)
}

/// Pulses with contact anywhere in the file, and what happens before and after it.
fn of_contacts(extent: Extent, folder: &Path) -> io::Result<Vec<RunCase>> {
    let count = if let Extent::Long(count) = extent { count } else { 0 };
    let numbered = contact_cover::KINDS.iter().flat_map(|kind| (0..count).map(move |number| (kind, number)));
    numbered
        .map(|(kind, number)| {
            let made = kind.made(number);
            let impact = made.crush.map(|[crush_m, time_s]| Impact {
                crush_m,
                time_s,
                restitution: made.delta_v_m_per_s / made.true_speed_m_per_s - 1.0,
                peak_m_per_s2: made.peak_m_per_s2,
            });
            let maker = impact.map_or(Maker::Nothing, Maker::Pulse);
            let known = Known {
                contact_s: made.contact_s,
                ..Known::vehicle(maker, contact_cover::MASS_KG, made.true_speed_m_per_s)
            };
            let name = format!("{} {number}", kind.name);
            let flags: Vec<&str> = made.flags.iter().map(String::as_str).collect();
            let set = made.stated.iter().flat_map(|stated| ["--set", stated.as_str()]);
            written(folder, &name, &made.csv, &flags.into_iter().chain(set).collect::<Vec<_>>(), known)
        })
        .collect()
}

fn case(name: impl Into<String>, record: PathBuf, known: Known) -> RunCase {
    RunCase {
        name: name.into(),
        record,
        variables: Vec::new(),
        flags: Vec::new(),
        question: None,
        reported: &[],
        known,
    }
}

/// The fixtures through every pipeline, through a swapped filter, and the questions after them.
fn of_fixtures(extent: Extent, folder: &Path) -> io::Result<Vec<RunCase>> {
    let mut all = Vec::new();
    let swapped = swapped_filter(folder)?;
    for (number, (name, model, mass_kg, speed_m_per_s)) in fixture_models().into_iter().enumerate() {
        let record = workspace().join("fixtures").join(name).join("crash.csv");
        let known = Known::vehicle(Maker::Lumped(model), mass_kg, speed_m_per_s);
        let one = |what: &str, variables: Vec<String>, question: Option<Question>| RunCase {
            variables,
            question,
            ..case(format!("{name}{what}"), record.clone(), known.clone())
        };
        for pipeline in PIPELINES {
            let is_short = pipeline == "default" || name == "elastoplastic";
            if is_short || extent != Extent::Short {
                all.push(one(&format!(", {pipeline}"), vec![format!("pipeline={pipeline}")], None));
            }
        }
        if name == "elastoplastic" || extent != Extent::Short {
            all.push(one(", swapped filter", vec![swapped.clone()], None));
        }
        for (asked, question) in QUESTIONS.into_iter().enumerate() {
            if extent != Extent::Short || asked == number {
                all.push(one(&format!(", {}", question.flags.join(" ")), Vec::new(), Some(question)));
            }
        }
    }
    Ok(all)
}

/// Records of the lumped families as a laboratory measures them.
fn of_families(extent: Extent, folder: &Path) -> io::Result<Vec<RunCase>> {
    let count = if let Extent::Long(count) = extent { count } else { 1 };
    let mut all = Vec::new();
    for (place, drawn) in DRAWN.iter().enumerate() {
        for number in 0..count {
            let car = made_by_family(drawn, number).map_err(io::Error::other)?;
            let record = folder.join(format!("family-{place}-{number}.csv"));
            fs::write(&record, car.csv)?;
            let known = Known::vehicle(Maker::Lumped(car.model), car.mass_kg, car.impact_speed_m_per_s);
            let own = case(format!("{} {number}", drawn.name), record, known);
            all.push(if car.engine { with_engine(own) } else { own });
        }
    }
    Ok(all)
}

/// Cars of the kinds of the prediction benchmark.
fn of_kinds(extent: Extent, folder: &Path) -> io::Result<Vec<RunCase>> {
    let count = if let Extent::Long(count) = extent { count } else { 1 };
    let kinds = if extent == Extent::Short { 2 } else { KINDS.len() };
    let mut all = Vec::new();
    for (place, kind) in KINDS.iter().enumerate().take(kinds) {
        for number in 0..count {
            let (csv, car) = made_by_kind(kind, number);
            let record = folder.join(format!("kind-{place}-{number}.csv"));
            fs::write(&record, csv)?;
            let (mass_kg, speed_m_per_s) = (car.mass_kg(), car.speed_m_per_s);
            let known = Known::vehicle(Maker::Car(car), mass_kg, speed_m_per_s);
            all.push(case(format!("{} {number}", kind.name), record, known));
        }
    }
    Ok(all)
}

/// A pulse of 50 km/h that stops a vehicle of 900 kg and lets it rebound, in g, at a time in s.
fn pulse(time_s: f64) -> f64 {
    const LENGTH_S: f64 = 0.09;
    const REBOUND: f64 = 0.1;
    let peak = 50.0 / 3.6 * (1.0 + REBOUND) * PI / (2.0 * LENGTH_S) / G;
    if (0.0..LENGTH_S).contains(&time_s) { -peak * (PI * time_s / LENGTH_S).sin() } else { 0.0 }
}

/// A table of 0.25 s, 0.1 ms apart, with 50 ms before contact.
fn table(head: &str, values: &dyn Fn(f64) -> Vec<f64>) -> String {
    let mut text = head.to_owned();
    for k in 0..2500 {
        let t = f64::from(k) * 1e-4 - 0.05;
        let cells: String = values(t).iter().map(|value| format!(",{:.6}", value + 0.0)).collect();
        let _infallible = writeln!(text, "{t:.4}{cells}");
    }
    text
}

/// Records that lack something, state something wrong, or are of something else.
fn of_other_records(folder: &Path) -> io::Result<Vec<RunCase>> {
    let mut all = Vec::new();
    let table = |head: &str, values: &dyn Fn(f64) -> f64| table(head, &|t| vec![values(t)]);
    let (time, g) = ("time [s],acceleration [g]\n", 1.0);
    let both = ["--mass", "900kg", "--impact-speed", "50km/h"].as_slice();
    let sound = Known { mass_kg: Some(900.0), speed_m_per_s: Some(50.0 / 3.6), ..Known::of(Subject::Vehicle) };
    let wrong = |remedy: &'static str| Known { is_sound: false, remedy: Some(remedy), ..sound.clone() };
    let faulty = Known { is_sound: false, ..sound.clone() };
    let mut add = |name: &str, text: String, flags: &[&str], known: Known| -> io::Result<()> {
        all.push(written(folder, name, &text, flags, known)?);
        Ok(())
    };
    let plain = table(time, &|t| g * pulse(t));
    add("half sine", plain.clone(), both, sound.clone())?;
    add("without speed", plain.clone(), &["--mass", "900kg", "--allow-missing"], sound.clone())?;
    add("without mass", plain.clone(), &["--impact-speed", "50km/h", "--allow-missing"], sound.clone())?;
    add("without mass and speed", plain, &["--allow-missing"], sound.clone())?;
    let metric = "time [s],acceleration [m/s^2]\n";
    add("g taken for m/s^2", table(metric, &pulse), both, wrong("--unit g"))?;
    add("m/s^2 taken for g", table(time, &|t| G * pulse(t)), both, wrong("--unit m/s^2"))?;
    let miles = ["--mass", "900kg", "--impact-speed", "50mph"].as_slice();
    add("km/h taken for mph", table(time, &pulse), miles, wrong("--impact-speed"))?;
    add("turned round", table(time, &|t| -pulse(t)), both, faulty.clone())?;
    add("constant", table(time, &|_| 0.0), both, faulty.clone())?;
    add("clipped", table(time, &|t| pulse(t).max(-15.0)), both, faulty.clone())?;
    add("does not stop", table(time, &|t| if t < 0.03 { pulse(t) } else { 0.0 }), both, faulty)?;
    let late = Known { contact_s: 0.03, ..sound.clone() };
    add("starts late", table(time, &|t| pulse(t - 0.03)), both, late)?;
    all.extend(of_places(folder)?);
    all.extend(of_some_stages());
    all.extend(of_two_sensors(folder)?);
    all.extend(of_no_vehicle_at_a_wall(folder)?);
    Ok(all)
}

fn written(folder: &Path, name: &str, text: &str, flags: &[&str], known: Known) -> io::Result<RunCase> {
    let record = folder.join(format!("{}.csv", name.replace([' ', ',', '/'], "-")));
    fs::write(&record, text)?;
    let flags = flags.iter().map(|flag| (*flag).to_owned()).collect();
    Ok(RunCase { flags, ..case(name, record, known) })
}

/// Sensors in an occupant, along another axis, and two at one place; noise, and levels before contact.
fn of_places(folder: &Path) -> io::Result<Vec<RunCase>> {
    let both = ["--mass", "900kg", "--impact-speed", "50km/h"].as_slice();
    let stated = |subject| Known { mass_kg: Some(900.0), speed_m_per_s: Some(50.0 / 3.6), ..Known::of(subject) };
    let [vehicle, occupant, lateral] = [Subject::Vehicle, Subject::Occupant, Subject::OtherAxis].map(stated);
    let head = "time [s],11HEAD0000H3ACXP (g)";
    let all_axes = format!("{head},11HEAD0000H3ACYP (g),11HEAD0000H3ACZP (g)\n");
    let of_all_axes = |t: f64| vec![(3.0 * pulse(t)).max(-60.0), 0.5 * pulse(t), 0.3 * pulse(t)];
    let sills = "time [s],10SEATLERE00ACXD (g),10SEATRIRE00ACXD (g)\n";
    let plain = "time [s],acceleration [g]\n";
    // A ring of 1 kHz that no vehicle has before contact.
    let ring = |t: f64| 3.0 * (TAU * 1000.0 * t).sin();
    let before = |t: f64| if t < 0.0 { 1.0 } else { 0.0 };
    [
        ("occupant, one axis", table(&format!("{head}\n"), &|t| vec![3.0 * pulse(t)]), [].as_slice(), &occupant),
        ("occupant, clipped", table(&all_axes, &of_all_axes), &[], &Known { is_sound: false, ..occupant.clone() }),
        ("other axis", table("time [s],10VEHCCG0000ACYD (g)\n", &|t| vec![pulse(t)]), both, &lateral),
        ("sensors that differ", table(sills, &|t| vec![pulse(t), 1.06 * pulse(t)]), both, &vehicle),
        ("ringing", table(plain, &|t| vec![pulse(t) + ring(t)]), both, &vehicle),
        ("free fall", table(plain, &|t| vec![pulse(t) + before(t)]), both, &vehicle),
        ("level", table(plain, &|t| vec![pulse(t) + 1.0]), both, &vehicle),
        ("too strong", table(plain, &|t| vec![2.5 * pulse(t)]), both, &Known { is_sound: false, ..vehicle.clone() }),
    ]
    .into_iter()
    .map(|(name, text, flags, known)| written(folder, name, &text, flags, known.clone()))
    .collect()
}

/// A fixture of which only the artifacts of some stages are reported, and one whose model nobody assesses.
fn of_some_stages() -> Vec<RunCase> {
    let fixtures = fixture_models();
    let of_fixture = |what: &str| {
        let (name, model, mass_kg, speed) = fixtures.iter().find(|(name, ..)| *name == "elastoplastic")?.clone();
        let record = workspace().join("fixtures").join(name).join("crash.csv");
        Some(case(format!("{name}, {what}"), record, Known::vehicle(Maker::Lumped(model), mass_kg, speed)))
    };
    const REPORTED: [(&str, &[usize]); 5] = [
        ("ingest alone", &[0]),
        ("up to the filter", &[0, 1]),
        ("up to the motion", &[0, 1, 2]),
        ("not simulated", &[0, 1, 2, 4]),
        ("models without motion", &[0, 1, 3]),
    ];
    let some = REPORTED.into_iter().filter_map(|(what, reported)| Some(RunCase { reported, ..of_fixture(what)? }));
    let closed = ["--set", "parameter-solve.models=elastoplastic", "--set", "parameter-solve.method=closed-form"];
    let unassessed = of_fixture("closed form without intervals").map(|own| RunCase {
        variables: vec!["pipeline=unfiltered".to_owned()],
        flags: closed.map(str::to_owned).to_vec(),
        ..own
    });
    some.chain(unassessed).collect()
}

/// The double fixture with a sensor on both masses, by the pipeline for it and by the default.
fn of_two_sensors(folder: &Path) -> io::Result<Vec<RunCase>> {
    let Some((_, model, mass_kg, speed)) = fixture_models().into_iter().find(|(name, ..)| *name == "double") else {
        return Ok(Vec::new());
    };
    let record = folder.join("two-sensors.csv");
    fs::write(&record, two_sensors(&model, mass_kg, speed)?)?;
    let known = Known::vehicle(Maker::Lumped(model), mass_kg, speed);
    let both = with_engine(case("two sensors, both fitted", record.clone(), known.clone()));
    let flags = ["--channel", "accel"].map(str::to_owned).to_vec();
    let one = RunCase { flags, ..case("two sensors, one fitted", record, Known { sensors: 2, ..known }) };
    Ok(vec![both, one])
}

/// A case with a sensor on the mass in front, which is fitted too.
fn with_engine(case: RunCase) -> RunCase {
    let sensors = ["integrate.channels=all,engine", "parameter-solve.sensors=engine=engine"];
    let fitted = sensors.into_iter().flat_map(|setting| ["--set", setting]);
    RunCase {
        variables: vec!["pipeline=two-sensors".to_owned()],
        flags: ["--channel", "accel"].into_iter().chain(fitted).map(str::to_owned).collect(),
        known: Known { sensors: 2, ..case.known },
        ..case
    }
}

fn two_sensors(model: &Model, mass_kg: f64, speed: f64) -> io::Result<String> {
    let response = model.respond(speed, 1e-4, 2001).map_err(io::Error::other)?;
    let km_per_h = speed * 3.6;
    let mut csv = format!(
        "# title: made, two sensors\n# mass: {mass_kg} kg\n# impact speed: {km_per_h} km/h\n\
         time_s,accel (g),engine (g)\n"
    );
    for k in 0..2501_usize {
        let [front, rear] = match k.checked_sub(500) {
            None => [0.0, 0.0],
            Some(k) => [&response.motions[0], response.compartment()].map(|m| m.acceleration_m_per_s2[k] / G),
        };
        let _infallible = writeln!(csv, "{:.4},{},{}", k as f64 * 1e-4 - 0.05, rear + 0.0, front + 0.0);
    }
    Ok(csv)
}

/// A collision of two vehicles, a recorder's table, inputs and outputs.
fn of_no_vehicle_at_a_wall(folder: &Path) -> io::Result<Vec<RunCase>> {
    for (name, content) in TwoVehicles::STANDING.files() {
        fs::write(folder.join(name), content)?;
    }
    let known = Known {
        mass_kg: Some(TwoVehicles::STANDING.masses_kg[0]),
        speed_m_per_s: Some(TwoVehicles::STANDING.speeds_km_per_h[0] / 3.6),
        ..Known::of(Subject::TwoVehicles)
    };
    let mut all = vec![case("two vehicles", folder.join("v90001.EV5"), known)];
    let velocity = |k: i32| -41.0 * (1.0 - (PI * f64::from(k.min(12)) / 12.0).cos()) / 2.0;
    let rows: String = (0..=25).map(|k| format!("{},{:.0}\n", 10 * k, velocity(k))).collect();
    let record = folder.join("recorder.csv");
    fs::write(&record, format!("Time (msec),\"Delta-V, longitudinal (km/h)\"\n{rows}"))?;
    for (name, speed) in [("recorder", 45.0), ("recorder, stops", 38.0)] {
        let speed_flag = format!("{speed}km/h");
        let flags = ["--profile", "edr", "--mass", "1500kg", "--impact-speed", &speed_flag].map(str::to_owned).to_vec();
        let known = Known { mass_kg: Some(1500.0), speed_m_per_s: Some(speed / 3.6), ..Known::of(Subject::Recorder) };
        all.push(RunCase { flags, ..case(name, record.clone(), known) });
    }
    all.extend(of_inputs_and_outputs(folder)?);
    Ok(all)
}

/// A process with the poles 0.75 ± 0.3708i, and an output that has nothing to do with its input.
fn of_inputs_and_outputs(folder: &Path) -> io::Result<Vec<RunCase>> {
    let (mut y1, mut y2, mut before) = (0.3, -0.1, 0.0);
    let mut process = |input: f64, _: i32| {
        let y = 1.5 * y1 - 0.7 * y2 + 0.5 * before;
        (y2, y1, before) = (y1, y, input);
        y
    };
    let mut unrelated = |_: f64, k: i32| 3.0 * (0.37 * f64::from(k * k)).sin();
    let flags = ["--sample-time=20ms", "--allow-missing", "--orders=2", "--inputs=u", "--outputs=y"];
    type Output<'a> = (&'a str, &'a mut dyn FnMut(f64, i32) -> f64, &'a [&'a str]);
    let outputs: [Output<'_>; 2] = [
        ("inputs and outputs", &mut process, &["--methods=n4sid,arx,output-error"]),
        ("unrelated output", &mut unrelated, &["--methods=n4sid,arx", "--validate-from=6s"]),
    ];
    outputs
        .into_iter()
        .map(|(name, output, more)| {
            let rows = (0..500_i32).map(|k| {
                let input = f64::from((k * k * 7 + k * 3) % 11) - 5.0;
                format!("{input},{:.12}\n", output(input, k))
            });
            let text = format!("u,y\n{}", rows.collect::<String>());
            written(folder, name, &text, &[&flags, more].concat(), Known::of(Subject::InputOutput))
        })
        .collect()
}

/// A filter stage in another as `just` takes it: it hands the pulse on as the product's filter left it and
/// says nothing of how.
fn swapped_filter(folder: &Path) -> io::Result<String> {
    let script = folder.join("swapped-filter.sh");
    fs::write(&script, include_str!("swapped_filter.sh"))?;
    Ok(format!("filter=sh '{}' '$BIN'", script.display()))
}
