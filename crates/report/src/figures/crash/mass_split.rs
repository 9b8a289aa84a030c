//! Parameters of the double model over the division of the mass: which divisions a passive structure can have.

use crate::drawing::numbers::KILO;
use crate::drawing::{Axis, Colour, Dash, Figure, Look, Panel, Symbol};
use crate::findings::{
    Ranking, Run,
    mass_divisions::{Divisions, ratio},
};
use crate::words;
use crumple_artifact::records::MatchingSweepV1;

/// Name, panel and value of the four parameters, with their marks where all four are positive and where not.
type Parameter = (&'static str, usize, fn(&MatchingSweepV1) -> f64, [Symbol; 2]);
const PARAMETERS: [Parameter; 4] = [
    ("k1", 0, |s| s.k1_n_per_m, [Symbol::Disc, Symbol::Ring]),
    ("k2", 0, |s| s.k2_n_per_m, [Symbol::Diamond, Symbol::Square]),
    ("c1", 1, |s| s.c1_n_s_per_m, [Symbol::Disc, Symbol::Ring]),
    ("c2", 1, |s| s.c2_n_s_per_m, [Symbol::Diamond, Symbol::Square]),
];

/// See [`Divisions::of_run`] for whose.
pub fn figure(run: &Run, ranking: &Ranking) -> Option<Figure> {
    let divisions = Divisions::of_run(run, ranking)?;
    let used = divisions.m2_kg / divisions.m1_kg;
    let feasible = divisions.feasible_ranges();
    let mut figure = Figure::new("mass-split", "Mass splits that a double model can have");
    let logarithmic = |axis: Axis| Axis { logarithmic: true, ..axis };
    let over_ratio = |title| {
        Panel::new(logarithmic(Axis::new("mass ratio m2/m1 (compartment over chassis)")), logarithmic(Axis::of(title)))
    };
    let mut panels = [("stiffness", "kN/m"), ("damping", "kN·s/m")].map(over_ratio);
    for (place, &(name, panel, value, symbols)) in PARAMETERS.iter().enumerate() {
        for (physical, symbol) in [true, false].into_iter().zip(symbols) {
            // Negative values have no place on a logarithmic axis.
            let points: Vec<[f64; 2]> = (divisions.sweep.iter())
                .filter(|s| s.physical == physical && value(s) > 0.0)
                .map(|s| [ratio(s), KILO * value(s)])
                .collect();
            let sign = if physical { "all four positive" } else { "another is negative" };
            let entry = figure.entry(format!("{name}, {sign}"), Look::marks(Colour::Series(place), symbol), true);
            panels[panel].points(entry, points);
        }
    }
    for panel in &mut panels {
        panel.windows.extend(feasible.iter().map(|(low, high)| [*low, *high]));
        panel.mark(used, "used", Colour::Event, Dash::Dashed);
    }
    figure.caption = caption(&divisions, used, &feasible);
    figure.panels = panels.into();
    Some(figure.tidy())
}

fn caption(divisions: &Divisions, used: f64, feasible: &[(f64, f64)]) -> String {
    let inside = feasible.iter().any(|(low, high)| (*low..=*high).contains(&used));
    let bound = match divisions.largest_mass_ratio {
        Some(bound) => format!("They exist only for m2/m1 up to {}.", words::significant(bound, 3)),
        None => "No division allows them: the identified polynomial is not that of a passive structure.".to_owned(),
    };
    let total = words::significant_quantity(divisions.m1_kg + divisions.m2_kg, 4, "kg");
    let source = &divisions.source;
    let what = if divisions.fitted {
        format!(
            "Parameter sets with the same poles as {source}, at the same total mass, {total}. At another division the \
             poles are kept, the motion is not quite: fit again with --front-mass-fraction to see by how much."
        )
    } else {
        format!("Real solutions of coefficient matching of {source} at the same total mass, {total}.")
    };
    let (used, verb) = (words::significant(used, 3), if inside { "is" } else { "is not" });
    format!(
        "{what} Filled: all four parameters are positive, and such divisions are shaded; negative values have no place \
         on a logarithmic axis. {bound} The assumed split, m2/m1 = {used}, {verb} one of them."
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::CandidateResult;
    use crumple_artifact::records::{CandidateV1, MatchingSweepV1, MatchingV1};

    /// Divisions of 1000 kg of which the first has no positive parameters.
    fn matching() -> MatchingV1 {
        let point = |k: u8| MatchingSweepV1 {
            front_mass_fraction: f64::from(k) / 4.0,
            k1_n_per_m: 1e5,
            k2_n_per_m: 2e5,
            c1_n_s_per_m: if k > 1 { 1e3 } else { -1e3 },
            c2_n_s_per_m: 2e3,
            physical: k > 1,
        };
        MatchingV1 {
            m1_kg: 200.0,
            m2_kg: 800.0,
            polynomial: vec![],
            largest_mass_ratio: Some(2.0),
            roots: vec![],
            solutions: vec![],
            sweep: (1..4).map(point).collect(),
            notes: vec![],
            source: None,
            zeta_of_the_start_per_s2: None,
            coordinates: vec![],
        }
    }

    /// A run whose only candidate is a fitted double model with a quarter of the mass in front.
    fn fitted_run() -> (Run, Ranking) {
        let record: CandidateV1 = serde_json::from_value(serde_json::json!({
            "model": "double-spring-mass-damper", "method": "direct-fit", "physical": true, "equivalent_to": null,
            "notes": [], "uncertainty": null, "parameters": {"m1_kg": 375, "m2_kg": 1125, "k1_n_per_m": 9e5,
                "k2_n_per_m": 1e6, "c1_n_s_per_m": 6e3, "c2_n_s_per_m": 9e3},
            "fit": null, "mass_divisions": {"largest_mass_ratio": 4.5, "sweep": [
                {"front_mass_fraction": 0.2, "k1_n_per_m": 9e5, "k2_n_per_m": 1e6, "c1_n_s_per_m": 6e3,
                 "c2_n_s_per_m": 9e3, "physical": true},
                {"front_mass_fraction": 0.3, "k1_n_per_m": 8e5, "k2_n_per_m": 1e6, "c1_n_s_per_m": 5e3,
                 "c2_n_s_per_m": 9e3, "physical": true}]}
        }))
        .unwrap();
        let id = "double-spring-mass-damper/direct-fit/1".to_owned();
        let ranking = Ranking { order: vec![id.clone()], ..Ranking::default() };
        let candidate = CandidateResult { id, record, ..CandidateResult::default() };
        (Run { candidates: vec![candidate], ..Run::default() }, ranking)
    }

    #[test]
    fn negative_values_are_not_drawn_and_the_used_division_is_named() {
        let run = Run { matchings: vec![("era-4".to_owned(), matching())], ..Run::default() };
        let figure = figure(&run, &Ranking::default()).unwrap();
        // c1 has no hollow points, for they are negative.
        assert_eq!(figure.legend.len(), 7);
        assert!(
            figure.caption.contains("up to 2.00. The assumed split, m2/m1 = 4.00, is not one of them"),
            "{}",
            figure.caption
        );
    }
    #[test]
    fn a_fitted_model_is_drawn_where_coefficient_matching_did_not_run() {
        let (run, ranking) = fitted_run();
        let figure = figure(&run, &ranking).unwrap();
        assert!(figure.caption.starts_with("Parameter sets with the same poles as double spring-mass-damper (fitted)"));
        assert!(figure.caption.ends_with("m2/m1 = 3.00, is one of them."), "{}", figure.caption);
    }
}
