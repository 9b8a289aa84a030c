//! Parameter sets of the double model over the division of one total mass, as parameter-solve swept them: with the
//! poles of an identified model, or of a fitted one.

use crumple_artifact::records::{MatchingSweepV1, MatchingV1};

use crate::findings::{Ranking, Run};

/// Real parameter sets over the division of the mass.
pub struct Divisions<'a> {
    /// The model whose poles they have, in words.
    pub source: String,
    /// Whether these poles are those of a model fitted to the record.
    pub fitted: bool,
    /// Mass of the chassis that was used, kg.
    pub m1_kg: f64,
    /// Mass of the compartment that was used, kg.
    pub m2_kg: f64,
    /// Bound of m2/m1 above which no set is physical; `None`: no division has one.
    pub largest_mass_ratio: Option<f64>,
    /// The sets.
    pub sweep: &'a [MatchingSweepV1],
}

impl<'a> Divisions<'a> {
    /// The sweep of the identified model whose solutions the simulation supports, else of the first that has one; where
    /// coefficient matching did not run, of the best fitted double model.
    pub fn of_run(run: &'a Run, ranking: &Ranking) -> Option<Self> {
        Self::matched(run, ranking).or_else(|| Self::fitted(run, ranking))
    }

    fn matched(run: &'a Run, ranking: &Ranking) -> Option<Self> {
        let supported = ranking.best_of_matching(run).map(|candidate| candidate.id.as_str());
        let of_supported =
            |matching: &MatchingV1| matching.solutions.iter().any(|s| s.candidate.as_deref() == supported);
        let mut swept = run.matchings.iter().filter(|(_, matching)| !matching.sweep.is_empty());
        let (id, matching) = match swept.clone().find(|(_, m)| supported.is_some() && of_supported(m)) {
            Some(swept) => swept,
            None => swept.next()?,
        };
        Some(Self {
            source: id.clone(),
            fitted: false,
            m1_kg: matching.m1_kg,
            m2_kg: matching.m2_kg,
            largest_mass_ratio: matching.largest_mass_ratio,
            sweep: &matching.sweep,
        })
    }

    fn fitted(run: &'a Run, ranking: &Ranking) -> Option<Self> {
        let candidates = ranking.order.iter().filter_map(|id| run.candidate(id));
        let (best, divisions) =
            candidates.filter_map(|candidate| Some((candidate, candidate.record.mass_divisions.as_ref()?))).next()?;
        let mass_kg = |name: &str| best.record.parameters.get(name).copied();
        Some(Self {
            source: run.name_of(&best.id),
            fitted: true,
            m1_kg: mass_kg("m1_kg")?,
            m2_kg: mass_kg("m2_kg")?,
            largest_mass_ratio: divisions.largest_mass_ratio,
            sweep: &divisions.sweep,
        })
    }

    /// Ranges of m2/m1 with a solution of positive parameters. Their ends lie half-way (in the logarithm) to the next
    /// point of the sweep, or on the computed bound where that lies between the two.
    pub fn feasible_ranges(&self) -> Vec<(f64, f64)> {
        let mut points: Vec<(f64, bool)> = Vec::new();
        for solution in self.sweep {
            match points.iter_mut().find(|(at, _)| *at == ratio(solution)) {
                Some((_, physical)) => *physical |= solution.physical,
                None => points.push((ratio(solution), solution.physical)),
            }
        }
        points.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let between = |low: f64, high: f64| {
            let bound = self.largest_mass_ratio.filter(|bound| low <= *bound && *bound <= high);
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
}

/// m2/m1 of a point of the sweep.
pub fn ratio(point: &MatchingSweepV1) -> f64 {
    1.0 / point.front_mass_fraction - 1.0
}

#[cfg(test)]
mod tests {
    use crumple_artifact::records::{CandidateV1, MassDivisionsV1};

    use super::*;
    use crate::findings::CandidateResult;

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

    fn run_of(matching: MatchingV1) -> Run {
        Run { matchings: vec![("era-4".to_owned(), matching)], ..Run::default() }
    }

    #[test]
    fn a_feasible_range_ends_on_the_bound_where_that_lies_between_two_points() {
        // Fractions 0.25, 0.5, 0.75: ratios 3, 1, 1/3.
        let feasible = |run: &Run| Divisions::of_run(run, &Ranking::default()).unwrap().feasible_ranges();
        let ranges = feasible(&run_of(matching(Some(2.0), &[false, true, true])));
        assert_eq!(ranges.len(), 1);
        // 1/0.75 - 1 is 1/3 but for rounding.
        assert!((ranges[0].0 - 1.0 / 3.0).abs() < 1e-15 && ranges[0].1 == 2.0);
        let unknown = feasible(&run_of(matching(None, &[false, true, false])));
        assert!((unknown[0].0 - (1.0_f64 / 3.0).sqrt()).abs() < 1e-15 && (unknown[0].1 - 3.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(feasible(&run_of(matching(None, &[false; 3]))), []);
    }

    #[test]
    fn a_fitted_model_shows_its_divisions_where_none_was_matched() {
        let Some(swept) = run_of(matching(Some(2.0), &[false, true, true])).matchings.pop() else { unreachable!() };
        let divisions = MassDivisionsV1 { largest_mass_ratio: Some(2.0), sweep: swept.1.sweep };
        let candidate = |id: &str, mass_divisions| CandidateResult {
            id: id.to_owned(),
            record: CandidateV1 {
                parameters: [("m1_kg", 375.0), ("m2_kg", 1125.0)].map(|(name, kg)| (name.to_owned(), kg)).into(),
                mass_divisions,
                ..CandidateV1::default()
            },
            ..CandidateResult::default()
        };
        let candidates =
            vec![candidate("kelvin/direct-fit/1", None), candidate("double/direct-fit/1", Some(divisions))];
        let ranking =
            Ranking { order: candidates.iter().map(|candidate| candidate.id.clone()).collect(), ..Ranking::default() };
        let run = Run { candidates, ..Run::default() };
        let divisions = Divisions::of_run(&run, &ranking).unwrap();
        assert!(divisions.fitted && divisions.m2_kg / divisions.m1_kg == 3.0);
        assert_eq!(divisions.feasible_ranges().len(), 1);
        assert!(Divisions::of_run(&run, &Ranking::default()).is_none());
    }
}
