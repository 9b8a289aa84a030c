//! Parameters of the double model over the division of the mass: which divisions a passive structure can have.

use crumple_artifact::records::MatchingSweepV1;
use crumple_drawing::numbers::{KILO, significant};
use crumple_drawing::{Axis, Colour, Dash, Figure, Look, Panel, Symbol};

use crate::results::mass_divisions::{Divisions, ratio};
use crate::{Ranking, Run};

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
    let mut figure = Figure::new("mass-split", "Which divisions of the mass a double model can have");
    let logarithmic = |title: &str| Axis { logarithmic: true, ..Axis::new(title) };
    let mut panels = ["stiffness, kN/m", "damping, kN·s/m"]
        .map(|title| Panel::new(logarithmic("mass ratio m2/m1 (compartment over chassis)"), logarithmic(title)));
    for (place, &(name, panel, value, symbols)) in PARAMETERS.iter().enumerate() {
        for (physical, symbol) in [true, false].into_iter().zip(symbols) {
            // Negative values have no place on a logarithmic axis.
            let points: Vec<[f64; 2]> = (divisions.sweep.iter())
                .filter(|s| s.physical == physical && value(s) > 0.0)
                .map(|s| [ratio(s), KILO * value(s)])
                .collect();
            let name = format!("{name}, {}", if physical { "all four positive" } else { "another is negative" });
            let entry = figure.entry(name, Look::marks(Colour::Series(place), symbol), true);
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
        Some(bound) => format!("They exist only for m2/m1 up to {}.", significant(bound, 3)),
        None => "No division allows them: the identified polynomial is not that of a passive structure.".to_owned(),
    };
    let total = significant(divisions.m1_kg + divisions.m2_kg, 4);
    let what = if divisions.fitted {
        format!(
            "Parameter sets with the same poles as {}, at the same total mass, {total} kg. At another division the \
             poles are kept, the motion is not quite: fit again with --front-mass-fraction to see by how much.",
            divisions.source
        )
    } else {
        format!("Real solutions of coefficient matching of {} at the same total mass, {total} kg.", divisions.source)
    };
    format!(
        "{what} Filled: all four parameters are positive, and such divisions are shaded; negative values have no place \
         on a logarithmic axis. {bound} The division used, m2/m1 = {}, {}.",
        significant(used, 3),
        if inside { "is among them" } else { "is not among them" }
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::mass_divisions::tests::{fitted_run, matching};

    #[test]
    fn negative_values_are_not_drawn_and_the_used_division_is_named() {
        let run =
            Run { matchings: vec![("era-4".to_owned(), matching(Some(2.0), &[false, true, true]))], ..Run::default() };
        let figure = figure(&run, &Ranking::default()).unwrap();
        // c1 has no hollow points, for they are negative.
        assert_eq!(figure.legend.len(), 7);
        assert!(
            figure.caption.contains("up to 2.00. The division used, m2/m1 = 4.00, is not among them"),
            "{}",
            figure.caption
        );
    }
    #[test]
    fn a_fitted_model_is_drawn_where_coefficient_matching_did_not_run() {
        let (run, ranking) = fitted_run("");
        let figure = figure(&run, &ranking).unwrap();
        assert!(
            figure.caption.starts_with("Parameter sets with the same poles as Double spring-mass-damper, direct fit 1")
        );
        assert!(figure.caption.ends_with("m2/m1 = 3.00, is among them."), "{}", figure.caption);
    }
}
