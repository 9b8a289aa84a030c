//! The static force of an element over its deflection.

use crumple_artifact::Artifact;
use crumple_artifact::records::{CandidateV1, RecommendationV1};
use crumple_lumped::{Element, Node, structure_of};

use crate::error::CurveError;

/// Points of a curve that bends between its knots.
const POINTS: usize = 101;

/// A static force-deflection curve, loading, with what else describes the element. SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticCurve {
    /// Candidate that it is of.
    pub candidate: String,
    /// Number of the element in its model, from 1.
    pub element: usize,
    /// What it joins, in words.
    pub between: String,
    /// Deflection, m, rising from zero, and force, N; linear between.
    pub points: Vec<(f64, f64)>,
    /// Stiffness of the straight line down from the curve, N/m; `None`: it unloads along the curve.
    pub unloading_n_per_m: Option<f64>,
    /// Loading forces grow by this share for each m/s, s/m.
    pub rate_s_per_m: f64,
    /// Way before it is touched, m; deflections of the points are after it.
    pub gap_m: f64,
}

/// The curves of a candidate of an artifact of `crumple-parameter-solve`: of all elements that have one.
///
/// `candidate`: its id; without one the recommended. `to_m`: deflection up to which curves without a last knot are
/// written, m. Errors: no candidates at all, no such candidate, none recommended, parameters without meaning, no
/// element with a static force.
pub fn static_curves(
    artifact: &Artifact,
    candidate: Option<&str>,
    to_m: Option<f64>,
) -> Result<Vec<StaticCurve>, CurveError> {
    if !artifact.records().iter().any(|raw| raw.topic.starts_with("/parameters/")) {
        return Err(CurveError::NoCandidates);
    }
    let id = match candidate {
        Some(id) => id.to_owned(),
        None => {
            let recommendation = artifact.record::<RecommendationV1>("/recommendation")?;
            let recommended = recommendation.as_ref().and_then(|choice| choice.recommended.clone());
            recommended.ok_or_else(|| CurveError::NoneRecommended { candidates: ids(artifact) })?
        }
    };
    let record = artifact
        .record::<CandidateV1>(&format!("/parameters/{id}"))?
        .ok_or_else(|| CurveError::NoCandidate { id: id.clone(), candidates: ids(artifact) })?;
    let tested = structure_of(&record.model, &record.parameters)?;
    let structure = tested.clone().with_trends_beyond();
    let mut needs_end = false;
    let mut curves = Vec::new();
    for (k, (connection, tested)) in structure.connections().iter().zip(tested.connections()).enumerate() {
        let bare = |points: Vec<(f64, f64)>| StaticCurve {
            candidate: id.clone(),
            element: k + 1,
            between: between(connection.front, connection.rear),
            points,
            unloading_n_per_m: None,
            rate_s_per_m: 0.0,
            gap_m: 0.0,
        };
        let curve = match (&connection.element, to_m) {
            (Element::ForceDeflection(element), _) => {
                let end_m = to_m.unwrap_or(0.0).max(last_knot_m(&tested.element));
                let knots = element.knots().iter().map(|knot| knot.0);
                let ends = knots.filter(|d| *d < end_m).chain([end_m]);
                StaticCurve {
                    unloading_n_per_m: Some(element.unloading_n_per_m()),
                    rate_s_per_m: element.rate_s_per_m(),
                    gap_m: element.gap_m(),
                    ..bare(ends.map(|d| (d, element.static_force_n(d))).collect())
                }
            }
            (Element::PlasticSpring(spring), Some(to)) => StaticCurve {
                unloading_n_per_m: Some(spring.unloading_stiffness_n_per_m),
                ..bare(vec![(0.0, 0.0), (to, spring.loading_stiffness_n_per_m * to)])
            },
            (Element::Spring(spring), Some(to)) => {
                let of = |d: f64| (d, spring.0.at(d) * d);
                let points = if spring.0.as_constant().is_some() { 2 } else { POINTS };
                bare((0..points).map(|j| of(to * j as f64 / (points - 1) as f64)).collect())
            }
            (Element::PlasticSpring(_) | Element::Spring(_), None) => {
                needs_end = true;
                continue;
            }
            (Element::Damper(_) | Element::SeriesSpringDamper(_), _) => continue,
        };
        curves.push(curve);
    }
    match (curves.is_empty(), needs_end) {
        (false, _) => Ok(curves),
        (true, true) => Err(CurveError::NoEnd { id }),
        (true, false) => Err(CurveError::NoStaticForce { id, model: record.model }),
    }
}

/// Deflection of the last knot of a curve, m; zero of another element.
fn last_knot_m(element: &Element) -> f64 {
    let Element::ForceDeflection(curve) = element else { return 0.0 };
    curve.knots().last().map_or(0.0, |knot| knot.0)
}

fn between(front: Node, rear: Node) -> String {
    let name = |node: Node| match node {
        Node::Wall => "the wall".to_owned(),
        Node::Mass(k) => format!("mass {}", k + 1),
    };
    format!("{} and {}", name(front), name(rear))
}

fn ids(artifact: &Artifact) -> String {
    let topics = artifact.records().iter().filter_map(|raw| raw.topic.strip_prefix("/parameters/"));
    topics.collect::<Vec<&str>>().join(", ")
}
