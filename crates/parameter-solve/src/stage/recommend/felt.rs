//! Whether what a record leaves open is felt in impacts at other speeds.

use crumple_lumped::{Structure, structure_of};
use crumple_stage::records::CandidateV1;

/// A crash is over in two seconds or never.
const HORIZON_S: f64 = 2.0;
/// Speeds over the tested one at which predictions are asked for: 40 and 64 km/h after 56.
const SPEEDS: [f64; 2] = [40.0 / 56.0, 64.0 / 56.0];
/// Factors by which an open parameter may be off.
const FACTORS: [f64; 2] = [0.5, 2.0];
/// Relative change of a crush that counts: half of what a prediction at these speeds is to be right to at best.
const FELT: f64 = 0.01;

/// Whether the crush at other speeds, over that in the test, changes by more than 1 % where this parameter is half or
/// double. What it changes in the test itself the record holds fast, and the other parameters make up for.
///
/// All crushes of a linear model go as the speed: nothing is felt of what is open in it.
pub fn is_felt(record: &CandidateV1, name: &str, speed: f64) -> bool {
    let shares = |factor: f64| -> Option<[f64; 2]> {
        let mut parameters = record.parameters.clone();
        *parameters.get_mut(name)? *= factor;
        let structure = structure_of(&record.model, &parameters).ok()?;
        let tested = crush(&structure, speed)?;
        let [slower, faster] = SPEEDS.map(|share| crush(&structure, share * speed));
        Some([slower? / tested, faster? / tested])
    };
    let Some(own) = shares(1.0) else { return true };
    FACTORS.iter().any(|factor| {
        let changed = shares(*factor);
        changed.is_none_or(|changed| own.iter().zip(changed).any(|(own, changed)| (changed / own - 1.0).abs() > FELT))
    })
}

fn crush(structure: &Structure, speed: f64) -> Option<f64> {
    structure.events(speed, HORIZON_S).ok()?.last()?.dynamic_crush_m.filter(|crush| *crush > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert!(!is_felt(&kelvin, "stiffness_n_per_m", 15.0) && !is_felt(&kelvin, "damping_n_s_per_m", 15.0));
        // A spring that stiffens with the crush.
        let values = [
            ("m1_kg", 1e3),
            ("k1_knot1_n_per_m", 2e5),
            ("k1_knot2_m", 0.6),
            ("k1_knot2_n_per_m", 6e5),
            ("c1_n_s_per_m", 0.0),
        ];
        let stiffening = record("chain", &values);
        assert!(is_felt(&stiffening, "k1_knot1_n_per_m", 15.0) && is_felt(&stiffening, "k1_knot2_n_per_m", 15.0));
        assert!(is_felt(&stiffening, "nothing", 15.0));
    }
}
