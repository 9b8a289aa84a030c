//! Whether what a record leaves open is felt in impacts at other speeds.

use crumple_lumped::{HORIZON_S, Structure, structure_of};
use crumple_stage::records::CandidateV1;

/// Speeds over the tested one at which predictions are asked for: 40 and 64 km/h after 56.
const SPEEDS: [f64; 2] = [40.0 / 56.0, 64.0 / 56.0];
/// A speed so far below the slowest test, or further, is not held fast by it.
const BETWEEN: f64 = 0.95;
/// Factors by which an open parameter may be off.
const FACTORS: [f64; 2] = [0.5, 2.0];
/// Relative change of a crush that counts: half of what a prediction at these speeds is to be right to at best.
const FELT: f64 = 0.01;

/// Whether the crush at other speeds, over that in the fastest of the tests at these speeds, m/s, changes by more than
/// 1 % where this parameter is half or double. What it changes in the test itself the record holds fast: the other
/// parameters make up for it as their correlations say, within the same factors. A speed between those of two tests is
/// not asked: they hold it fast.
///
/// All crushes of a linear model go as the speed: nothing is felt of what is open in it.
pub fn is_felt(record: &CandidateV1, name: &str, tested_m_per_s: &[f64]) -> bool {
    let speed = tested_m_per_s.iter().copied().fold(0.0, f64::max);
    let slowest = tested_m_per_s.iter().copied().fold(speed, f64::min);
    let asked: Vec<f64> =
        SPEEDS.iter().map(|share| share * speed).filter(|v| *v > speed || *v < BETWEEN * slowest).collect();
    let along = compensation(record, name);
    let shares = |factor: f64| -> Option<Vec<f64>> {
        let mut parameters = record.parameters.clone();
        *parameters.get_mut(name)? *= factor;
        for (other, share) in &along {
            let value = parameters.get_mut(*other)?;
            *value *= factor.powf(*share).clamp(FACTORS[0], FACTORS[1]);
        }
        let structure = structure_of(&record.model, &parameters).ok()?.with_trends_beyond();
        let tested = crush(&structure, speed)?;
        asked.iter().map(|speed| Some(crush(&structure, *speed)? / tested)).collect()
    };
    let Ok(structure) = structure_of(&record.model, &record.parameters) else { return true };
    if structure.is_linear() {
        return crush(&structure, speed).is_none();
    }
    let Some(own) = shares(1.0) else { return true };
    FACTORS.iter().any(|factor| {
        let changed = shares(*factor);
        changed.is_none_or(|changed| own.iter().zip(&changed).any(|(own, changed)| (changed / own - 1.0).abs() > FELT))
    })
}

/// By how much the logarithms of the other parameters follow that of this one in the least sum of squares: `rho_jk
/// s_j/s_k` with relative standard deviations `s`; none where nobody says how sure they are.
fn compensation<'a>(record: &'a CandidateV1, name: &str) -> Vec<(&'a str, f64)> {
    let Some(known) = &record.uncertainty else { return Vec::new() };
    let deviation = |name: &str| {
        let (value, deviation) = (record.parameters.get(name)?.abs(), known.standard_deviation.get(name)?);
        Some(deviation / value).filter(|relative| relative.is_finite() && *relative > 0.0)
    };
    let place = known.order.iter().position(|other| other == name);
    let Some((place, own)) = place.zip(deviation(name)) else { return Vec::new() };
    let others = known.order.iter().enumerate().filter(|(k, _)| *k != place);
    let share = |(k, other): (usize, &'a String)| {
        let correlation = known.correlation.get(place)?.get(k)?;
        Some((other.as_str(), correlation * deviation(other)? / own)).filter(|(_, share)| share.is_finite())
    };
    others.filter_map(share).collect()
}

fn crush(structure: &Structure, speed: f64) -> Option<f64> {
    structure.events(speed, HORIZON_S).ok()?.last()?.dynamic_crush_m.filter(|crush| *crush > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_stage::records::UncertaintyV1;

    fn record(model: &str, parameters: &[(&str, f64)]) -> CandidateV1 {
        CandidateV1 {
            model: model.to_owned(),
            method: "direct-fit".to_owned(),
            parameters: parameters.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
            physical: true,
            equivalent_to: None,
            fit: None,
            uncertainty: None,
            notes: Vec::new(),
        }
    }

    #[test]
    fn nothing_of_a_linear_model_is_felt_and_a_knot_is() {
        let kelvin = [("mass_kg", 1e3), ("stiffness_n_per_m", 4e5), ("damping_n_s_per_m", 8e3)];
        let kelvin = record("kelvin", &kelvin);
        assert!(!is_felt(&kelvin, "stiffness_n_per_m", &[15.0]) && !is_felt(&kelvin, "damping_n_s_per_m", &[15.0]));
        // A spring that stiffens with the crush.
        let values = [
            ("m1_kg", 1e3),
            ("k1_knot1_n_per_m", 2e5),
            ("k1_knot2_m", 0.6),
            ("k1_knot2_n_per_m", 6e5),
            ("c1_n_s_per_m", 0.0),
        ];
        let stiffening = record("chain", &values);
        assert!(is_felt(&stiffening, "k1_knot1_n_per_m", &[15.0]) && is_felt(&stiffening, "k1_knot2_n_per_m", &[15.0]));
        assert!(is_felt(&stiffening, "nothing", &[15.0]));
    }

    #[test]
    fn the_others_follow_by_their_correlations_and_what_two_tests_hold_is_not_asked() {
        let values = [
            ("mass_kg", 1e3),
            ("knot1_n", 2e5),
            ("knot2_n", 2e5),
            ("knot3_n", 2e5),
            ("knot1_m", 0.02),
            ("knot2_m", 0.03),
            ("knot3_m", 0.5),
            ("unloading_stiffness_n_per_m", 4e7),
            ("rate_s_per_m", 0.0),
        ];
        let mut curve = record("force-deflection", &values);
        assert!(is_felt(&curve, "knot1_n", &[15.0]));
        let names = ["knot1_n", "knot2_n"].map(str::to_owned);
        let deviations = names.iter().cloned().zip([1e5, 5e4]).collect();
        // A relative error of 0.5 and one of 0.25 that go against each other at 0.4 of their sizes.
        curve.uncertainty = Some(UncertaintyV1 {
            standard_deviation: deviations,
            order: names.to_vec(),
            correlation: vec![vec![1.0, -0.4], vec![-0.4, 1.0]],
            ..UncertaintyV1::default()
        });
        assert_eq!(compensation(&curve, "knot1_n"), [("knot2_n", -0.2)]);
        assert_eq!(compensation(&curve, "knot2_n"), [("knot1_n", -0.8)]);
        assert_eq!(compensation(&curve, "knot3_n"), []);
        // 40 km/h lies between the tests at 36 and 54; beyond the faster one the last knot decides.
        assert!(is_felt(&curve, "knot3_n", &[15.0, 10.0]));
    }
}
