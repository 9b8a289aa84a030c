//! A test that was made: what it measured, and the deceleration over the energy that the vehicle has taken.

use crumple_metrics::{Iso18571Options, iso18571};
use crumple_signal::Sampled;

use crate::impact::outcome::{Outcome, Quantity, Wave, through_cfc_60};

/// Relative rounding of an energy.
const ROUNDING: f64 = 1e-9;
/// Energies at which two of them are compared.
const COMPARED: u32 = 100;

/// What a vehicle feels, through CFC 60, over the energy that it has taken: of a plastic structure the force over its
/// work, whatever the speed.
#[derive(Debug, Clone, PartialEq)]
pub struct FeltOverEnergy {
    /// In the order of time.
    points: Vec<Felt>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Felt {
    /// Energy per mass, m²/s²; it does not fall.
    taken: f64,
    /// Deceleration, m/s².
    now: f64,
    /// The largest until then, m/s².
    largest: f64,
}

impl FeltOverEnergy {
    /// From a velocity and the deceleration through CFC 60 at the same instants from contact on, m/s and m/s². `None`:
    /// there is no deceleration, or the vehicle does not stop.
    pub(crate) fn new(speed: f64, velocity: &[f64], deceleration: &[f64]) -> Option<Self> {
        let mut last = Felt::default();
        let mut stops = false;
        let mut points = Vec::with_capacity(velocity.len());
        for (v, now) in velocity.iter().zip(deceleration) {
            stops |= *v <= 0.0;
            let taken = 0.5 * if stops { speed * speed } else { speed * speed - v * v };
            last = Felt { taken: last.taken.max(taken), now: *now, largest: last.largest.max(*now) };
            points.push(last);
        }
        (stops && last.largest > 0.0).then_some(Self { points })
    }

    /// The last instant at which no more than this energy per mass is taken.
    fn at(&self, energy: f64) -> Option<&Felt> {
        let beyond = self.points.partition_point(|felt| felt.taken <= energy * (1.0 + ROUNDING));
        self.points.get(beyond.checked_sub(1)?)
    }

    /// The largest deceleration until this energy per mass is taken, m/s²; beyond the test that of the test. `None`:
    /// nothing has been felt yet.
    pub(crate) fn largest_until(&self, energy: f64) -> Option<f64> {
        self.at(energy).map(|felt| felt.largest).filter(|largest| *largest > 0.0)
    }

    /// The mean deceleration over the last tenth of the energy of the test, m/s².
    pub(crate) fn at_the_end(&self) -> Option<f64> {
        let last: Vec<f64> = self.compared().skip(COMPARED as usize * 9 / 10).map(|(_, felt)| felt).collect();
        let mean = last.iter().sum::<f64>() / last.len() as f64;
        Some(mean).filter(|mean| *mean > 0.0)
    }

    /// Root mean square of the difference of the decelerations at equal energies, over the mean of this one.
    pub(crate) fn misfit(&self, other: &Self) -> Option<f64> {
        let pairs: Vec<(f64, f64)> = self.compared().filter_map(|(e, own)| Some((own, other.at(e)?.now))).collect();
        over_the_mean(&pairs)
    }

    /// The same from the straight line over the energy that fits best: waves of a structure that folds, whose phase
    /// nobody knows beyond the test.
    pub(crate) fn waves(&self) -> Option<f64> {
        let points: Vec<(f64, f64)> = self.compared().collect();
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
        let (energy, felt) = (mean(&|point| point.0), mean(&|point| point.1));
        let slope = mean(&|(e, a)| (e - energy) * (a - felt)) / mean(&|(e, _)| (e - energy).powi(2));
        over_the_mean(&points.iter().map(|(e, a)| (*a, felt + slope * (e - energy))).collect::<Vec<_>>())
    }

    /// Energies up to that of the test, evenly, with the deceleration at each.
    fn compared(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let all = self.points.last().map_or(0.0, |felt| felt.taken);
        let energies = (1..COMPARED).map(move |k| f64::from(k) / f64::from(COMPARED) * all);
        energies.filter_map(|energy| Some((energy, self.at(energy)?.now)))
    }
}

/// Root mean square of the differences over the mean of the first.
fn over_the_mean(pairs: &[(f64, f64)]) -> Option<f64> {
    let squares: f64 = pairs.iter().map(|(one, other)| (one - other).powi(2)).sum();
    let mean = pairs.iter().map(|(one, _)| one).sum::<f64>() / pairs.len() as f64;
    (mean > 0.0).then(|| (squares / pairs.len() as f64).sqrt() / mean)
}

/// A test that was made.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MadeTest {
    /// Dynamic crush, m.
    pub dynamic_crush_m: Option<f64>,
    /// Its time, s after time zero.
    pub time_of_dynamic_crush_s: Option<f64>,
    /// Change of velocity up to the rebound, m/s; `None` where the record ends before it does, so that it is a lower
    /// bound.
    pub delta_v_m_per_s: Option<f64>,
    /// Coefficient of restitution; `None` likewise.
    pub coefficient_of_restitution: Option<f64>,
    /// Standard deviations of these by its inputs, where they are known.
    pub deviations: Vec<(Quantity, f64)>,
    /// Largest deceleration, m/s².
    pub peak_m_per_s2: Option<f64>,
    /// Acceleration of the compartment as filtered, counted from time zero.
    pub acceleration: Option<Sampled>,
    /// What it felt over the energy it had taken.
    pub felt: Option<FeltOverEnergy>,
}

impl MadeTest {
    /// What it says of a quantity.
    pub fn get(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::DynamicCrush => self.dynamic_crush_m,
            Quantity::TimeOfDynamicCrush => self.time_of_dynamic_crush_s,
            Quantity::DeltaV => self.delta_v_m_per_s,
            Quantity::Restitution => self.coefficient_of_restitution,
            Quantity::Peak => self.peak_m_per_s2,
            _ => None,
        }
    }

    /// The standard deviation that a number has that is known as well as the one measured, in proportion to it.
    pub(crate) fn deviation_of(&self, quantity: Quantity, value: f64) -> f64 {
        let known = self.deviations.iter().find(|(other, _)| *other == quantity).zip(self.get(quantity));
        known.map_or(0.0, |((_, deviation), measured)| match measured == 0.0 {
            true => *deviation,
            false => deviation * (value / measured).abs(),
        })
    }

    /// The test with what it felt over the energy it had taken, from its velocity, counted from time zero; `filtered`:
    /// its acceleration was through CFC 60 already.
    #[must_use]
    pub fn with_velocity(self, speed_m_per_s: f64, velocity: &Sampled, filtered: bool) -> Self {
        let dt_s = velocity.dt_s();
        let first = (-velocity.t0_s() / dt_s - 1e-6).ceil().max(0.0) as usize;
        let velocity = velocity.samples().get(first..).unwrap_or_default();
        let deceleration: Vec<f64> = velocity.windows(2).map(|pair| (pair[0] - pair[1]) / dt_s).collect();
        let deceleration = if filtered { Some(deceleration) } else { through_cfc_60(&deceleration, dt_s) };
        let felt = deceleration.and_then(|felt| FeltOverEnergy::new(speed_m_per_s, velocity.get(1..)?, &felt));
        Self { felt, ..self }
    }

    /// Predicted less measured, percent of the measured.
    pub fn error_percent(&self, outcome: &Outcome, quantity: Quantity) -> Option<f64> {
        let (predicted, measured) = (outcome.get(quantity)?, self.get(quantity)?);
        (measured != 0.0).then(|| 100.0 * (predicted / measured - 1.0))
    }

    /// Score of the predicted acceleration by ISO/TS 18571 up to the dynamic crush of the test, through CFC 60 as a
    /// laboratory would filter it; the record is interpolated linearly to the instants of the prediction, 10 kHz.
    /// `None`: one of both is too short.
    pub fn iso18571_score(&self, wave: &Wave) -> Option<f64> {
        let measured = self.acceleration.as_ref()?;
        let predicted = through_cfc_60(&wave.compartment()?.acceleration_m_per_s2, wave.dt_s)?;
        let samples = (self.time_of_dynamic_crush_s? / wave.dt_s) as usize + 1;
        let record: Vec<f64> = (0..samples).map_while(|k| measured.at(k as f64 * wave.dt_s)).collect();
        let predicted = predicted.get(..record.len())?.to_vec();
        let grid = |samples| Sampled::new(0.0, wave.dt_s, samples).ok();
        iso18571(&grid(record)?, &grid(predicted)?, &Iso18571Options::default()).ok()?.overall
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::outcome::at_wall;
    use crumple_lumped::{Elastoplastic, Model};

    /// A linear spring up to a quarter of its period and beyond the stop, times `factor`.
    fn linear(omega: f64, factor: f64) -> FeltOverEnergy {
        let phase = |k: u32| omega * f64::from(k) * 1e-4;
        let samples = (0.55 * std::f64::consts::PI / omega / 1e-4) as u32;
        let velocity: Vec<f64> = (0..samples).map(|k| 15.0 * phase(k).cos()).collect();
        let deceleration: Vec<f64> = (0..samples).map(|k| factor * 15.0 * omega * phase(k).sin()).collect();
        FeltOverEnergy::new(15.0, &velocity, &deceleration).unwrap()
    }

    #[test]
    fn the_force_of_a_spring_is_the_root_of_its_work() {
        let felt = linear(20.0, 1.0);
        for energy in [5.0_f64, 50.0, 100.0] {
            // One sample of 0.1 ms is 0.002 rad: at 5 m²/s², 0.21 rad, 1 %.
            let expected = 20.0 * (2.0 * energy).sqrt();
            assert!((felt.largest_until(energy).unwrap() / expected - 1.0).abs() < 0.01, "{energy}");
        }
        // All of it is taken at the stop; no more is there beyond.
        assert!((felt.largest_until(112.5).unwrap() / 300.0 - 1.0).abs() < 1e-5);
        assert_eq!(felt.largest_until(200.0), felt.largest_until(112.5));
        assert_eq!(felt.largest_until(0.0), None);
    }

    #[test]
    fn a_misfit_is_a_share_of_the_mean_and_a_straight_line_has_no_waves() {
        let (felt, higher) = (linear(20.0, 1.0), linear(20.0, 1.1));
        assert_eq!(felt.misfit(&felt), Some(0.0));
        // A tenth of the root of E: its root mean square over its mean is (1/2)^0.5 over 2/3.
        assert!((felt.misfit(&higher).unwrap() - 0.1 * 0.5_f64.sqrt() * 1.5).abs() < 1e-3);
        let velocity: Vec<f64> = (0..=1000).map(|k| 15.0 - 0.015 * f64::from(k)).collect();
        let rising: Vec<f64> = velocity.iter().map(|v| 100.0 + 112.5 - 0.5 * v * v).collect();
        assert!(FeltOverEnergy::new(15.0, &velocity, &rising).unwrap().waves().unwrap() < 1e-3);
        assert!(felt.waves().unwrap() > 0.05);
        assert_eq!(FeltOverEnergy::new(15.0, &velocity[..900], &rising), None);
    }

    #[test]
    fn a_test_that_was_the_prediction_scores_1_and_another_less() {
        let structure = |k: f64| {
            let model = Elastoplastic {
                mass_kg: 1000.0,
                loading_stiffness_n_per_m: k,
                unloading_stiffness_n_per_m: 1.6e7,
                release: true,
            };
            Model::Elastoplastic(model).structure().unwrap()
        };
        let (outcome, wave) = at_wall(&structure(4e5), 15.0, 1e-4).unwrap();
        let filtered = through_cfc_60(&wave.compartment().unwrap().acceleration_m_per_s2, 1e-4).unwrap();
        let made = MadeTest {
            dynamic_crush_m: outcome.get(Quantity::DynamicCrush),
            time_of_dynamic_crush_s: outcome.get(Quantity::TimeOfDynamicCrush),
            coefficient_of_restitution: outcome.get(Quantity::Restitution),
            peak_m_per_s2: outcome.get(Quantity::Peak),
            acceleration: Sampled::new(0.0, 1e-4, filtered).ok(),
            ..MadeTest::default()
        };
        assert_eq!(made.error_percent(&outcome, Quantity::DynamicCrush), Some(0.0));
        // Equal curves rate 1; interpolation between equal instants is a rounding.
        assert!((made.iso18571_score(&wave).unwrap() - 1.0).abs() < 1e-6);
        let (stiffer, other) = at_wall(&structure(5e5), 15.0, 1e-4).unwrap();
        // Crush goes as one over the root of the stiffness.
        let error = made.error_percent(&stiffer, Quantity::DynamicCrush).unwrap();
        assert!((error - 100.0 * (0.8_f64.sqrt() - 1.0)).abs() < 1e-6, "{error}");
        assert!(made.iso18571_score(&other).unwrap() < 0.95);
        assert_eq!(MadeTest::default().iso18571_score(&wave), None);
    }
}
