//! The runs that are held against the truth: records of known truth, each with the pipelines and the questions it is
//! put to.

use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};
use std::{fs, io};

use crumple_lumped::Model;
use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;

use crate::contact_cover;
use crate::interval_cover::{DRAWN, made as made_by_family};
use crate::places::workspace;
use crate::prediction_error::{KINDS, made as made_by_kind};
use crate::records::fixture::fixture_models;
use crate::records::{HALF_SINE_SPEED, TwoVehicles, half_sine as pulse, table, test_of_half_sine, two_sensors};
use crate::truth::known::{Impact, Known, Maker, Subject};

/// What is asked of a run behind it, as flags of `crumple predict`.
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
    /// The pipeline.
    pub pipeline: String,
    /// A program that stands for a stage, `$BIN` for the folder of the programs: `filter=COMMAND`.
    pub stage: Option<String>,
    /// Flags behind the record.
    pub flags: Vec<String>,
    /// What is asked after it.
    pub question: Option<Question>,
    /// Its artifacts, by place in the chain, that alone are reported; empty: all.
    pub reported: &'static [usize],
    /// What is true of it.
    pub known: Known,
}

/// How many runs there are: one of each kind of record, or all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// What every change must pass.
    Short,
    /// All, with this many made cars a family and a kind.
    Long(usize),
}

impl Extent {
    /// Made cars a family or kind; in the short form this many.
    fn cars(self, short: usize) -> usize {
        if let Self::Long(count) = self { count } else { short }
    }
}

/// Impacts that are asked for.
const QUESTIONS: [Question; 5] = [
    asked(&["--speed", "30km/h"], Some(30.0), None, None),
    asked(&["--speed", "100km/h"], Some(100.0), None, None),
    asked(&["--mass", "1100kg"], None, Some(1100.0), None),
    asked(&["--speed", "25km/h", "--mass", "1250kg"], Some(25.0), Some(1250.0), None),
    asked(&["--partner", "mpdb", "--speed", "50km/h"], Some(50.0), None, Some("mpdb")),
];

const fn asked(
    flags: &'static [&'static str],
    km_per_h: Option<f64>,
    mass_kg: Option<f64>,
    partner: Option<&'static str>,
) -> Question {
    let speed_m_per_s = if let Some(speed) = km_per_h { Some(speed / 3.6) } else { None };
    Question { flags, speed_m_per_s, mass_kg, partner }
}

/// Pipelines that are shipped.
const PIPELINES: [&str; 5] = ["default", "unfiltered", "papers/civic", "papers/era", "papers/firefly"];

/// Records are written to `folder`. Errors: one cannot be.
pub fn cases(extent: Extent, folder: &Path) -> io::Result<Vec<RunCase>> {
    let mut all = of_fixtures(extent, folder)?;
    all.extend(of_cars(extent, folder)?);
    all.extend(of_other_records(folder)?);
    all.extend(of_contacts(extent, folder)?);
    Ok(all)
}

/// Pulses with contact anywhere in the file, and what happens before and after it.
fn of_contacts(extent: Extent, folder: &Path) -> io::Result<Vec<RunCase>> {
    let numbered = contact_cover::KINDS.iter().flat_map(|kind| (0..extent.cars(0)).map(move |number| (kind, number)));
    let one = |(kind, number): (&contact_cover::Kind, usize)| {
        let made = kind.made(number);
        let restitution = made.delta_v_m_per_s / made.true_speed_m_per_s - 1.0;
        let impact = made.crush.map(|[crush_m, time_s]| [crush_m, time_s, restitution, made.peak_m_per_s2]);
        let maker = impact.map_or(Maker::Nothing, |impact| Maker::Pulse(impact.into()));
        let known = Known::vehicle(maker, contact_cover::MASS_KG, made.true_speed_m_per_s);
        let set = made.stated.iter().flat_map(|stated| ["--set", stated.as_str()]);
        let flags: Vec<&str> = made.flags.iter().map(String::as_str).chain(set).collect();
        let known = Known { contact_s: made.contact_s, ..known };
        written(folder, &format!("{} {number}", kind.name), &made.csv, &flags, known)
    };
    numbered.map(one).collect()
}

fn case(name: impl Into<String>, record: PathBuf, known: Known) -> RunCase {
    RunCase {
        name: name.into(),
        record,
        pipeline: PIPELINES[0].to_owned(),
        stage: None,
        flags: Vec::new(),
        question: None,
        reported: &[],
        known,
    }
}

fn case_of_fixture((name, model, mass_kg, speed): (&str, Model, f64, f64), what: &str) -> RunCase {
    let record = workspace().join("fixtures").join(name).join("crash.csv");
    case(format!("{name}, {what}"), record, Known::vehicle(Maker::Lumped(model), mass_kg, speed))
}

/// The fixtures through every pipeline, through a swapped filter, and the questions after them.
fn of_fixtures(extent: Extent, folder: &Path) -> io::Result<Vec<RunCase>> {
    let mut all = Vec::new();
    // In place of the product's: it hands the pulse on as that filter left it and says nothing of how.
    let script = folder.join("swapped-filter.sh");
    fs::write(&script, include_str!("swapped_filter.sh"))?;
    let swapped = format!("filter=sh '{}' '$BIN'", script.display());
    for (number, fixture) in fixture_models().into_iter().enumerate() {
        let name = fixture.0;
        let one = |what: &str| case_of_fixture(fixture.clone(), what);
        for pipeline in PIPELINES {
            let is_short = pipeline == "default" || name == "elastoplastic";
            if is_short || extent != Extent::Short {
                all.push(RunCase { pipeline: pipeline.to_owned(), ..one(pipeline) });
            }
        }
        if name == "elastoplastic" || extent != Extent::Short {
            all.push(RunCase { stage: Some(swapped.clone()), ..one("swapped filter") });
        }
        for (asked, question) in QUESTIONS.into_iter().enumerate() {
            if extent != Extent::Short || asked == number {
                all.push(RunCase { question: Some(question), ..one(&question.flags.join(" ")) });
            }
        }
    }
    Ok(all)
}

/// Records of the lumped families as a laboratory measures them, and cars of the kinds of the prediction benchmark.
fn of_cars(extent: Extent, folder: &Path) -> io::Result<Vec<RunCase>> {
    let mut all = Vec::new();
    for (drawn, number) in DRAWN.iter().flat_map(|drawn| (0..extent.cars(1)).map(move |number| (drawn, number))) {
        let car = made_by_family(drawn, number).map_err(io::Error::other)?;
        let known = Known::vehicle(Maker::Lumped(car.model), car.mass_kg, car.impact_speed_m_per_s);
        let own = written(folder, &format!("{} {number}", drawn.name), &car.csv, &[], known)?;
        all.push(if car.engine { with_engine(own) } else { own });
    }
    let kinds = KINDS.iter().take(if extent == Extent::Short { 2 } else { KINDS.len() });
    for (kind, number) in kinds.flat_map(|kind| (0..extent.cars(1)).map(move |number| (kind, number))) {
        let (csv, car) = made_by_kind(kind, number);
        let (mass_kg, speed_m_per_s) = (car.mass_kg(), car.speed_m_per_s);
        let known = Known::vehicle(Maker::Car(car), mass_kg, speed_m_per_s);
        all.push(written(folder, &format!("{} {number}", kind.name), &csv, &[], known)?);
    }
    Ok(all)
}

fn written(folder: &Path, name: &str, text: &str, flags: &[&str], known: Known) -> io::Result<RunCase> {
    let record = folder.join(format!("{}.csv", name.replace(|c: char| !c.is_ascii_alphanumeric(), "-")));
    fs::write(&record, text)?;
    let flags = flags.iter().map(|flag| (*flag).to_owned()).collect();
    Ok(RunCase { flags, ..case(name, record, known) })
}

/// Records that lack something, state something wrong, or are of something else: sensors in an occupant, along another
/// axis, two at one place; noise, and levels before contact.
fn of_other_records(folder: &Path) -> io::Result<Vec<RunCase>> {
    let sound = &Known::vehicle(Maker::Pulse(Impact::from(test_of_half_sine())), 900.0, HALF_SINE_SPEED);
    let wrong = |remedy: &'static str| Known { is_sound: false, remedy: Some(remedy), ..sound.clone() };
    let [unit_g, unit_si, speed, sign] = &["--unit g", "--unit m/s^2", "--impact-speed", "--sign flip"].map(wrong);
    let faulty = &Known { is_sound: false, maker: Maker::Nothing, ..sound.clone() };
    let [occupant, lateral] = &[Subject::Occupant, Subject::OtherAxis].map(|subject| Known {
        subject,
        maker: Maker::Nothing,
        ..sound.clone()
    });
    let clipped = &Known { is_sound: false, ..occupant.clone() };
    let late = &Known { contact_s: 0.03, ..sound.clone() };

    let (g, si) = ("acceleration [g]", "acceleration [m/s^2]");
    let head = "11HEAD0000H3ACXP (g)";
    let all_axes = "11HEAD0000H3ACXP (g),11HEAD0000H3ACYP (g),11HEAD0000H3ACZP (g)";
    let sills = "10SEATLERE00ACXD (g),10SEATRIRE00ACXD (g)";
    // A ring of 1 kHz that no vehicle has before contact.
    let ring = |t: f64| 3.0 * (TAU * 1000.0 * t).sin();
    let before = |t: f64| if t < 0.0 { 1.0 } else { 0.0 };

    let both = ["--mass", "900kg", "--impact-speed", "50km/h"].as_slice();
    let (mass, change) = (["--mass", "900kg", "--allow-missing"], ["--impact-speed", "50km/h", "--allow-missing"]);
    let (miles, neither) = (["--mass", "900kg", "--impact-speed", "50mph"], ["--allow-missing"]);
    type Record<'a> = (&'a str, &'a str, &'a dyn Fn(f64) -> Vec<f64>, &'a [&'a str], &'a Known);
    let records: [Record<'_>; 20] = [
        ("half sine", g, &|t| vec![pulse(t)], both, sound),
        ("without speed", g, &|t| vec![pulse(t)], &mass, sound),
        ("without mass", g, &|t| vec![pulse(t)], &change, sound),
        ("without mass and speed", g, &|t| vec![pulse(t)], &neither, sound),
        ("g taken for m/s^2", si, &|t| vec![pulse(t)], both, unit_g),
        ("m/s^2 taken for g", g, &|t| vec![G * pulse(t)], both, unit_si),
        ("km/h taken for mph", g, &|t| vec![pulse(t)], &miles, speed),
        ("turned round", g, &|t| vec![-pulse(t)], both, sign),
        ("constant", g, &|_| vec![0.0], both, faulty),
        ("clipped", g, &|t| vec![pulse(t).max(-15.0)], both, faulty),
        ("does not stop", g, &|t| vec![if t < 0.03 { pulse(t) } else { 0.0 }], both, faulty),
        ("too strong", g, &|t| vec![2.5 * pulse(t)], both, faulty),
        ("starts late", g, &|t| vec![pulse(t - 0.03)], both, late),
        ("ringing", g, &|t| vec![pulse(t) + ring(t)], both, sound),
        ("free fall", g, &|t| vec![pulse(t) + before(t)], both, sound),
        ("level", g, &|t| vec![pulse(t) + 1.0], both, sound),
        ("occupant, one axis", head, &|t| vec![3.0 * pulse(t)], &[], occupant),
        ("occupant, clipped", all_axes, &|t| [3.0, 0.5, 0.3].map(|k| (k * pulse(t)).max(-60.0)).to_vec(), &[], clipped),
        ("other axis", "10VEHCCG0000ACYD (g)", &|t| vec![pulse(t)], both, lateral),
        ("sensors that differ", sills, &|t| vec![pulse(t), 1.06 * pulse(t)], both, sound),
    ];
    let of_record = |(name, head, values, flags, known): Record<'_>| {
        written(folder, name, &table(head, values), flags, known.clone())
    };
    let mut all = records.into_iter().map(of_record).collect::<io::Result<Vec<_>>>()?;
    all.extend(of_some_stages());
    all.extend(of_two_sensors(folder)?);
    all.extend(of_no_vehicle_at_a_wall(folder)?);
    Ok(all)
}

/// A fixture of which only the artifacts of some stages are reported, and one whose model nobody assesses.
fn of_some_stages() -> Vec<RunCase> {
    let of_fixture =
        |what: &str| Some(case_of_fixture(fixture_models().into_iter().find(|own| own.0 == "elastoplastic")?, what));
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
        pipeline: "unfiltered".to_owned(),
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
    let csv = two_sensors(&model, mass_kg, speed).map_err(io::Error::other)?;
    let known = Known { sensors: 2, ..Known::vehicle(Maker::Lumped(model), mass_kg, speed) };
    let one = written(folder, "two sensors, one fitted", &csv, &["--channel", "accel"], known)?;
    let both = RunCase { name: "two sensors, both fitted".to_owned(), ..one.clone() };
    Ok(vec![with_engine(both), one])
}

/// A case with a sensor on the mass in front, which is fitted too.
fn with_engine(case: RunCase) -> RunCase {
    let sensors = ["integrate.channels=all,engine", "parameter-solve.sensors=engine=engine"];
    let fitted = sensors.into_iter().flat_map(|setting| ["--set", setting]);
    RunCase {
        pipeline: "two-sensors".to_owned(),
        flags: ["--channel", "accel"].into_iter().chain(fitted).map(str::to_owned).collect(),
        known: Known { sensors: 2, ..case.known },
        ..case
    }
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

/// A process with the poles 0.75 ± 0.3708i, 20 ms apart, and an output that has nothing to do with its input.
fn of_inputs_and_outputs(folder: &Path) -> io::Result<Vec<RunCase>> {
    let (mut y1, mut y2, mut before) = (0.3, -0.1, 0.0);
    let mut process = |input: f64, _: i32| {
        let y = 1.5 * y1 - 0.7 * y2 + 0.5 * before;
        (y2, y1, before) = (y1, y, input);
        y
    };
    let mut unrelated = |_: f64, k: i32| 3.0 * (0.37 * f64::from(k * k)).sin();
    let flags = ["--sample-time=20ms", "--allow-missing", "--orders=2", "--inputs=u", "--outputs=y"];
    let (decay, turn) = (0.5 * 0.7_f64.ln(), (0.75 / 0.7_f64.sqrt()).acos());
    let modulus = decay.hypot(turn);
    let mode = Maker::Mode { frequency_hz: modulus / (TAU * 0.02), damping_ratio: -decay / modulus };
    type Output<'a> = (&'a str, &'a mut dyn FnMut(f64, i32) -> f64, &'a [&'a str], Maker);
    let outputs: [Output<'_>; 2] = [
        ("inputs and outputs", &mut process, &["--methods=n4sid,arx,output-error"], mode),
        ("unrelated output", &mut unrelated, &["--methods=n4sid,arx", "--validate-from=6s"], Maker::Nothing),
    ];
    outputs
        .into_iter()
        .map(|(name, output, more, maker)| {
            let rows = (0..500_i32).map(|k| {
                let input = f64::from((k * k * 7 + k * 3) % 11) - 5.0;
                format!("{input},{:.12}\n", output(input, k))
            });
            let text = format!("u,y\n{}", rows.collect::<String>());
            let known = Known { maker, ..Known::of(Subject::InputOutput) };
            written(folder, name, &text, &[&flags, more].concat(), known)
        })
        .collect()
}
