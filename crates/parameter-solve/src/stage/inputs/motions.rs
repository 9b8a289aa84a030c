//! The motion of a channel, as integrated or as filtered.

use crumple_lumped_fit::{FitQuantity, Measurement, SensorPlace};
use crumple_signal::{Acceleration, Displacement, Force, Sampled, Velocity};
use crumple_stage::records::EventsV1;
use crumple_stage::{Inputs, RefuseExt, Refused};

use crate::stage::options::settings::StageSettings;

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
        .map(|(place, channel)| sensor_wave(settings, input, events, (place, channel), mass_kg))
        .collect()
}

/// The places and channels that are stated, the pulse on the compartment where nothing else is.
pub fn stated_places(settings: &StageSettings, pulse: &str) -> Vec<(SensorPlace, String)> {
    let mut places = settings.places.clone();
    if !places.iter().any(|(place, _)| *place == SensorPlace::Compartment) {
        places.insert(0, (SensorPlace::Compartment, pulse.to_owned()));
    }
    // Misfits are given in the unit of the first.
    places.sort_by_key(|(place, _)| *place == SensorPlace::Wall);
    places
}

/// The motion of a channel in a place, with how it was measured.
pub fn sensor_wave(
    settings: &StageSettings,
    input: &Inputs,
    events: &EventsV1,
    (place, channel): (SensorPlace, String),
    mass_kg: f64,
) -> anyhow::Result<SensorWave> {
    if place == SensorPlace::Wall {
        let Some((record, steps)) = input.wall_force(events)? else {
            return Err(Refused::new("sensors names the wall, and the inputs hold no force on it")
                .expected("barrier/force, which crumple-integrate sums from the load cells of the barrier")
                .hint("leave wall out of sensors")
                .into());
        };
        return Ok(SensorWave { place, channel, record, measurement: steps.into(), quantity: FitQuantity::Force });
    }
    let quantity = settings.solve.quantity;
    let record = motion(input, &channel, quantity, mass_kg)?;
    let measurement = input.recording_steps(events, &channel, &record)?.into();
    Ok(SensorWave { place, channel, record, measurement, quantity })
}

/// The motion of a channel.
pub fn motion(input: &Inputs, channel: &str, quantity: FitQuantity, mass_kg: f64) -> anyhow::Result<Sampled> {
    let hint = "crumple-integrate writes the motion of the pulse and of the channels named with --channels there";
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
        let hint = format!("add {channel:?} to channels of [integrate], or crumple-integrate --channels all,{channel}");
        (format!("channel {channel}, which sensors names, was not integrated"), hint)
    } else {
        let hint = "sensors = [\"place=channel\"] takes ids of channels; crumple-artifact show lists them".to_owned();
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
        let hint = "name an accelerometer with --sensors";
        return Ok(wave.signal::<Acceleration>().refuse_with_hint(hint)?.into_sampled());
    }
    let tested = input.test()?.mass_kg.unwrap_or(mass_kg);
    let Some(force) = input.wave_if(&format!("{channel}/force")) else {
        return Err(Refused::new(format!("none of the inputs holds the acceleration of channel {channel}"))
            .hint("give the artifact of crumple-filter too")
            .into());
    };
    let force = force.signal::<Force>().refuse()?;
    let samples = force.samples().iter().map(|f| -f / tested).collect();
    Ok(Sampled::new(force.t0_s(), force.dt_s(), samples)?)
}
