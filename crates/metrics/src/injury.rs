//! Injury criteria that need more than a linear acceleration: BrIC of the head's rotation, Nij of the upper neck.

use crumple_signal::Sampled;

use crate::Metric;
use crate::metric::definitions::{BRIC, NIJ};

/// Critical angular velocities about x, y and z, rad/s: the averages of those by cumulative strain damage and by
/// maximum principal strain (E. G. Takhounts et al., *Development of Brain Injury Criteria (BrIC)*, Stapp Car Crash
/// Journal 57, 2013).
const CRITICAL_RAD_PER_S: [f64; 3] = [66.25, 56.45, 42.87];
/// From the upper load cell of a Hybrid III neck down to the occipital condyles, m (SAE J1733).
const LEVER_M: f64 = 0.017_78;

/// Brain injury criterion of the head's angular velocities about x, y and z, rad/s, each behind CFC 60: the root of the
/// sum of the squares of their largest sizes over the critical ones, whenever they occur. Absent without any; a lower
/// bound where an axis is missing.
pub fn bric(rates: [Option<&Sampled>; 3]) -> Metric {
    let largest = |rate: &Sampled| rate.samples().iter().fold(0.0_f64, |largest, w| largest.max(w.abs()));
    let shares = rates.iter().zip(CRITICAL_RAD_PER_S).filter_map(|(rate, critical)| Some(largest((*rate)?) / critical));
    let shares: Vec<f64> = shares.collect();
    if shares.is_empty() {
        return Metric::absent(&BRIC, "no angular velocity of the head is measured");
    }
    let metric = Metric::with_value(&BRIC, shares.iter().map(|share| share * share).sum::<f64>().sqrt());
    match shares.len() {
        3 => metric,
        axes => metric.as_lower_bound(&format!("a lower bound: of {axes} of three axes alone")),
    }
}

/// The dummy that a neck is of, with its critical forces and moments (FMVSS 208 S6.6).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dummy {
    /// Hybrid III 50 % male.
    Male50,
    /// Hybrid III 5 % female.
    Female5,
}

impl Dummy {
    /// Critical tension and compression, N, flexion and extension, N·m.
    fn critical(self) -> [f64; 4] {
        match self {
            Self::Male50 => [6806.0, 6160.0, 310.0, 135.0],
            Self::Female5 => [4287.0, 3880.0, 155.0, 67.0],
        }
    }
}

/// Upper neck: axial force and shear, N, moment about y, N·m, on one grid, signs of SAE J211 (tension, flexion and a
/// head pushed backwards are positive).
#[derive(Debug, Clone, Copy)]
pub struct Neck<'a> {
    /// Along z.
    pub axial_n: &'a Sampled,
    /// Along x.
    pub shear_n: &'a Sampled,
    /// About y, at the load cell.
    pub moment_n_m: &'a Sampled,
}

/// Largest of the four neck criteria `Fz/Fzc + My/Myc` from tension or compression and flexion or extension at one
/// time, `My` at the occipital condyles: that of the load cell less 17.78 mm times the shear. Absent for waves on
/// other grids.
pub fn nij(neck: Neck<'_>, dummy: Dummy) -> Metric {
    let Neck { axial_n, shear_n, moment_n_m } = neck;
    let grid = |wave: &Sampled| (wave.t0_s(), wave.dt_s(), wave.len());
    if [shear_n, moment_n_m].iter().any(|wave| grid(wave) != grid(axial_n)) {
        return Metric::absent(&NIJ, "forces and moment of the neck are on different time grids");
    }
    let [tension, compression, flexion, extension] = dummy.critical();
    let forces = axial_n.samples().iter().zip(shear_n.samples()).zip(moment_n_m.samples());
    let at = forces.map(|((axial, shear), moment)| {
        let moment = moment - LEVER_M * shear;
        let (force, way) =
            if *axial >= 0.0 { (axial / tension, "tension") } else { (-axial / compression, "compression") };
        let (bending, side) =
            if moment >= 0.0 { (moment / flexion, "flexion") } else { (-moment / extension, "extension") };
        (force + bending, way, side)
    });
    let largest = at.enumerate().reduce(|a, b| if b.1.0 > a.1.0 { b } else { a });
    let Some((k, (value, way, side))) = largest else { return Metric::absent(&NIJ, "no samples") };
    let time_s = axial_n.time_s(k);
    let name = match dummy {
        Dummy::Male50 => "Hybrid III 50 %",
        Dummy::Female5 => "Hybrid III 5 %",
    };
    Metric::with_value(&NIJ, value).over(time_s, time_s).remarked(&format!("{way} and {side}, {name}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(samples: &[f64]) -> Sampled {
        Sampled::new(0.0, 1e-4, samples.to_vec()).unwrap()
    }

    /// By hand: the three critical values at different times make the root of three.
    #[test]
    fn bric_takes_each_axis_at_its_own_time() {
        let [x, y, z] = [wave(&[66.25, 0.0, 0.0]), wave(&[0.0, -56.45, 0.0]), wave(&[0.0, 0.0, 42.87])];
        assert!((bric([Some(&x), Some(&y), Some(&z)]).value.unwrap() - 3.0_f64.sqrt()).abs() < 1e-12);
        let two = bric([Some(&x), None, Some(&z)]);
        assert!((two.value.unwrap() - 2.0_f64.sqrt()).abs() < 1e-12 && two.is_lower_bound);
        assert_eq!(bric([None; 3]).value, None);
    }

    /// By hand: half of the critical tension and half of the critical extension are 1.
    #[test]
    fn nij_is_the_largest_of_four() {
        let axial = wave(&[0.0, 3403.0, -3080.0]);
        let shear = wave(&[0.0, 1000.0, 0.0]);
        // 17.78 N·m of the shear are taken off: -67.5 remain at the second sample.
        let moment = wave(&[31.0, -67.5 + 17.78, 15.5]);
        let neck = Neck { axial_n: &axial, shear_n: &shear, moment_n_m: &moment };
        let found = nij(neck, Dummy::Male50);
        assert!((found.value.unwrap() - 1.0).abs() < 1e-12, "{found:?}");
        assert!(found.definition.ends_with("tension and extension, Hybrid III 50 %"), "{}", found.definition);
        let small = nij(neck, Dummy::Female5).value.unwrap();
        assert!((small - (3403.0 / 4287.0 + 67.5 / 67.0)).abs() < 1e-12);
        let other = wave(&[0.0]);
        assert_eq!(nij(Neck { shear_n: &other, ..neck }, Dummy::Male50).value, None);
    }
}
