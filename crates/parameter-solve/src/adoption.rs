//! What a candidate takes over from the minimum seen through the filter, and how several sensors are weighed there.

use crumple_parameter_solve::{Candidate, FitQuantity, Observed, Refined, bounds_remark};

/// Rounds of weighing sensors, the change of a level worth another one, and the least level as a share of the record.
pub const WEIGHINGS: usize = 4;
const LEVEL_MOVED: f64 = 0.01;
const LEAST_LEVEL: f64 = 1e-6;

/// Weighs the waves by the root mean square misfit of each; whether that changed anything.
pub fn weigh(observed: &mut Observed, found: &Refined) -> bool {
    let levels: Vec<f64> = observed
        .rmse(&found.misfit_m)
        .iter()
        .zip(&observed.waves)
        .map(|(rmse, wave)| rmse.max(LEAST_LEVEL * wave.size()).max(f64::MIN_POSITIVE))
        .collect();
    let mut moved = false;
    for (wave, level) in observed.waves.iter_mut().zip(&levels).skip(1) {
        let weight = levels[0] / level;
        moved |= (weight / wave.weight).ln().abs() > LEVEL_MOVED;
        wave.weight = weight;
    }
    moved
}

/// Parameters that the search left on a bound, other than zero: that value is the bound's, so it is held and has no interval.
pub fn held(candidate: &Candidate) -> impl Iterator<Item = &'static str> {
    let values = candidate.model.parameters();
    let names = candidate.fit.as_ref().map_or(&[][..], |fit| &fit.active_bounds);
    names.iter().copied().filter(move |name| values.get(*name).is_some_and(|value| *value != 0.0))
}

/// A fit takes the values of the minimum.
pub fn adopt(candidate: &mut Candidate, observed: &Observed, refined: &Refined) {
    let unrefined = std::mem::replace(&mut candidate.model, refined.model);
    if let Some(fit) = &mut candidate.fit {
        let rmse = observed.rmse(&refined.misfit_m);
        fit.rmse = rmse.first().copied().unwrap_or(fit.rmse);
        let noise = rmse.first().copied().unwrap_or(0.0).max(LEAST_LEVEL * observed.waves[0].size());
        for ((sensor, rmse), wave) in fit.sensors.iter_mut().zip(&rmse).zip(&observed.waves) {
            sensor.rmse = *rmse;
            sensor.noise = noise / wave.weight;
        }
        let errors: Vec<String> = fit
            .sensors
            .iter()
            .map(|sensor| {
                let (rmse, unit) = match sensor.quantity {
                    FitQuantity::Displacement => (1e3 * sensor.rmse, "mm"),
                    other => (sensor.rmse, other.unit()),
                };
                format!("{rmse:.4} {unit} at {} (mass {})", sensor.channel, sensor.mass)
            })
            .collect();
        for note in candidate.notes.iter_mut().filter(|note| note.starts_with("root mean square errors ")) {
            *note = format!(
                "root mean square errors seen through the filter {}; residuals weighted by the noise level of each sensor",
                errors.join(", ")
            );
        }
        fit.iterations += refined.iterations;
        fit.evaluations += refined.evaluations;
        fit.stop_reason = refined.stop_reason;
        let before = bounds_remark(&unrefined, &fit.active_bounds);
        // What was held stays named; a zero may have been left.
        fit.active_bounds.retain(|name| refined.free.iter().all(|p| p.name != *name));
        let stopped = refined.free.iter().zip(&refined.on_bound).filter(|(_, held)| **held).map(|(p, _)| p.name);
        fit.active_bounds.extend(stopped);
        candidate.notes.retain(|note| Some(note) != before.as_ref());
        candidate.notes.extend(bounds_remark(&candidate.model, &fit.active_bounds));
    }
}
