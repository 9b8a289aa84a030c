//! The structure of a candidate as numbers for the script: masses, and elements by their laws.

use crumple_artifact::records::CandidateV1;
use crumple_lumped::{Element, Extrapolation, ForceDeflection, Node, PiecewiseLinear, structure_of};
use serde_json::{Value, json};

/// Masses and elements, the curves continued beyond their last knot as predictions do. `None`: no model that this
/// program knows.
pub fn described(record: &CandidateV1) -> Option<Value> {
    let structure = structure_of(&record.model, &record.parameters).ok()?.with_trends_beyond();
    let node = |node: Node| match node {
        Node::Wall => -1,
        Node::Mass(i) => i64::try_from(i).unwrap_or(-1),
    };
    let elements: Vec<Value> = structure
        .connections()
        .iter()
        .map(|connection| {
            let mut element = law(&connection.element);
            element["front"] = node(connection.front).into();
            element["rear"] = node(connection.rear).into();
            element
        })
        .collect();
    Some(json!({"masses": structure.masses_kg(), "elements": elements}))
}

fn law(element: &Element) -> Value {
    let points = |law: &PiecewiseLinear| law.points().map(|(at, value)| [at, value]).collect::<Vec<_>>();
    match element {
        Element::Spring(spring) => json!({"kind": "spring", "points": points(&spring.0)}),
        Element::Damper(damper) => json!({"kind": "damper", "points": points(&damper.0)}),
        Element::SeriesSpringDamper(series) => {
            json!({"kind": "series", "k": series.stiffness_n_per_m, "c": series.damping_n_s_per_m})
        }
        // A curve of one slope that goes back along another.
        Element::PlasticSpring(spring) => json!({
            "kind": "curve", "knots": [[0.0, 0.0], [1.0, spring.loading_stiffness_n_per_m]],
            "beyond": spring.loading_stiffness_n_per_m, "unloading": spring.unloading_stiffness_n_per_m, "rate": 0.0,
            "gap": 0.0, "limit": null, "pulls": !spring.release,
        }),
        Element::ForceDeflection(curve) => json!({
            "kind": "curve", "knots": curve.knots().iter().map(|(d, f)| [*d, *f]).collect::<Vec<_>>(),
            "beyond": beyond(curve), "unloading": curve.unloading_n_per_m(), "rate": curve.rate_s_per_m(),
            "gap": curve.gap_m(), "limit": curve.limit_n(), "pulls": false,
        }),
    }
}

/// Stiffness beyond the last knot, N/m.
fn beyond(curve: &ForceDeflection) -> f64 {
    match (curve.extrapolation(), curve.knots()) {
        (Extrapolation::Stiffness(stiffness), _) => stiffness,
        (Extrapolation::Constant, _) => 0.0,
        (Extrapolation::Slope, [.., (a, fa), (b, fb)]) => (fb - fa) / (b - a),
        (Extrapolation::Slope, _) => 0.0,
    }
}
