//! What a search for continuous poles tells of itself, as evidence.

use crumple_stage::records::EvidenceV1;
use crumple_sysid::SearchOutcome;

/// Puts a search into the evidence of one output: `hold` as declared, `paper` whose procedure it is.
pub fn put_search(search: &SearchOutcome, hold: &str, paper: Option<&str>, support: &mut EvidenceV1) {
    support.hold = Some(hold.to_owned());
    support.initial_conditions = if search.initial_estimated { "estimated" } else { "zero" }.to_owned();
    support.start = Some(search.start.name().to_owned());
    support.stop_reason = Some(search.termination.name().to_owned());
    support.iterations = u32::try_from(search.iterations).ok();
    support.evaluations = Some(search.evaluations as u64);
    support.losses = search.losses.clone();
    support.condition = Some(search.condition).filter(|c| c.is_finite());
    support.denominator_deviations = known(&search.denominator_deviations);
    support.frequency_deviations = search.mode_deviations.iter().map(|d| d.map(|d| d.0)).collect();
    support.damping_deviations = search.mode_deviations.iter().map(|d| d.map(|d| d.1)).collect();
    support.paper = paper.map(str::to_owned);
}

/// Deviations, or none where they are not determined.
pub fn known(deviations: &[f64]) -> Vec<f64> {
    if deviations.iter().all(|x| x.is_finite()) { deviations.to_vec() } else { Vec::new() }
}
