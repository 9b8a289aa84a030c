//! What the artifacts hold, as the library takes it: measurements, motions, identified models, exponential sums.

use crumple_lumped::{Complex, RealisedModel};
use crumple_lumped_fit::{
    CoefficientSpread, FitQuantity, Identified, MassEvidence, MassSplit, Measurement, Quartic, SensorPlace, masses,
};
use crumple_numerics::lti::{eigenvalues, matrix_logarithm};
use crumple_signal::{Acceleration, Displacement, Force, Sampled, Signal, TestDescription, Velocity};
use crumple_stage::records::{EventsV1, EvidenceV1, ExponentialSumV1, ModesV2, StateSpaceV1, TransferFunctionV1};
use crumple_stage::{Inputs, Output, RefuseExt, Refused, Wave};
use nalgebra::{DMatrix, Matrix4, RowVector4, Vector4};

use crate::stage::options::settings::StageSettings;

// Identified models with four poles among the inputs.

/// Every model with four poles: transfer functions of fourth order with the state space of the same name where there is
/// one, then state spaces without a transfer function, sums of four exponentials, and modes of four poles that belong
/// to none of them.
pub fn identified_models(input: &Inputs) -> anyhow::Result<Vec<Identified>> {
    let mut models: Vec<Identified> = Vec::new();
    for (id, model) in input.records::<TransferFunctionV1>("/model/")? {
        if let [leading, t, u, v, w] = model.denominator[..]
            && leading != 0.0
        {
            let quartic = Quartic::Coefficients([t, u, v, w].map(|c| c / leading));
            let source = "denominator of the transfer function";
            let spread = spread(input, &id)?;
            let delay_s = model.delay_s.unwrap_or(0.0);
            let numerator = Some(model.numerator);
            models.push(Identified { id, quartic, numerator, source, realised: None, spread, delay_s });
        }
    }
    let spaces = input.records::<StateSpaceV1>("/model/")?;
    for (id, model) in &spaces {
        // The continuous one of a pair says all.
        let base = base_of(id);
        if id.ends_with("/discrete") && spaces.iter().any(|(other, _)| *other == format!("{base}/continuous")) {
            continue;
        }
        let Some((a, rows)) = continuous(model) else { continue };
        let realised = realised(&a, &rows, model);
        if let Some(known) = models.iter_mut().find(|known| base_of(&known.id) == base) {
            known.realised = realised;
            continue;
        }
        let poles = eigenvalues(&DMatrix::from_column_slice(4, 4, a.as_slice()))?;
        if let Ok(poles) = <[Complex; 4]>::try_from(poles) {
            let delay_s = model.delay_s.unwrap_or(0.0);
            let bare = Identified::of_poles(id.clone(), poles, "eigenvalues of the state matrix of");
            models.push(Identified { realised, delay_s, ..bare });
        }
    }
    for (id, sum) in input.records::<ExponentialSumV1>("/model/")? {
        if let [a, b, c, d] = &sum.terms[..] {
            let poles = [a, b, c, d].map(|term| Complex::new(term.re_per_s, term.im_rad_per_s));
            models.push(Identified::of_poles(id, poles, "exponents of the sum"));
        }
    }
    for (id, modes) in input.records::<ModesV2>("/modes/")? {
        if let [a, b, c, d] = &modes.modes[..]
            && !models.iter().any(|model| base_of(&model.id) == id)
        {
            let poles = [a, b, c, d].map(|mode| Complex::new(mode.re_per_s, mode.im_rad_per_s));
            models.push(Identified::of_poles(id, poles, "poles of the modes of"));
        }
    }
    Ok(models)
}

/// How well the coefficients of a transfer function are known, by the evidence that its identification left.
fn spread(input: &Inputs, id: &str) -> anyhow::Result<Option<CoefficientSpread>> {
    let evidence: Option<EvidenceV1> = input.record_if(&format!("/evidence/{}", base_of(id)))?;
    Ok(evidence.and_then(|evidence| {
        CoefficientSpread::of_covariance(&evidence.denominator_covariance)
            .or_else(|| CoefficientSpread::of_deviations(&evidence.denominator_deviations))
    }))
}

/// `era-4` of `era-4/continuous`.
fn base_of(id: &str) -> &str {
    ["/continuous", "/discrete", "/transfer-function"].iter().find_map(|end| id.strip_suffix(end)).unwrap_or(id)
}

/// State matrix in continuous time and output rows of a model with four states; `None` for another order or where the
/// sampled matrix has no logarithm.
fn continuous(model: &StateSpaceV1) -> Option<(Matrix4<f64>, Vec<RowVector4<f64>>)> {
    let flat: Vec<f64> = model.a.iter().flatten().copied().collect();
    if model.a.len() != 4 || flat.len() != 16 {
        return None;
    }
    let a = Matrix4::from_row_slice(&flat);
    let a = if model.sample_time_s > 0.0 {
        let log = matrix_logarithm(&DMatrix::from_column_slice(4, 4, a.as_slice())).ok()?;
        Matrix4::from_column_slice((log / model.sample_time_s).as_slice())
    } else {
        a
    };
    let rows = model.c.iter().filter(|row| row.len() == 4).map(|row| RowVector4::from_row_slice(row)).collect();
    Some((a, rows))
}

/// One output is the compartment's; of two the first is that of the chassis. `None` where the words of the output name
/// no motion.
fn realised(a: &Matrix4<f64>, rows: &[RowVector4<f64>], model: &StateSpaceV1) -> Option<RealisedModel> {
    let derivative = ["displacement", "velocity", "acceleration"].iter().position(|q| model.output.starts_with(q))?;
    let (chassis, compartment) = match rows {
        [compartment] => (None, *compartment),
        [chassis, compartment] => (Some(*chassis), *compartment),
        _ => return None,
    };
    // The state right after an impulse is the column of the input: the start of a free motion.
    let column: Vec<f64> = model.b.iter().filter_map(|row| row.first().copied()).collect();
    let free = model.input.contains("impulse") && column.len() == 4;
    let start = free.then(|| Vector4::from_column_slice(&column));
    Some(RealisedModel { a: *a, compartment, chassis, derivative, start })
}

// Masses of chassis and compartment for models that are matched.

/// Masses of chassis and compartment, by the options and the test.
pub fn given_masses(settings: &StageSettings, mass_kg: Option<f64>, out: &mut Output) -> anyhow::Result<(f64, f64)> {
    let mass_kg = match (mass_kg, settings.solve.split) {
        (Some(mass), _) => mass,
        (None, MassSplit::Both(m1, m2)) => m1 + m2,
        (None, _) => {
            return Err(Refused::new("the test has no mass")
                .expected("the masses of chassis and compartment")
                .hint("--m1 284.4kg --m2 1137.6kg")
                .into());
        }
    };
    let (m1_kg, m2_kg, split) =
        masses(mass_kg, settings.solve.split, MassEvidence::Compartment).refuse_with_hint("see --m1 and --m2")?;
    out.notes().info(split);
    Ok((m1_kg, m2_kg))
}

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
        return Ok(SensorWave { place, channel, record, measurement: steps, quantity: FitQuantity::Force });
    }
    let quantity = settings.solve.quantity;
    let record = motion(input, &channel, quantity, mass_kg)?;
    let measurement = input.recording_steps(events, &channel, &record)?;
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

// Mass, speed and motions of a test, each read once.

/// What the test says to all candidates from its events and its motion; every wave is read once.
#[derive(Debug)]
pub struct Record {
    pub mass_kg: f64,
    pub impact_speed_m_per_s: f64,
    /// Displacement of the pulse, and how it was measured.
    pub displacement: Option<(Signal<Displacement>, Measurement)>,
    /// The motions to fit together; none where it is that displacement alone.
    pub sensors: Vec<SensorWave>,
}

impl Record {
    /// Reads mass, speed and motions. Errors: none of them where they are needed.
    pub fn read(
        settings: &StageSettings,
        input: &Inputs,
        test: &TestDescription,
        events: &EventsV1,
        out: &mut Output,
    ) -> anyhow::Result<Self> {
        let mass_kg = match (settings.mass_kg, test.mass_kg, settings.solve.split) {
            (Some(given), Some(tested), _) => {
                out.notes().info(format!("mass {given} kg given by flag instead of the test's {tested} kg"));
                given
            }
            (Some(mass), ..) | (None, Some(mass), _) => mass,
            (None, None, MassSplit::Both(m1, m2)) => {
                out.notes().info(format!("the test has no mass; taken as m1 + m2 = {} kg", m1 + m2));
                m1 + m2
            }
            (None, None, _) => return Err(Refused::new("the test has no mass").hint("--mass 873kg").into()),
        };
        let impact_speed_m_per_s = events.impact_speed_m_per_s.or(test.impact_speed_m_per_s).ok_or_else(|| {
            Refused::new("neither the events nor the test have an impact speed")
                .hint("--impact-speed 35km/h at crumple-ingest")
        })?;
        let id = format!("{}/displacement", events.channel);
        let wave = if settings.solve.fits_a_signal() { Some(input.wave(&id)?) } else { input.wave_if(&id) };
        let displacement = wave
            .map(Wave::signal::<Displacement>)
            .transpose()
            .refuse_with_hint("crumple-integrate writes the displacement of the pulse")?
            .map(|x| input.recording_steps(events, &events.channel, &x).map(|steps| (x, steps)))
            .transpose()?;
        let sensors = sensor_waves(settings, input, events, mass_kg)?;
        Ok(Self { mass_kg, impact_speed_m_per_s, displacement, sensors })
    }

    /// Dynamic crush; of a vehicle that never stops the largest displacement, m. `None` where it does not move.
    pub fn crush_m(&self, events: &EventsV1) -> Option<f64> {
        let largest = || Some(self.displacement.as_ref()?.0.samples().iter().copied().fold(0.0, f64::max));
        events.dynamic_crush_m.or_else(largest).filter(|crush_m| *crush_m > 0.0)
    }
}
