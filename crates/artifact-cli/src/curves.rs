//! Static force-deflection curves of a candidate, as tables for people and for other programs.

use std::fmt::Write;

use crumple_artifact::Artifact;
use crumple_artifact::records::{CandidateV1, RecommendationV1};
use crumple_lumped::{Element, Model, Node};

use crate::error::CurveError;

// The static force of an element over its deflection.

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
/// `candidate`: its id; without one the recommended. `to_m`: deflection up to which curves are written, m; without one
/// those without a last knot end at `crush_m`, the dynamic crush of the test. Errors: no candidates at all, no such
/// candidate, none recommended, parameters without meaning, no element with a static force.
pub fn static_curves(
    artifact: &Artifact,
    candidate: Option<&str>,
    to_m: Option<f64>,
    crush_m: Option<f64>,
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
    let tested = Model::read(&record.model, &record.parameters)?.structure()?;
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
        let curve = match (&connection.element, to_m.or(crush_m)) {
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

// Curves as text: a table, and the input of three other programs.
//
// The inputs follow what their makers' manuals say in public of the keywords; none of these programs was at hand, so
// each text says what to check.

/// A way to write a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum CurveFormat {
    /// Table with a comment for everything that is no curve; m and N.
    Csv,
    /// Keywords of LS-DYNA: a general nonlinear spring, its loading and unloading curve; kg, m, s, N.
    LsDyna,
    /// XML of Madymo: functions and a characteristic with a hysteresis slope; m and N.
    Madymo,
    /// Two columns for PC-Crash: deformation in m, force in kN.
    PcCrash,
}

/// Text of the curves in a format.
pub fn text(curves: &[StaticCurve], format: CurveFormat) -> String {
    let mut text = String::new();
    for curve in curves {
        let _infallible = match format {
            CurveFormat::Csv => csv(curve, &mut text),
            CurveFormat::LsDyna => ls_dyna(curve, &mut text),
            CurveFormat::Madymo => madymo(curve, &mut text),
            CurveFormat::PcCrash => pc_crash(curve, &mut text),
        };
    }
    text
}

/// What a program that takes a curve alone does not take.
fn remarks(curve: &StaticCurve) -> Vec<String> {
    let mut remarks = vec![format!("{}, element {} between {}", curve.candidate, curve.element, curve.between)];
    remarks.push(match curve.unloading_n_per_m {
        Some(stiffness) => format!(
            "unloading: straight at {stiffness:.6e} N/m from the largest deflection d to the permanent set d - F(d)/k, \
             reloading along the same line"
        ),
        None => "unloading: along the curve".to_owned(),
    });
    if curve.rate_s_per_m != 0.0 {
        remarks.push(format!(
            "rate: while loading the force is the static one times 1 + {} s/m times the rate of deflection",
            curve.rate_s_per_m
        ));
    }
    if curve.gap_m != 0.0 {
        remarks.push(format!("gap: deflection begins after {} m", curve.gap_m));
    }
    remarks
}

fn csv(curve: &StaticCurve, text: &mut String) -> std::fmt::Result {
    remarks(curve).iter().try_for_each(|remark| writeln!(text, "# {remark}"))?;
    writeln!(text, "deflection (m),static force (N)")?;
    curve.points.iter().try_for_each(|(d, force)| writeln!(text, "{d},{force}"))
}

/// `*DEFINE_CURVE` has eight fields of ten characters, then two of twenty a line.
fn ls_dyna(curve: &StaticCurve, text: &mut String) -> std::fmt::Result {
    let (loading, unloading) = (2 * curve.element - 1, 2 * curve.element);
    remarks(curve).iter().try_for_each(|remark| writeln!(text, "$ {remark}"))?;
    writeln!(
        text,
        "$ units kg, m, s, N; not run in LS-DYNA: check signs (compression is positive here) and unloading"
    )?;
    writeln!(text, "*MAT_SPRING_GENERAL_NONLINEAR")?;
    writeln!(text, "$      mid      lcdl      lcdu      beta       tyi       cyi")?;
    let (cards, first) = match curve.unloading_n_per_m {
        Some(_) => ([loading, unloading], curve.points.last().map_or(0.0, |point| point.1)),
        None => ([loading, loading], 0.0),
    };
    writeln!(text, "{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}", curve.element, cards[0], cards[1], 0.0, 0.0, 0.0)?;
    define_curve(loading, &curve.points, text)?;
    match curve.unloading_n_per_m {
        Some(stiffness) => define_curve(unloading, &[(0.0, 0.0), (first / stiffness, first)], text),
        None => Ok(()),
    }
}

fn define_curve(id: usize, points: &[(f64, f64)], text: &mut String) -> std::fmt::Result {
    writeln!(text, "*DEFINE_CURVE")?;
    writeln!(text, "$     lcid      sidr       sfa       sfo      offa      offo    dattyp")?;
    writeln!(text, "{id:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}", 0, 1.0, 1.0, 0.0, 0.0, 0)?;
    points.iter().try_for_each(|(d, force)| writeln!(text, "{d:>20.12e}{force:>20.12e}"))
}

fn madymo(curve: &StaticCurve, text: &mut String) -> std::fmt::Result {
    remarks(curve).iter().try_for_each(|remark| writeln!(text, "<!-- {} -->", remark.replace("--", "- -")))?;
    writeln!(text, "<!-- units m, N; not run in Madymo: check the hysteresis model -->")?;
    let id = curve.element;
    writeln!(text, "<FUNCTION.XY ID=\"{id}\" NAME=\"static force of element {id}\">")?;
    writeln!(text, "<TABLE TYPE=\"XY_PAIR\">\n<![CDATA[\n| XI YI |")?;
    curve.points.iter().try_for_each(|(d, force)| writeln!(text, "{d:.12e} {force:.12e}"))?;
    writeln!(text, "]]>\n</TABLE>\n</FUNCTION.XY>")?;
    let hysteresis =
        curve.unloading_n_per_m.map_or_else(String::new, |k| format!(" HYS_MODEL=\"2\" HYS_SLOPE=\"{k:.12e}\""));
    writeln!(text, "<CHARACTERISTIC.LOAD ID=\"{id}\" NAME=\"element {id}\" LOAD_FUNC=\"{id}\"{hysteresis}/>")
}

fn pc_crash(curve: &StaticCurve, text: &mut String) -> std::fmt::Result {
    curve.points.iter().try_for_each(|(d, force)| writeln!(text, "{d:.6}\t{:.6}", force / 1e3))
}

#[cfg(test)]
mod tests {

    use super::*;

    fn curve() -> StaticCurve {
        StaticCurve {
            candidate: "force-deflection/direct-fit/1".to_owned(),
            element: 1,
            between: "the wall and mass 1".to_owned(),
            points: vec![(0.0, 0.0), (0.1, 2e5), (0.5, 3e5)],
            unloading_n_per_m: Some(2e7),
            rate_s_per_m: 0.004,
            gap_m: 0.0,
        }
    }

    #[test]
    fn every_format_holds_every_point_and_what_unloading_is() {
        let numbers = |format: CurveFormat| -> Vec<(f64, f64)> {
            text(&[curve()], format)
                .lines()
                .filter_map(|line| {
                    let mut cells = line.split([',', '\t', ' ']).filter(|cell| !cell.is_empty()).map(str::parse);
                    match (cells.next(), cells.next(), cells.next()) {
                        (Some(Ok(d)), Some(Ok(force)), None) => Some((d, force)),
                        _ => None,
                    }
                })
                .collect()
        };
        assert_eq!(numbers(CurveFormat::Csv), curve().points);
        assert_eq!(numbers(CurveFormat::Madymo), curve().points);
        let with_unloading: Vec<_> = curve().points.into_iter().chain([(0.0, 0.0), (0.015, 3e5)]).collect();
        assert_eq!(numbers(CurveFormat::LsDyna), with_unloading);
        assert_eq!(numbers(CurveFormat::PcCrash), [(0.0, 0.0), (0.1, 200.0), (0.5, 300.0)]);
        assert!(text(&[curve()], CurveFormat::Csv).contains("# unloading: straight at 2.000000e7 N/m"));
        assert!(text(&[curve()], CurveFormat::Madymo).contains("HYS_SLOPE=\"2.000000000000e7\""));
    }

    /// `*DEFINE_CURVE` is read by columns.
    #[test]
    fn cards_of_ls_dyna_have_their_columns() {
        let text = text(&[curve()], CurveFormat::LsDyna);
        let cards: Vec<&str> = text.lines().filter(|line| !line.starts_with(['$', '*'])).collect();
        assert_eq!(cards[0].len(), 60);
        assert_eq!(cards[1].len(), 70);
        assert!(cards[2..5].iter().all(|card| card.len() == 40), "{cards:?}");
    }
}
