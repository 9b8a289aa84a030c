//! Whether two rankings of a summary are the same to an engineer.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use crate::candidate::EQUAL_FIT_POINTS;

/// Criteria of candidates that differ by less do not tell them apart.
const EQUAL_CRITERIA: f64 = 2.0;

/// Whether two rankings of a summary differ only in the order of candidates that are equally good on both sides:
/// criteria within 2 (Burnham and Anderson 2002, section 2.6), of candidates that were not rated fits within 0.1
/// points.
pub(crate) fn same_ranking(key: &str, a: &Map<String, Value>, b: &Map<String, Value>) -> bool {
    if !matches!(key, "ranking" | "ranking_by_aicc") {
        return false;
    }
    let ids = |side: &Map<String, Value>| -> Option<Vec<String>> {
        side.get(key)?.as_array()?.iter().map(|id| id.as_str().map(str::to_owned)).collect()
    };
    // What ranks a candidate, in units of what is equal: the criterion, of one without it the fit.
    let figure = |side: &Map<String, Value>, id: &str| -> Option<(bool, f64)> {
        let candidate = side.get("candidates")?.as_array()?.iter().find(|candidate| candidate["id"] == id)?;
        let fit = |name: &str| Some((false, candidate["simulation"][name].as_f64()? / EQUAL_FIT_POINTS));
        let criterion = candidate["difference_with_priors"].as_f64().map(|value| (true, value / EQUAL_CRITERIA));
        criterion.or_else(|| fit("fit_as_measured_percent")).or_else(|| fit("fit_percent"))
    };
    let is_tied = |side, x: &str, y: &str| {
        figure(side, x).zip(figure(side, y)).is_some_and(|(x, y)| x.0 == y.0 && (x.1 - y.1).abs() <= 1.0)
    };
    let tied = |x: &str, y: &str| [a, b].into_iter().all(|side| is_tied(side, x, y));
    let (Some(first), Some(second)) = (ids(a), ids(b)) else { return false };
    let set = |list: &[String]| list.iter().cloned().collect::<BTreeSet<_>>();
    set(&first) == set(&second) && first.iter().zip(&second).all(|(x, y)| x == y || tied(x, y))
}
