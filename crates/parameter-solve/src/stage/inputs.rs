//! What the artifacts hold of a test, and its candidates from events and motion.

use crumple_lumped_fit::{Candidate, FitQuantity, MassSplit, Sensor, SensorPlace, TestData, solve};
use crumple_signal::{
    About, Acceleration, Displacement, Force, Measurement, Sampled, Signal, TestDescription, Velocity, Weight, remarks,
};
use crumple_stage::records::EventsV1;
use crumple_stage::{Inputs, Output, RefuseExt, Refused, flag, option, program};

use crate::stage::options::PlacedSensor;
use crate::stage::settings::StageSettings;

// The motion of a channel, as integrated or as filtered.

/// A motion of a sensor, with its place, its channel and how it was measured.
#[derive(Debug)]
pub struct SensorWave {
    pub place: SensorPlace,
    pub channel: String,
    pub record: Sampled,
    pub measurement: Measurement,
    /// What it says: the quantity asked for, of the wall its force.
    pub quantity: FitQuantity,
}

/// The motions to fit together; none where it is the displacement of the pulse alone.
pub fn sensor_waves(
    settings: &StageSettings,
    input: &Inputs,
    events: &EventsV1,
    mass_kg: f64,
) -> anyhow::Result<Vec<SensorWave>> {
    let quantity = settings.solve.quantity;
    if settings.places.is_empty() && quantity == FitQuantity::Displacement || !settings.solve.fits_a_signal() {
        return Ok(Vec::new());
    }
    stated_places(settings, &events.channel)
        .into_iter()
        .map(|sensor| sensor_wave(settings, input, events, sensor, mass_kg))
        .collect()
}

/// The places and channels that are stated, the pulse on the compartment where nothing else is.
pub fn stated_places(settings: &StageSettings, pulse: &str) -> Vec<PlacedSensor> {
    let mut places = settings.places.clone();
    if !places.iter().any(|sensor| sensor.place == SensorPlace::Compartment) {
        places.insert(0, PlacedSensor { place: SensorPlace::Compartment, channel: pulse.to_owned() });
    }
    // Misfits are given in the unit of the first.
    places.sort_by_key(|sensor| sensor.place == SensorPlace::Wall);
    places
}

/// The motion of a channel in a place, with how it was measured.
pub fn sensor_wave(
    settings: &StageSettings,
    input: &Inputs,
    events: &EventsV1,
    PlacedSensor { place, channel }: PlacedSensor,
    mass_kg: f64,
) -> anyhow::Result<SensorWave> {
    if place == SensorPlace::Wall {
        let Some((record, steps)) = input.wall_force()? else {
            return Err(Refused::new("sensors names the wall, and the inputs hold no force on it")
                .expected("barrier/force, which the stage integrate sums from the load cells of the barrier")
                .hint("leave wall out of sensors")
                .into());
        };
        return Ok(SensorWave { place, channel, record, measurement: steps, quantity: FitQuantity::Force });
    }
    let quantity = settings.solve.quantity;
    let record = motion(input, &channel, quantity, mass_kg)?;
    let measurement = input.recording_steps(events, &channel, &record)?;
    Ok(SensorWave { place, channel, record, measurement, quantity })
}

/// The motion of a channel.
pub fn motion(input: &Inputs, channel: &str, quantity: FitQuantity, mass_kg: f64) -> anyhow::Result<Sampled> {
    let hint = "the stage integrate writes the motion of the pulse and of the channels named in its channels";
    let wave = |what: &str| {
        let id = format!("{channel}/{what}");
        input.wave_if(&id).map_or_else(|| Err(not_integrated(input, channel, what)), Ok)
    };
    Ok(match quantity {
        FitQuantity::Displacement => {
            wave("displacement")?.signal::<Displacement>().refuse_with_hint(hint)?.into_sampled()
        }
        FitQuantity::Velocity => wave("velocity")?.signal::<Velocity>().refuse_with_hint(hint)?.into_sampled(),
        // The force on the wall is no motion of a channel: see [`sensor_wave`].
        FitQuantity::Acceleration | FitQuantity::Force => acceleration(input, channel, mass_kg)?,
    })
}

/// The refusal of a sensor whose motion no input holds: where other channels were integrated it was not among them,
/// else the artifact is missing.
fn not_integrated(input: &Inputs, channel: &str, what: &str) -> anyhow::Error {
    let integrated: Vec<&str> = input.waves().filter_map(|(id, _)| id.strip_suffix(&format!("/{what}"))).collect();
    if integrated.is_empty() {
        return input.missing(&format!("/wave/{channel}/{what}"));
    }
    let known = input.test().is_ok_and(|test| test.channel(channel).is_some());
    let (problem, hint) = if known {
        let hint = format!(
            "add {channel:?} to channels of [integrate], or {}",
            option("integrate", "channels", &format!("all,{channel}"))
        );
        (format!("channel {channel}, which sensors names, was not integrated"), hint)
    } else {
        let hint =
            format!("sensors = [\"place=channel\"] takes ids of channels; {} lists them", program("artifact show"));
        (format!("the test has no channel {channel:?}, which sensors names"), hint)
    };
    Refused::new(problem)
        .expected(format!("a channel whose {what} the inputs hold: {}", integrated.join(", ")))
        .hint(hint)
        .into()
}

/// The acceleration of a channel from the filter's artifact, else from the force that integrate made of it.
fn acceleration(input: &Inputs, channel: &str, mass_kg: f64) -> anyhow::Result<Sampled> {
    if let Some(wave) = input.wave_if(channel) {
        let hint = format!("name an accelerometer with {}", flag("parameter-solve", "sensors"));
        return Ok(wave.signal::<Acceleration>().refuse_with_hint(hint)?.into_sampled());
    }
    let tested = input.test()?.mass_kg.unwrap_or(mass_kg);
    let Some(force) = input.wave_if(&format!("{channel}/force")) else {
        return Err(Refused::new(format!("none of the inputs holds the acceleration of channel {channel}"))
            .hint(format!("give the artifact of {} too", program("filter")))
            .into());
    };
    let force = force.signal::<Force>().refuse()?;
    let samples = force.samples().iter().map(|f| -f / tested).collect();
    Ok(Sampled::new(force.t0_s(), force.dt_s(), samples)?)
}

// Mass, speed and motions of a test, each read once.

/// A displacement, and how it was measured.
pub type Displaced = (Signal<Displacement>, Measurement);

/// The displacement of the pulse; `None` where no input holds it.
pub fn pulse_displacement(input: &Inputs, events: &EventsV1) -> anyhow::Result<Option<Displaced>> {
    displacement_of(input, events, &events.channel)
}

/// The displacement of a channel; `None` where no input holds it. The one place where it is read.
pub fn displacement_of(input: &Inputs, events: &EventsV1, channel: &str) -> anyhow::Result<Option<Displaced>> {
    let Some(wave) = input.wave_if(&format!("{channel}/displacement")) else { return Ok(None) };
    let displacement = wave.signal::<Displacement>().refuse_with_hint("the stage integrate writes displacements")?;
    let steps = input.recording_steps(events, channel, &displacement)?;
    Ok(Some((displacement, steps)))
}

/// What the test says to all candidates from its events and its motion; every wave is read once.
#[derive(Debug)]
pub struct Record {
    pub mass_kg: f64,
    pub impact_speed_m_per_s: f64,
    /// Displacement of the pulse, and how it was measured.
    pub displacement: Option<Displaced>,
    /// The motions to fit together; none where it is that displacement alone.
    pub sensors: Vec<SensorWave>,
}

impl Record {
    /// Reads mass, speed and motions. Errors: none of them where they are needed.
    pub fn read(
        settings: &StageSettings,
        input: &Inputs,
        test: &TestDescription,
        (events, displacement): (&EventsV1, Option<Displaced>),
        out: &mut Output,
    ) -> anyhow::Result<Self> {
        let mass_kg = match (settings.mass_kg, test.mass_kg, settings.solve.split) {
            (Some(given), Some(tested), _) => {
                out.notes().push(MassByFlag { given_kg: given, tested_kg: tested });
                given
            }
            (Some(mass), ..) | (None, Some(mass), _) => mass,
            (None, None, MassSplit::Both(m1, m2)) => {
                out.notes().push(MassOfParts { mass_kg: m1 + m2 });
                m1 + m2
            }
            (None, None, _) => {
                return Err(Refused::new("the test has no mass").hint(option("ingest", "mass", "873kg")).into());
            }
        };
        let impact_speed_m_per_s = events.impact_speed_m_per_s.or(test.impact_speed_m_per_s).ok_or_else(|| {
            Refused::new("neither the events nor the test have an impact speed").hint(option(
                "ingest",
                "impact-speed",
                "35km/h",
            ))
        })?;
        if displacement.is_none() && settings.solve.fits_a_signal() {
            return Err(input.missing(&format!("/wave/{}/displacement", events.channel)));
        }
        let sensors = sensor_waves(settings, input, events, mass_kg)?;
        Ok(Self { mass_kg, impact_speed_m_per_s, displacement, sensors })
    }

    /// Dynamic crush; of a vehicle that never stops the largest displacement, m. `None` where it does not move.
    pub fn crush_m(&self, events: &EventsV1) -> Option<f64> {
        let largest = || Some(self.displacement.as_ref()?.0.samples().iter().copied().fold(0.0, f64::max));
        events.dynamic_crush_m.or_else(largest).filter(|crush_m| *crush_m > 0.0)
    }
}

/// More of the way at constant speed than this part, and the record shows a vehicle that speeds up; a drifting zero
/// level of 0.1 g adds 1 % of 10 m/s in 100 ms.
const SPEEDS_UP: f64 = 1.05;

/// Within this part of it, and the record shows no impact.
const KEEPS_ITS_SPEED: f64 = 0.01;

/// Rebound, in impact speeds, that no barrier gives and that a truck gives only a car which hardly moves.
const REBOUNDS: f64 = 10.0;

/// What to look at where settings do not fit the record.
pub fn see(names: &[&str]) -> String {
    let all: Vec<String> = names.iter().map(|name| flag("parameter-solve", name)).collect();
    format!("see {}", all.join(", "))
}

/// Why no force slows the vehicle down, if so, and what to do: it rebounds at [`REBOUNDS`] impact speeds; or it never
/// stops, and is in the end as far as its impact speed alone would have taken it, or beyond.
pub fn not_slowed(displacement: Option<&Displaced>, events: &EventsV1) -> Option<(&'static str, String)> {
    let (displacement, _) = displacement?;
    let (speed, end_m) = (events.impact_speed_m_per_s?, displacement.samples().last()?);
    let part = end_m / (speed * (displacement.end_s()));
    match part {
        _ if events.coefficient_of_restitution.is_some_and(|restitution| restitution > REBOUNDS) => Some((
            "the vehicle rebounds at more than ten times its impact speed: no spring or damper does that",
            format!("check the unit of the pulse and the impact speed ({})", option("ingest", "unit", "g")),
        )),
        _ if events.dynamic_crush_m.is_some() => None,
        SPEEDS_UP.. => Some((
            "the vehicle moves further than its impact speed would carry it: no spring or damper does that",
            format!("check the unit and the sign of the pulse ({} turns it)", option("ingest", "sign", "flip")),
        )),
        part if (part - 1.0).abs() < KEEPS_ITS_SPEED => Some((
            "the pulse does not slow the vehicle down, so that there is no force to model",
            format!("check the unit, time zero and the channel of the pulse ({})", option("ingest", "channel", "ID")),
        )),
        _ => None,
    }
}

/// The settings with the end of the event as the end of the window, where the velocity never reaches zero and no end is
/// stated.
pub fn up_to_the_end_of_the_event(
    settings: &StageSettings,
    events: &EventsV1,
    out: &mut Output,
) -> Option<StageSettings> {
    let open = settings.solve.fit_to_s.is_none() && events.time_of_dynamic_crush_s.is_none();
    let end_s = events.end_of_event_s.filter(|end_s| open && *end_s > settings.solve.fit_from_s)?;
    let rule = events.end_of_event_rule.clone().unwrap_or_else(|| "rule not stated".to_owned());
    out.notes().push(FittedToTheEndOfTheEvent { end_s, rule });
    let mut settings = settings.clone();
    settings.solve.fit_to_s = Some(end_s);
    Some(settings)
}

/// Candidates from the events and the motion.
pub fn from_events(
    settings: &StageSettings,
    record: &Record,
    events: &EventsV1,
    out: &mut Output,
) -> anyhow::Result<Vec<Candidate>> {
    let sensors = sensors_of(record);
    let test_data = test_data(record, events, &sensors);
    solve(&test_data, &settings.solve, out.notes()).refuse_with_hint(see(&["mass", "m1", "m2", "fit-from", "fit-to"]))
}

/// The sensors to fit together.
pub fn sensors_of<'a>(record: &'a Record) -> Vec<Sensor<'a>> {
    record
        .sensors
        .iter()
        .map(|wave| Sensor {
            channel: &wave.channel,
            place: wave.place,
            quantity: wave.quantity,
            record: &wave.record,
            measurement: Some(wave.measurement),
            noise: None,
        })
        .collect()
}

/// What the solvers start from.
pub fn test_data<'a>(record: &'a Record, events: &EventsV1, sensors: &'a [Sensor<'a>]) -> TestData<'a> {
    TestData {
        mass_kg: record.mass_kg,
        impact_speed_m_per_s: record.impact_speed_m_per_s,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        dynamic_crush_m: events.dynamic_crush_m,
        coefficient_of_restitution: restitution(events),
        time_of_rebound_s: events.time_of_rebound_s,
        displacement: record.displacement.as_ref().map(|(x, _)| x),
        measurement: record.displacement.as_ref().map(|(_, measurement)| *measurement),
        sensors,
    }
}

/// The coefficient of restitution; zero where its interval holds zero.
fn restitution(events: &EventsV1) -> Option<f64> {
    let holds_zero = events.intervals.iter().any(|i| i.name == "coefficient_of_restitution" && i.low <= 0.0);
    events.coefficient_of_restitution.map(|e| if holds_zero { 0.0 } else { e })
}

remarks! {
    /// Remarks of what artifacts hold of a test.
    pub REMARKS;

    /// Another mass is given than the test has.
    CR559 MassByFlag { given_kg: f64, tested_kg: f64 }
    bears on (About::Mass, Weight::None)
    decided "--mass goes before the mass of the test."
    means "Springs and dampers are made with the given mass. The forces of integrate are made with the mass of the \
           test."
    remedy "state the mass at ingest, so that all stages have it: --mass"
    says format!("mass {given_kg} kg given by flag instead of the test's {tested_kg} kg");

    /// The test has no mass, and the masses of both parts are given.
    CR560 MassOfParts { mass_kg: f64 }
    bears on (About::Mass, Weight::None)
    decided "The mass is the sum of m1 and m2."
    means "All models are solved with this mass."
    remedy "state the mass at ingest, so that all stages have it: --mass"
    says format!("the test has no mass; taken as m1 + m2 = {mass_kg} kg");

    /// The vehicle does not stop within the record: models are fitted until the end of the event.
    CR561 FittedToTheEndOfTheEvent { end_s: f64, rule: String }
    bears on (About::Model(String::new()), Weight::None)
    decided "The events have no dynamic crush, and fit_to is not stated. The rule of the sentence says how integrate \
             found the end of the event."
    means "What happens later does not change the models. They have no dynamic crush to be compared with."
    remedy "nothing, or state where the impact ends: fit_to"
    says format!(
        "the velocity never reaches zero: fitted up to the end of the event at {:.1} ms ({rule}). --fit-to changes it",
        1e3 * end_s
    );
}
