//! Impacts at other speeds: the record's own crush in slower ones, and what a parameter that is not identifiable
//! changes.

use crumple_lumped::{HORIZON_S, Structure};

use crate::Candidate;

/// Slower impacts, over the tested speed: 34 to 53 km/h after 56.
const SHARES: std::ops::RangeInclusive<u32> = 60..=95;
/// Between two of them, percent.
const STEP: usize = 5;

/// The largest relative error of the crush at 0.60 to 0.95 of the tested speed, of a model beside its record, both
/// displacements from contact to dynamic crush, m, `dt_s` apart; `None` where one of them does not slow down that far.
///
/// One mass on a plastic structure without rate effect obeys `v² = v0² - 2 E(x)/m`, whatever its curve: an impact at
/// `s v0` ends where the velocity of the tested one has fallen to `v0 sqrt(1 - s²)`. So the record holds its own crush
/// at every lower speed, and a curve that misses these predicts them wrongly. A rate effect moves model and record
/// alike.
pub fn crush_error_at_lower_speeds(record_m: &[f64], model_m: &[f64], dt_s: f64, impact_speed: f64) -> Option<f64> {
    let mut largest = 0.0_f64;
    for percent in SHARES.step_by(STEP) {
        let velocity = impact_speed * (1.0 - (f64::from(percent) / 100.0).powi(2)).sqrt();
        let of_record = place_of_velocity(record_m, dt_s, velocity)?;
        largest = largest.max((place_of_velocity(model_m, dt_s, velocity)? / of_record - 1.0).abs());
    }
    largest.is_finite().then_some(largest)
}

/// Where a motion has slowed down to a velocity, m, straight between samples; velocities by central differences.
fn place_of_velocity(displacement_m: &[f64], dt_s: f64, velocity: f64) -> Option<f64> {
    let mut before: Option<(f64, f64)> = None;
    for three in displacement_m.windows(3) {
        let now = ((three[2] - three[0]) / (2.0 * dt_s), three[1]);
        if now.0 <= velocity {
            let (faster, at) = before?;
            return Some(at + (now.1 - at) * (faster - velocity) / (faster - now.0));
        }
        before = Some(now);
    }
    None
}

// Whether a parameter that the record does not identify changes the crush.

/// Speeds over the tested one at which predictions are asked for: 40 and 64 km/h after 56.
const SPEEDS: [f64; 2] = [40.0 / 56.0, 64.0 / 56.0];
/// A speed so far below the slowest test, or further, is not held fast by it.
const BETWEEN: f64 = 0.95;
/// Factors by which such a parameter may be off.
const FACTORS: [f64; 2] = [0.5, 2.0];
/// Relative change of a crush that counts: half of what a prediction at these speeds is to be right to at best.
const COUNTS: f64 = 0.01;

/// Of parameters of these names those with which the crush at other speeds, over that in the fastest of the tests at
/// these speeds, m/s, changes by more than 1 % where one of them is half or double. What it changes in the test itself
/// the record holds fast: the other parameters make up for it as their correlations say, within the same factors. A
/// speed between those of two tests is not asked: they hold it fast.
///
/// All crushes of a linear model go as the speed: no parameter of it changes a prediction.
pub fn affecting_predictions<'n>(
    candidate: &Candidate,
    names: impl Iterator<Item = &'n str>,
    tested_m_per_s: &[f64],
) -> Vec<String> {
    let mut names = names.peekable();
    if names.peek().is_none() {
        return Vec::new();
    }
    let model = &candidate.model;
    let speed = tested_m_per_s.iter().copied().fold(0.0, f64::max);
    let slowest = tested_m_per_s.iter().copied().fold(speed, f64::min);
    let asked: Vec<f64> =
        SPEEDS.iter().map(|share| share * speed).filter(|v| *v > speed || *v < BETWEEN * slowest).collect();
    let shares = |changes: Vec<(&str, f64)>| -> Option<Vec<f64>> {
        let structure = model.changed(changes)?.structure().ok()?.with_trends_beyond();
        let tested = crush(&structure, speed)?;
        asked.iter().map(|speed| Some(crush(&structure, *speed)? / tested)).collect()
    };
    let structure = model.structure().ok();
    if let Some(linear) = structure.as_ref().filter(|structure| structure.is_linear())
        && crush(linear, speed).is_some()
    {
        return Vec::new();
    }
    let own = structure.and_then(|_| shares(Vec::new()));
    let affects = |name: &&str| {
        let (Some(own), Some(value)) = (&own, model.value(name)) else { return true };
        let along = compensation(candidate, name);
        FACTORS.iter().any(|factor| {
            let compensating = |share: f64| factor.powf(share).clamp(FACTORS[0], FACTORS[1]);
            let others = along.iter().map(|(other, share)| Some((*other, model.value(other)? * compensating(*share))));
            let changes: Option<Vec<(&str, f64)>> =
                std::iter::once(Some((*name, value * factor))).chain(others).collect();
            let changed = changes.and_then(shares);
            let counts = |(own, changed): (&f64, &f64)| (changed / own - 1.0).abs() > COUNTS;
            changed.is_none_or(|changed| own.iter().zip(&changed).any(counts))
        })
    };
    names.filter(affects).map(str::to_owned).collect()
}

/// By how much the logarithms of the other parameters follow that of this one in the least sum of squares: `rho_jk
/// s_j/s_k` with relative standard deviations `s`; none where nobody says how sure they are.
fn compensation<'a>(candidate: &'a Candidate, name: &str) -> Vec<(&'a str, f64)> {
    let Some(assessed) = &candidate.assessed else { return Vec::new() };
    let known = &assessed.assessment;
    let deviation = |name: &str| {
        let (value, deviation) = (candidate.model.value(name)?.abs(), known.standard_deviation.get(name)?);
        Some(deviation / value).filter(|relative| relative.is_finite() && *relative > 0.0)
    };
    let place = known.parameters.iter().position(|other| other == name);
    let Some((place, own)) = place.zip(deviation(name)) else { return Vec::new() };
    let others = known.parameters.iter().enumerate().filter(|(k, _)| *k != place);
    let share = |(k, other): (usize, &'a String)| {
        let correlation = known.correlation.get(place)?.get(k)?;
        Some((other.as_str(), correlation * deviation(other)? / own)).filter(|(_, share)| share.is_finite())
    };
    others.filter_map(share).collect()
}

fn crush(structure: &Structure, speed: f64) -> Option<f64> {
    structure.dynamic_crush_m(speed, HORIZON_S).ok()?.filter(|crush| *crush > 0.0)
}

#[cfg(test)]
mod tests {
    use crumple_lumped::{Chain, CrushedStructure, Kelvin, Model, PiecewiseLinear};

    use super::*;
    use crate::{Assessed, Assessment, Method};

    const DT_S: f64 = 1e-4;

    /// Crush of a linear spring goes as the speed: at `s v0` it is `s C`.
    fn linear(omega: f64) -> Vec<f64> {
        let samples = (0.5 * std::f64::consts::PI / omega / DT_S) as u32;
        (0..=samples).map(|k| 15.0 / omega * (omega * f64::from(k) * DT_S).sin()).collect()
    }

    #[test]
    fn the_record_of_a_linear_spring_holds_its_crush_at_lower_speeds() {
        for percent in SHARES.step_by(STEP) {
            let share = f64::from(percent) / 100.0;
            let place = place_of_velocity(&linear(25.0), DT_S, 15.0 * (1.0 - share * share).sqrt()).unwrap();
            // Central differences and straight lines between samples: both of the order of (25 DT)².
            assert!((place - share * 15.0 / 25.0).abs() < 1e-5, "{place}");
        }
    }

    #[test]
    fn a_softer_spring_errs_by_the_root_of_the_ratio_and_a_motion_that_goes_on_is_not_compared() {
        let error = crush_error_at_lower_speeds(&linear(25.0), &linear(20.0), DT_S, 15.0).unwrap();
        assert!((error - 0.25).abs() < 1e-4, "{error}");
        let steady: Vec<f64> = (0..700).map(|k| 15.0 * f64::from(k) * DT_S).collect();
        assert_eq!(crush_error_at_lower_speeds(&linear(25.0), &steady, DT_S, 15.0), None);
        assert_eq!(crush_error_at_lower_speeds(&linear(25.0)[..2], &linear(25.0), DT_S, 15.0), None);
    }

    fn candidate(model: Model) -> Candidate {
        Candidate::new(model, Method::DirectFit, 1, Vec::new())
    }

    #[test]
    fn no_parameter_of_a_linear_model_changes_a_prediction_and_a_knot_does() {
        let kelvin = Kelvin { mass_kg: 1e3, stiffness_n_per_m: 4e5, damping_n_s_per_m: 8e3 };
        let kelvin = candidate(Model::Kelvin(kelvin));
        let names = ["stiffness_n_per_m", "damping_n_s_per_m"];
        assert_eq!(affecting_predictions(&kelvin, names.into_iter(), &[15.0]), [""; 0]);
        // A spring that stiffens with the crush.
        let spring = PiecewiseLinear::new(&[(0.0, 2e5), (0.6, 6e5)]).unwrap();
        let chain = Chain::new(&[1e3], &[spring], &[PiecewiseLinear::constant(0.0)]).unwrap();
        let stiffening = candidate(Model::Chain(chain));
        let names = ["k1_knot1_n_per_m", "k1_knot2_n_per_m", "nothing"];
        assert_eq!(affecting_predictions(&stiffening, names.into_iter(), &[15.0]), names);
    }

    #[test]
    fn the_others_follow_by_their_correlations_and_what_two_tests_hold_is_not_asked() {
        let knots = [(0.02, 2e5), (0.03, 2e5), (0.5, 2e5)];
        let mut curve = candidate(Model::ForceDeflection(CrushedStructure::new(1e3, &knots, 4e7, 0.0).unwrap()));
        assert_eq!(affecting_predictions(&curve, ["knot1_n"].into_iter(), &[15.0]), ["knot1_n"]);
        let names = ["knot1_n", "knot2_n"].map(str::to_owned);
        // A relative error of 0.5 and one of 0.25 that go against each other at 0.4 of their sizes.
        let assessment = Assessment {
            standard_deviation: names.iter().cloned().zip([1e5, 5e4]).collect(),
            parameters: names.to_vec(),
            correlation: vec![vec![1.0, -0.4], vec![-0.4, 1.0]],
            ..Assessment::default()
        };
        curve.assessed = Some(Assessed { assessment, propagation: None, repeated: "fit", front_mass_uncertainty: 0.0 });
        assert_eq!(compensation(&curve, "knot1_n"), [("knot2_n", -0.2)]);
        assert_eq!(compensation(&curve, "knot2_n"), [("knot1_n", -0.8)]);
        assert_eq!(compensation(&curve, "knot3_n"), []);
        // 40 km/h lies between the tests at 36 and 54; beyond the faster one the last knot decides.
        assert_eq!(affecting_predictions(&curve, ["knot3_n"].into_iter(), &[15.0, 10.0]), ["knot3_n"]);
    }
}
