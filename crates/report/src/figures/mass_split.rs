//! Parameters of the double model over the division of the mass: which divisions a passive structure can have.

use crumple_artifact::records::{MatchingSweepV1, MatchingV1};
use serde_json::{Value, json};

use crate::figure::{Figure, axis, base_layout, colour, event_line, room_above, set, short};
use crate::people::{KILO, significant};
use crate::{Ranking, Run};

/// Name, panel and value of the four parameters.
type Parameter = (&'static str, &'static str, fn(&MatchingSweepV1) -> f64);
const PARAMETERS: [Parameter; 4] = [
    ("k1", "y", |s| s.k1_n_per_m),
    ("k2", "y", |s| s.k2_n_per_m),
    ("c1", "y2", |s| s.c1_n_s_per_m),
    ("c2", "y2", |s| s.c2_n_s_per_m),
];

/// The sweep of the identified model whose solutions the simulation supports, else of the first that has one.
pub fn figure(run: &Run, ranking: &Ranking) -> Option<Figure> {
    let supported = ranking.best_of_matching(run).map(|candidate| candidate.id.as_str());
    let of_supported = |matching: &MatchingV1| matching.solutions.iter().any(|s| s.candidate.as_deref() == supported);
    let mut swept = run.matchings.iter().filter(|(_, matching)| !matching.sweep.is_empty());
    let (id, matching) = match swept.clone().find(|(_, m)| supported.is_some() && of_supported(m)) {
        Some(found) => found,
        None => swept.next()?,
    };
    let used = matching.m2_kg / matching.m1_kg;
    let feasible = feasible_ranges(matching);
    let mut traces = Vec::new();
    for (place, &(name, panel, value)) in PARAMETERS.iter().enumerate() {
        for physical in [true, false] {
            let shown = || matching.sweep.iter().filter(|s| s.physical == physical && value(s) > 0.0);
            if shown().next().is_none() {
                continue;
            }
            traces.push(json!({
                "type": "scatter", "mode": "markers", "yaxis": panel,
                "x": shown().map(|s| short(ratio(s))).collect::<Vec<_>>(),
                "y": shown().map(|s| short(KILO * value(s))).collect::<Vec<_>>(),
                "name": if physical { format!("{name}, all four positive") } else { format!("{name}, another is negative") },
                "marker": {"size": 7, "color": colour::SERIES[place],
                           "symbol": if physical { "circle" } else { "circle-open" }},
            }));
        }
    }
    let mut shapes: Vec<Value> = feasible
        .iter()
        .map(|(low, high)| {
            json!({"type": "rect", "xref": "x", "yref": "paper", "x0": short(*low), "x1": short(*high), "y0": 0, "y1": 1,
                   "fillcolor": colour::SERIES[2], "opacity": 0.12, "line": {"width": 0}, "layer": "below"})
        })
        .collect();
    let (line, mut label) = event_line(used, "used", colour::EVENT, "dash");
    // Text stands at the logarithm on a logarithmic axis, a line at the value.
    set(&mut label, json!({"x": short(used.log10())}));
    shapes.push(line);
    let mut layout = base_layout();
    let log = |domain: [f64; 2]| json!({"type": "log", "domain": domain, "exponentformat": "power", "dtick": 1, "minor": {"ticks": "outside", "ticklen": 2}});
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
        caption: caption(id, matching, used, &feasible),
        height_px: HEIGHT_PX,
        half_width: false,
        traces,
        layout,
    })
}

const HEIGHT_PX: u32 = 620;
/// Marks with their full number: plotly's own minor digits ("2", "5") read as values.
const RATIO_MARKS: [f64; 11] = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0];

/// m2/m1 of a point of the sweep.
fn ratio(point: &MatchingSweepV1) -> f64 {
    1.0 / point.front_mass_fraction - 1.0
}

/// Ranges of m2/m1 with a solution of positive parameters. Their ends lie half-way (in the logarithm) to the next point of the
/// sweep, or on the computed bound where that lies between the two.
fn feasible_ranges(matching: &MatchingV1) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, bool)> = Vec::new();
    for solution in &matching.sweep {
        match points.iter_mut().find(|(at, _)| *at == ratio(solution)) {
            Some((_, physical)) => *physical |= solution.physical,
            None => points.push((ratio(solution), solution.physical)),
        }
    }
    points.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let between = |low: f64, high: f64| {
        let bound = matching.largest_mass_ratio.filter(|bound| low <= *bound && *bound <= high);
        bound.unwrap_or_else(|| (low * high).sqrt())
    };
    let mut ranges: Vec<(f64, f64)> = Vec::new();
    for (k, &(at, physical)) in points.iter().enumerate() {
        if !physical {
            continue;
        }
        let end = points.get(k + 1).map_or(at, |&(next, also)| if also { next } else { between(at, next) });
        let before = k.checked_sub(1).map(|before| points[before]);
        match (before, ranges.last_mut()) {
            (Some((_, true)), Some(range)) => range.1 = end,
            (Some((previous, _)), _) => ranges.push((between(previous, at), end)),
            (None, _) => ranges.push((at, end)),
        }
    }
    ranges
}

fn caption(id: &str, matching: &MatchingV1, used: f64, feasible: &[(f64, f64)]) -> String {
    let inside = feasible.iter().any(|(low, high)| (*low..=*high).contains(&used));
    let bound = match matching.largest_mass_ratio {
        Some(bound) => format!("They exist only for m2/m1 up to {}.", significant(bound, 3)),
        None => "No division allows them: the identified polynomial is not that of a passive structure.".to_owned(),
    };
    format!(
        "Real solutions of coefficient matching of {id} at the same total mass, {} kg. Filled: all four parameters are positive, and such divisions are \
         shaded; negative values have no place on a logarithmic axis. {bound} The division used, m2/m1 = {}, {}.",
        significant(matching.m1_kg + matching.m2_kg, 4),
        significant(used, 3),
        if inside { "is among them" } else { "is not among them" }
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matching(largest_mass_ratio: Option<f64>, physical: &[bool]) -> MatchingV1 {
        let at = |k: usize| (k + 1) as f64 / (physical.len() + 1) as f64;
        let point = |(k, &physical): (usize, &bool)| MatchingSweepV1 {
            front_mass_fraction: at(k),
            k1_n_per_m: 1e5,
            k2_n_per_m: 2e5,
            c1_n_s_per_m: if physical { 1e3 } else { -1e3 },
            c2_n_s_per_m: 2e3,
            physical,
        };
        MatchingV1 {
            m1_kg: 200.0,
            m2_kg: 800.0,
            polynomial: vec![],
            largest_mass_ratio,
            roots: vec![],
            solutions: vec![],
            sweep: physical.iter().enumerate().map(point).collect(),
            notes: vec![],
            source: None,
            zeta_of_the_start_per_s2: None,
            coordinates: vec![],
        }
    }

    #[test]
    fn a_feasible_range_ends_on_the_bound_where_that_lies_between_two_points() {
        // Fractions 0.25, 0.5, 0.75: ratios 3, 1, 1/3.
        let found = feasible_ranges(&matching(Some(2.0), &[false, true, true]));
        assert_eq!(found.len(), 1);
        // 1/0.75 - 1 is 1/3 but for rounding.
        assert!((found[0].0 - 1.0 / 3.0).abs() < 1e-15 && found[0].1 == 2.0);
        let unknown = feasible_ranges(&matching(None, &[false, true, false]));
        assert!((unknown[0].0 - (1.0_f64 / 3.0).sqrt()).abs() < 1e-15 && (unknown[0].1 - 3.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(feasible_ranges(&matching(None, &[false; 3])), []);
    }

    #[test]
    fn negative_values_are_not_drawn_and_the_used_division_is_judged() {
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
}
