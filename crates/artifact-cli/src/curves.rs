//! Static force-deflection curves of a candidate, as tables for people and for other programs.

use std::fmt::Write;

use crumple_artifact::Artifact;
use crumple_artifact::records::{CandidateV1, RatedCandidateV1, RecommendationV1};
use crumple_lumped::{Element, Model, Node};
use crumple_numerics::estimation::statistics::NORMAL_95;

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
    /// 95 % interval of the force of each point, N; empty where the candidate states none.
    pub intervals: Vec<(f64, f64)>,
    /// Largest deflection in the test, m: beyond it the curve is a trend.
    pub tested_m: Option<f64>,
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
    let model = Model::read(&record.model, record.law.as_deref(), &record.parameters)?;
    let choice = artifact.record::<RecommendationV1>("/recommendation")?;
    let rated = choice.iter().flat_map(|choice| &choice.candidates).find(|rated| rated.id == id);
    let ends = ends_of_numbers(&record, rated);
    let tested = model.structure()?;
    let structure = tested.clone().with_trends_beyond();
    let masses = structure.masses_kg().len();
    let mut needs_end = false;
    let mut curves = Vec::new();
    let elements = structure.connections().iter().zip(tested.connections().iter().map(|tested| &tested.element));
    for (k, (connection, tested)) in elements.enumerate() {
        let bare = |points: Vec<(f64, f64)>| StaticCurve {
            candidate: id.clone(),
            element: k + 1,
            between: between(connection.front, connection.rear),
            intervals: intervals(&model, &ends, (k, &connection.element), &points),
            // The crush of the test is the deflection of one element alone.
            tested_m: Some(last_knot_m(tested)).filter(|last| *last > 0.0).or(crush_m.filter(|_| masses == 1)),
            points,
            unloading_n_per_m: None,
            rate_s_per_m: 0.0,
            gap_m: 0.0,
        };
        let curve = match (&connection.element, to_m.or(crush_m)) {
            (Element::ForceDeflection(element), _) => {
                let end_m = to_m.unwrap_or(0.0).max(last_knot_m(tested));
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
            (Element::OwnForce(own), Some(to)) => {
                let of = |j: usize| to * j as f64 / (POINTS - 1) as f64;
                let points = (0..POINTS).map(|j| (of(j), own.static_force_n(of(j)))).collect();
                StaticCurve { unloading_n_per_m: own.unloading_n_per_m(to), ..bare(points) }
            }
            (Element::PlasticSpring(_) | Element::Spring(_) | Element::OwnForce(_), None) => {
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

/// The ends of the 95 % interval of each number: beside what no lumped model describes, where the choice says it, else
/// those of its uncertainty.
fn ends_of_numbers(record: &CandidateV1, rated: Option<&RatedCandidateV1>) -> Vec<(String, [f64; 2])> {
    let of_choice = rated.map(|rated| &rated.log_deviations).filter(|deviations| !deviations.is_empty());
    if let Some(deviations) = of_choice {
        let of = |(name, deviation): (&String, &f64)| {
            let (value, factor) = (*record.parameters.get(name)?, (NORMAL_95 * deviation).exp());
            Some((name.clone(), [value / factor, value * factor]))
        };
        return deviations.iter().filter_map(of).collect();
    }
    let Some(known) = &record.uncertainty else { return Vec::new() };
    let both = known.interval_low.iter().filter_map(|(name, low)| {
        let high = known.interval_high.get(name).copied().flatten();
        // What nothing determines is known to a factor of 2 beforehand, as the choice has it.
        let (value, factor) = (*record.parameters.get(name)?, (NORMAL_95 * std::f64::consts::LN_2).exp());
        Some((name.clone(), [low.unwrap_or(value / factor), high.unwrap_or(value * factor)]))
    });
    both.collect()
}

/// The intervals of the forces of an element, N: what each end of the interval of each number changes, in quadrature.
/// Empty where no number that it feels has an interval.
fn intervals(
    model: &Model,
    ends: &[(String, [f64; 2])],
    (place, own): (usize, &Element),
    points: &[(f64, f64)],
) -> Vec<(f64, f64)> {
    let mut squares = vec![[0.0; 2]; points.len()];
    for (name, end) in ends.iter().flat_map(|(name, ends)| ends.map(|end| (name.as_str(), end))) {
        let Some(changed) = model.changed([(name, end)]).and_then(|changed| changed.structure().ok()) else { continue };
        let changed = changed.with_trends_beyond();
        let Some(there) = changed.connections().get(place) else { continue };
        for ((deflection_m, _), squares) in points.iter().zip(&mut squares) {
            let change = static_force_n(&there.element, *deflection_m) - static_force_n(own, *deflection_m);
            squares[usize::from(change > 0.0)] += change * change;
        }
    }
    let is_felt = squares.iter().flatten().any(|square| *square > 0.0);
    let each = points.iter().zip(&squares).map(|((_, force), [down, up])| (force - down.sqrt(), force + up.sqrt()));
    if is_felt { each.collect() } else { Vec::new() }
}

/// The static force of an element under loading, N; zero of a damper.
fn static_force_n(element: &Element, deflection_m: f64) -> f64 {
    match element {
        Element::ForceDeflection(curve) => curve.static_force_n(deflection_m),
        Element::PlasticSpring(spring) => spring.loading_stiffness_n_per_m * deflection_m,
        Element::Spring(spring) => spring.0.at(deflection_m) * deflection_m,
        Element::OwnForce(own) => own.static_force_n(deflection_m),
        Element::Damper(_) | Element::SeriesSpringDamper(_) => 0.0,
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
    if let Some(tested_m) = curve.tested_m {
        remarks.push(format!(
            "good for impacts on the front that was tested, up to a deflection of {tested_m:.3} m; beyond it the curve \
             is a trend"
        ));
    }
    if curve.intervals.is_empty() {
        remarks.push("no interval of a force is known".to_owned());
    }
    if curve.gap_m != 0.0 {
        remarks.push(format!("gap: deflection begins after {} m", curve.gap_m));
    }
    remarks
}

fn csv(curve: &StaticCurve, text: &mut String) -> std::fmt::Result {
    remarks(curve).iter().try_for_each(|remark| writeln!(text, "# {remark}"))?;
    if curve.intervals.is_empty() {
        writeln!(text, "deflection (m),static force (N)")?;
        return curve.points.iter().try_for_each(|(d, force)| writeln!(text, "{d},{force}"));
    }
    writeln!(text, "deflection (m),static force (N),95 % low (N),95 % high (N)")?;
    let rows = curve.points.iter().zip(&curve.intervals);
    rows.into_iter().try_for_each(|((d, force), (low, high))| writeln!(text, "{d},{force},{low},{high}"))
}

/// The interval of every force, as a remark: a program that takes a curve takes no interval.
fn intervals_in_words(curve: &StaticCurve) -> Vec<String> {
    let rows = curve.points.iter().zip(&curve.intervals);
    rows.map(|((d, force), (low, high))| format!("at {d:.4} m {force:.0} N, 95 % interval {low:.0} to {high:.0} N"))
        .collect()
}

/// `*DEFINE_CURVE` has eight fields of ten characters, then two of twenty a line.
fn ls_dyna(curve: &StaticCurve, text: &mut String) -> std::fmt::Result {
    let (loading, unloading) = (2 * curve.element - 1, 2 * curve.element);
    let remarks = remarks(curve).into_iter().chain(intervals_in_words(curve));
    remarks.into_iter().try_for_each(|remark| writeln!(text, "$ {remark}"))?;
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
    let remarks = remarks(curve).into_iter().chain(intervals_in_words(curve));
    remarks.into_iter().try_for_each(|remark| writeln!(text, "<!-- {} -->", remark.replace("--", "- -")))?;
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
            intervals: Vec::new(),
            tested_m: Some(0.5),
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
        let known = [StaticCurve { intervals: vec![(0.0, 0.0), (1.9e5, 2.1e5), (2.5e5, 3.5e5)], ..curve() }];
        assert!(text(&known, CurveFormat::Csv).contains("0.1,200000,190000,210000\n"));
        for format in [CurveFormat::LsDyna, CurveFormat::Madymo] {
            assert!(text(&known, format).contains("at 0.1000 m 200000 N, 95 % interval 190000 to 210000 N"));
        }
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
