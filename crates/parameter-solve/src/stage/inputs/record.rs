//! Mass, speed and motions of a test, each read once.

use crumple_lumped_fit::{MassSplit, Measurement};
use crumple_signal::{Displacement, Signal, TestDescription};
use crumple_stage::records::EventsV1;
use crumple_stage::{Inputs, Output, RefuseExt, Refused, Wave};

use crate::stage::inputs::motions::{SensorWave, sensor_waves};
use crate::stage::options::settings::StageSettings;

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
            .map(|x| input.recording_steps(events, &events.channel, &x).map(|steps| (x, steps.into())))
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
