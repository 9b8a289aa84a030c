//! The waves that fits to several sensors, to velocity or to acceleration were made to, with the measurement of each.

use std::collections::BTreeMap;

use crumple_lumped_fit::{Candidate, FitQuantity, Measurement, ObservedWave, SensorFit};
use crumple_signal::{Displacement, Sampled, Velocity};
use crumple_stage::records::EventsV1;
use crumple_stage::{Inputs, RefuseExt};

use crate::stage::assess::dual_pairs::FitKind;
use crate::stage::inputs::measurement::measurement;
use crate::stage::inputs::motions::acceleration;

/// Channel and quantity with the samples, how they were measured, and whether that is known.
#[derive(Debug)]
pub struct SensorWaves {
    waves: BTreeMap<(String, FitQuantity), (Sampled, Measurement, bool)>,
    /// Channel of the pulse, which a sensor without a name means.
    pulse: String,
}

impl SensorWaves {
    /// Everything that these candidates were fitted to.
    pub fn of(
        candidates: &[Candidate],
        input: &Inputs,
        events: &EventsV1,
        mass_kg: Option<f64>,
    ) -> anyhow::Result<Self> {
        let mut collected = Self { waves: BTreeMap::new(), pulse: events.channel.clone() };
        for candidate in candidates.iter().filter(|candidate| candidate.of_sensors()) {
            for sensor in candidate.fit.iter().flat_map(|fit| &fit.sensors) {
                let key = collected.key(sensor);
                if collected.waves.contains_key(&key) {
                    continue;
                }
                let channel = &key.0;
                let wave = match sensor.quantity {
                    FitQuantity::Displacement => input
                        .wave(&format!("{channel}/displacement"))?
                        .signal::<Displacement>()
                        .refuse()?
                        .into_sampled(),
                    FitQuantity::Velocity => {
                        input.wave(&format!("{channel}/velocity"))?.signal::<Velocity>().refuse()?.into_sampled()
                    }
                    FitQuantity::Acceleration => acceleration(input, channel, mass_kg.unwrap_or(1.0))?,
                };
                let (measured, known) = measurement(input, events, channel, &wave)?;
                collected.waves.insert(key, (wave, measured, known));
            }
        }
        Ok(collected)
    }

    fn key(&self, sensor: &SensorFit) -> (String, FitQuantity) {
        let channel = if sensor.channel.is_empty() { &self.pulse } else { &sensor.channel };
        (channel.clone(), sensor.quantity)
    }

    fn sensors<'a>(&self, candidate: &'a Candidate) -> &'a [SensorFit] {
        candidate.fit.as_ref().map_or(&[], |fit| &fit.sensors)
    }

    /// Whether the filters of all its sensors are known.
    pub fn known(&self, candidate: &Candidate) -> bool {
        self.sensors(candidate).iter().all(|sensor| self.waves.get(&self.key(sensor)).is_some_and(|wave| wave.2))
    }

    /// Its sensors in their windows, weighted by the noise levels of the fit; `None` where one cannot be looked at.
    pub fn seen(
        &self,
        candidate: &Candidate,
        time_zero_s: f64,
        window_s: (f64, f64),
        samples: usize,
    ) -> Option<Vec<ObservedWave>> {
        let sensors = self.sensors(candidate);
        let first = sensors.first()?.noise;
        let observed_wave = |sensor: &SensorFit| {
            let (wave, measured, _) = self.waves.get(&self.key(sensor))?;
            let what = (sensor.mass.checked_sub(1), sensor.quantity);
            let mut seen = ObservedWave::new(wave, what, time_zero_s, *measured, window_s, samples).ok()?;
            seen.weight = first / sensor.noise;
            Some(seen)
        };
        let seen: Option<Vec<ObservedWave>> = sensors.iter().map(observed_wave).collect();
        seen.filter(|waves| waves.iter().all(|wave| wave.weight.is_finite() && wave.weight > 0.0))
    }
}
