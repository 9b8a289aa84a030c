//! Parameters of the double model over the division of the mass: which divisions a passive structure can have.

use crumple_artifact::records::MatchingSweepV1;
use serde_json::{Value, json};

use crate::drawing::figure::{Figure, axis, base_layout, colour, event_line, room_above, set, short};
use crate::results::mass_divisions::{Divisions, ratio};
use crate::text::numbers::{KILO, significant};
use crate::{Ranking, Run};

/// Name, panel and value of the four parameters.
type Parameter = (&'static str, &'static str, fn(&MatchingSweepV1) -> f64);
const PARAMETERS: [Parameter; 4] = [
    ("k1", "y", |s| s.k1_n_per_m),
    ("k2", "y", |s| s.k2_n_per_m),
    ("c1", "y2", |s| s.c1_n_s_per_m),
    ("c2", "y2", |s| s.c2_n_s_per_m),
];

/// See [`Divisions::of_run`] for whose.
pub fn figure(run: &Run, ranking: &Ranking) -> Option<Figure> {
    let divisions = Divisions::of_run(run, ranking)?;
    let used = divisions.m2_kg / divisions.m1_kg;
    let feasible = divisions.feasible_ranges();
    let mut traces = Vec::new();
    for (place, &(name, panel, value)) in PARAMETERS.iter().enumerate() {
        for physical in [true, false] {
            let shown = || divisions.sweep.iter().filter(|s| s.physical == physical && value(s) > 0.0);
            if shown().next().is_none() {
                continue;
            }
            traces.push(json!({
                "type": "scatter", "mode": "markers", "yaxis": panel,
                "x": shown().map(|s| short(ratio(s))).collect::<Vec<_>>(),
                "y": shown().map(|s| short(KILO * value(s))).collect::<Vec<_>>(),
                "name": format!("{name}, {}", if physical { "all four positive" } else { "another is negative" }),
                "marker": {"size": 7, "color": colour::SERIES[place],
                           "symbol": if physical { "circle" } else { "circle-open" }},
            }));
        }
    }
    let mut shapes: Vec<Value> = feasible
        .iter()
        .map(|(low, high)| {
            json!({"type": "rect", "xref": "x", "yref": "paper", "x0": short(*low), "x1": short(*high), "y0": 0,
                "y1": 1,
                   "fillcolor": colour::SERIES[2], "opacity": 0.12, "line": {"width": 0}, "layer": "below"})
        })
        .collect();
    let (line, mut label) = event_line(used, "used", colour::EVENT, "dash");
    // Text stands at the logarithm on a logarithmic axis, a line at the value.
    set(&mut label, json!({"x": short(used.log10())}));
    shapes.push(line);
    let mut layout = base_layout();
    let log = |domain: [f64; 2]| {
        json!({"type": "log", "domain": domain, "exponentformat": "power", "dtick": 1,
        "minor": {"ticks": "outside", "ticklen": 2}})
    };
    set(
        &mut layout,
        json!({
            "hovermode": "closest", "shapes": shapes, "annotations": [label],
            "xaxis": axis("mass ratio m2/m1 (compartment over chassis)", json!({"type": "log", "anchor": "y2",
                "tickmode": "array", "tickvals": RATIO_MARKS, "ticktext": RATIO_MARKS.map(|x| x.to_string())})),
            "yaxis": axis("stiffness, kN/m", log([0.53, 1.0])),
            "yaxis2": axis("damping, kN·s/m", log([0.0, 0.47])),
        }),
    );
    room_above(&mut layout, HEIGHT_PX, 1, 2);
    Some(Figure {
        id: "mass-split",
        title: "Which divisions of the mass a double model can have",
        caption: caption(&divisions, used, &feasible),
        height_px: HEIGHT_PX,
        half_width: false,
        traces,
        layout,
    })
}

const HEIGHT_PX: u32 = 620;
/// Marks with their full number: plotly's own minor digits ("2", "5") read as values.
const RATIO_MARKS: [f64; 11] = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0];

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
        assert_eq!(figure.traces.len(), 7);
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
