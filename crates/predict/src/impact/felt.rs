//! The deceleration over the energy that a vehicle has taken, of a record or of a model in its own test.

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
