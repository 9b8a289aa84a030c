//! What profile likelihood, bootstrap and uncertain inputs say of a candidate's parameters, in words.

use crate::drawing::numbers::{NBSP, Rounding};
use crate::findings::{CandidateResult, parameter, parameter_order};
use crate::words;
use crumple_artifact::records::{ProfileV1, ReplicatesV1};

/// A sentence for each method that the candidate was put through.
pub(super) fn remarks(candidate: &CandidateResult) -> Vec<String> {
    let Some(u) = &candidate.record.uncertainty else { return Vec::new() };
    let mut remarks = Vec::new();
    let model = candidate.record.model.as_str();
    if !u.profile.is_empty() {
        let mut profiles: Vec<&ProfileV1> = u.profile.iter().collect();
        profiles.sort_by_key(|p| parameter_order(model, &p.parameter));
        let parts: Vec<String> = profiles.iter().map(|p| interval(model, &p.parameter, p.low, p.high)).collect();
        remarks.push(format!("Profile likelihood, 95\u{a0}%: {}.", parts.join("; ")));
    }
    remarks.extend(u.bootstrap.iter().map(|r| replicates("Bootstrap", model, r)));
    remarks.extend(u.propagation.iter().map(|r| replicates("Uncertain inputs", model, r)));
    remarks
}

fn replicates(name: &str, model: &str, r: &ReplicatesV1) -> String {
    let mut names: Vec<&String> = r.low.keys().filter(|name| r.high.contains_key(*name)).collect();
    names.sort_by_key(|name| parameter_order(model, name));
    let of = |name: &&String| interval(model, name, r.low.get(*name).copied(), r.high.get(*name).copied());
    format!(
        "{name} ({}; {} repetitions), {}{NBSP}%: {}.",
        r.method,
        r.replicates,
        words::at_most(100.0 * r.coverage, 1),
        names.iter().map(of).collect::<Vec<_>>().join("; ")
    )
}

/// `k1 430.2 to 763.3 kN/m`; an end that does not exist is "open".
fn interval(model: &str, name: &str, low: Option<f64>, high: Option<f64>) -> String {
    let (symbol, _, unit) = parameter(model, name, 0.0);
    let [low, high] = [low, high].map(|end| end.map(|x| parameter(model, name, x).1));
    let rounding = Rounding::of_ends(low, high).unwrap_or(Rounding::WITHOUT_INTERVAL);
    let end = |end: Option<f64>| end.map_or_else(|| "open".to_owned(), |x| rounding.show(x));
    let unit = if unit.is_empty() { String::new() } else { format!("{NBSP}{unit}") };
    format!("{symbol} {}{unit}", words::between(&end(low), &end(high)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_without_an_upper_end_is_open() {
        assert_eq!(
            interval("double-spring-mass-damper", "k1_n_per_m", Some(430_204.9), None),
            "k1 430 to open\u{a0}kN/m"
        );
        assert_eq!(
            interval("kelvin", "dynamic_crush_m", Some(0.7412), Some(0.7593)),
            "dynamic crush 741.2 to 759.3\u{a0}mm"
        );
    }
}
