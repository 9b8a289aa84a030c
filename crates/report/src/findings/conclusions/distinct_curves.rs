//! Candidates that answer with the same curve, together: a table of them has one row a curve.

use crumple_signal::Sampled;
use serde::{Deserialize, Serialize};

use crate::findings::results::ranking::pairs_of_equals;
use crate::findings::{CandidateResult, Ranking, Run};

/// Two curves are the same whose displacements differ, root mean square over the compared window, by no more than this
/// share of the largest, and whose velocities by no more than this share of the largest. What sensors of one place
/// differ by is ten times as much.
pub const SAME_CURVE: f64 = 1e-3;

/// Restitutions of the same curve differ by no more than this: what a model does after the window tells it apart too.
pub const SAME_RESTITUTION: f64 = 0.01;

/// Scores of the choice that differ by more tell two candidates apart.
const TOLD_APART: f64 = 10.0;

/// A curve and the candidates that have it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct DistinctCurve {
    /// The candidate that stands for it: the recommended one, else the one with the fewest parameters.
    pub id: String,
    /// The others, in the order of their ids.
    pub same_curve: Vec<String>,
}

/// All candidates by the curves they answer with: that of the recommended first, then by rank. A candidate without a
/// response stands alone.
pub fn distinct_curves(run: &Run, ranking: &Ranking) -> Vec<DistinctCurve> {
    let stands_for = pairs_of_equals(&run.candidates);
    let score = |index: usize| run.rated(&run.candidates[index].id)?.aicc;
    let told_apart = |a: usize, b: usize| score(a).zip(score(b)).is_some_and(|(a, b)| (a - b).abs() > TOLD_APART);
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, candidate) in run.candidates.iter().enumerate() {
        let same = |group: &Vec<usize>| {
            let first = group[0];
            stands_for[index] == stands_for[first]
                || same_curve(&run.candidates[first], candidate) && !told_apart(first, index)
        };
        match groups.iter_mut().find(|group| same(group)) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    let place = |index: usize| {
        let id = &run.candidates[index].id;
        (ranking.best.as_ref() != Some(id), ranking.place(id))
    };
    groups.sort_by_key(|group| group.iter().map(|index| place(*index)).min());
    let of_group = |group: Vec<usize>| {
        let first = group.iter().copied().min_by_key(|index| {
            let candidate = &run.candidates[*index];
            let is_best = ranking.best.as_deref() == Some(&candidate.id);
            (!is_best, candidate.record.asked().count(), candidate.record.parameters.len(), place(*index))
        })?;
        let others = group.into_iter().filter(|index| *index != first).map(|index| run.candidates[index].id.clone());
        Some(DistinctCurve { id: run.candidates[first].id.clone(), same_curve: others.collect() })
    };
    groups.into_iter().filter_map(of_group).collect()
}

/// Whether two responses are the same over the window that was compared.
pub fn same_curve(a: &CandidateResult, b: &CandidateResult) -> bool {
    let (Some(first), Some(second)) = (&a.simulation, &b.simulation) else { return false };
    let window = (first.from_s.min(second.from_s), first.to_s.max(second.to_s));
    let restitutions = first.coefficient_of_restitution.zip(second.coefficient_of_restitution);
    let alike = |a: &Option<Sampled>, b: &Option<Sampled>| match (a, b) {
        (Some(a), Some(b)) => relative_difference(a, b, window).is_some_and(|difference| difference <= SAME_CURVE),
        _ => false,
    };
    restitutions.is_none_or(|(a, b)| (a - b).abs() <= SAME_RESTITUTION)
        && alike(&a.displacement, &b.displacement)
        && (alike(&a.velocity, &b.velocity) || (a.velocity.is_none() && b.velocity.is_none()))
}

/// Root mean square difference over a window, relative to the largest value there; `None`: other grids, or nothing in
/// the window.
fn relative_difference(a: &Sampled, b: &Sampled, (from_s, to_s): (f64, f64)) -> Option<f64> {
    if a.dt_s() != b.dt_s() || a.t0_s() != b.t0_s() {
        return None;
    }
    let half = 0.5 * a.dt_s();
    let within = |k: &usize| (from_s - half..=to_s + half).contains(&a.time_s(*k));
    let (mut squares, mut largest, mut count) = (0.0, 0.0_f64, 0_u32);
    for k in (0..a.len().min(b.len())).filter(within) {
        let (x, y) = (a.samples()[k], b.samples()[k]);
        squares += (x - y) * (x - y);
        largest = largest.max(x.abs()).max(y.abs());
        count += 1;
    }
    (count > 0 && largest > 0.0).then(|| (squares / f64::from(count)).sqrt() / largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_artifact::records::{CandidateV1, SimulationV1};
    use crumple_lumped::{Kelvin, Model};

    /// A Kelvin model's answer, under another name where asked for.
    fn answering(id: &str, k: f64, c: f64, restitution: f64) -> CandidateResult {
        let model = Model::Kelvin(Kelvin { mass_kg: 1000.0, stiffness_n_per_m: k, damping_n_s_per_m: c });
        let motion = model.respond(10.0, 1e-4, 1000).unwrap();
        let wave = |samples: &[f64]| Sampled::new(0.0, 1e-4, samples.to_vec()).ok();
        let record: CandidateV1 = serde_json::from_str(
            r#"{"model": "kelvin", "method": "fit", "parameters": {"mass_kg": 1000}, "physical": true,
                "equivalent_to": null, "fit": null, "uncertainty": null}"#,
        )
        .unwrap();
        let simulation =
            SimulationV1 { to_s: 0.08, coefficient_of_restitution: Some(restitution), ..SimulationV1::default() };
        CandidateResult {
            id: id.to_owned(),
            record,
            simulation: Some(simulation),
            displacement: wave(&motion.motions[0].displacement_m),
            velocity: wave(&motion.motions[0].velocity_m_per_s),
            acceleration: None,
            elements: vec![],
            masses: vec![],
        }
    }

    #[test]
    fn equal_curves_are_one_row_and_the_recommended_stands_for_them() {
        let candidates = vec![
            answering("double/fit/1", 4e5, 2000.0, 0.5),
            answering("kelvin/fit/1", 4.004e5, 2000.0, 0.5),
            answering("kelvin/fit/2", 4.04e5, 2000.0, 0.5),
            answering("plastic/fit/1", 4e5, 2000.0, 0.1),
        ];
        let run = Run { candidates, ..Run::default() };
        let rows = |best: Option<&str>| {
            let ranking = Ranking { best: best.map(str::to_owned), ..Ranking::default() };
            let curves = distinct_curves(&run, &ranking);
            curves.into_iter().map(|curve| (curve.id, curve.same_curve)).collect::<Vec<_>>()
        };
        let own = |id: &str| (id.to_owned(), vec![]);
        let both = |id: &str, other: &str| (id.to_owned(), vec![other.to_owned()]);
        // A stiffness 1 ‰ off moves the curve by half of that, 1 % off by too much; another rebound is another curve.
        let plain = [both("double/fit/1", "kelvin/fit/1"), own("kelvin/fit/2"), own("plastic/fit/1")];
        assert_eq!(rows(None), plain);
        let recommended = [both("kelvin/fit/1", "double/fit/1"), own("kelvin/fit/2"), own("plastic/fit/1")];
        assert_eq!(rows(Some("kelvin/fit/1")), recommended);
    }
}
