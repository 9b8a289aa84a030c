//! The uncertainty of a candidate, as a record and in words.

use crumple_lumped::{Model, Parameter, ParameterKind};
use crumple_lumped_fit::{BlockBootstrap, Profile, Propagation, Uncertainty};
use crumple_stage::records::{ProfileV1, ReplicatesV1, UncertaintyV1};

use crate::stage::assess::candidate_assessment::CandidateAssessment;

/// Both ends of an interval.
type Ends = (Option<f64>, Option<f64>);

/// What goes to the artifact.
pub fn uncertainty_record(assessed: &CandidateAssessment) -> UncertaintyV1 {
    let j = &assessed.assessment;
    let side = |of: fn(&Ends) -> Option<f64>| j.interval.iter().map(|(name, ends)| (name.clone(), of(ends))).collect();
    UncertaintyV1 {
        method: match assessed.front_mass_uncertainty {
            0.0 => linearised(assessed.through_filter),
            half => format!(
                "{}, and a share of the mass in front that may be {half} off",
                linearised(assessed.through_filter)
            ),
        },
        standard_deviation: j.standard_deviation.clone(),
        condition: j.condition,
        interval_low: side(|ends| ends.0),
        interval_high: side(|ends| ends.1),
        order: j.parameters.clone(),
        correlation: j.correlation.clone(),
        rank: Some(j.rank as u32),
        weakest_direction: j.weakest_direction.clone(),
        effective_samples: Some(j.effective_samples),
        profile: j.profile.iter().map(profile_record).collect(),
        bootstrap: j.bootstrap.as_ref().map(bootstrap_record),
        propagation: assessed.propagation.as_ref().map(|p| propagation_record(p, assessed.repeated)),
    }
}

/// How intervals came about.
pub fn linearised(through_filter: bool) -> String {
    if through_filter {
        "linearised about the minimum seen through the record's filter, autocorrelated residuals".to_owned()
    } else {
        "linearised about the minimum, autocorrelated residuals".to_owned()
    }
}

fn profile_record(profile: &Profile) -> ProfileV1 {
    ProfileV1 {
        parameter: profile.parameter.clone(),
        low: profile.low,
        high: profile.high,
        identifiable: profile.identifiable(),
        values: profile.points.iter().map(|(value, _)| *value).collect(),
        rise: profile.points.iter().map(|(_, rise)| *rise).collect(),
    }
}

fn bootstrap_record(bootstrap: &BlockBootstrap) -> ReplicatesV1 {
    let ends = |of: fn(&Ends) -> Option<f64>| {
        bootstrap.interval.iter().filter_map(|(name, i)| Some((name.clone(), of(i)?))).collect()
    };
    ReplicatesV1 {
        method: format!("block bootstrap of the misfit, blocks of {} samples", bootstrap.block),
        replicates: bootstrap.replicates as u64,
        coverage: 0.95,
        low: ends(|i| i.0),
        high: ends(|i| i.1),
    }
}

/// What uncertain inputs do; `repeated`: a fit or a closed form.
fn propagation_record(propagation: &Propagation, repeated: &str) -> ReplicatesV1 {
    ReplicatesV1 {
        method: format!("{repeated} repeated with mass, impact speed, zero level and time zero drawn again"),
        replicates: propagation.repetitions as u64,
        coverage: 0.9,
        low: propagation.interval_90.iter().map(|(name, (low, _))| (name.clone(), *low)).collect(),
        high: propagation.interval_90.iter().map(|(name, (_, high))| (name.clone(), *high)).collect(),
    }
}

/// What a person should hear at once of the candidate of this id, its parameters in these words: those that the record
/// does not determine, and propagated intervals. Empty where there is nothing.
pub fn summary_text(id: &str, assessed: &CandidateAssessment, words: impl Fn(&str) -> String) -> String {
    let (profiles, propagation) = (&assessed.assessment.profile, assessed.propagation.as_ref());
    let mut parts = Vec::new();
    let open: Vec<String> = profiles.iter().filter(|p| !p.identifiable()).map(|p| words(&p.parameter)).collect();
    if !open.is_empty() {
        parts.push(format!("not identifiable: {}", open.join(", ")));
    }
    if let Some(p) = propagation
        && let Some((low, high)) = p.interval_90.get("dynamic_crush_m")
    {
        parts.push(format!(
            "{} repetitions with uncertain inputs: crush {:.1} to {:.1} mm (5 to 95 %)",
            p.repetitions,
            1e3 * low,
            1e3 * high
        ));
    }
    if parts.is_empty() { String::new() } else { format!("{id}: {}", parts.join("; ")) }
}

/// The uncertainty that a fit to several sensors or a matching brings along, with 95 % intervals from its standard
/// deviations: log-normal, so that a spring stays positive, 1.96 relative deviations wide; open beyond a factor of
/// `e^9`, and for what is on a bound.
pub fn uncertainty_of_fit(uncertainty: &Uncertainty, model: &Model) -> UncertaintyV1 {
    let parameters = model.parameters();
    let is_given = |p: &Parameter| p.of_the_test || p.kind == ParameterKind::Mass;
    let ends = |side: f64| {
        parameters
            .iter()
            .filter(|(name, _)| model.kind().parameter(name).is_some_and(|parameter| !is_given(parameter)))
            .map(|(name, value)| {
                let known = uncertainty.standard_deviation.get(name.as_str()).filter(|_| *value > 0.0);
                let half = known.map(|deviation| 1.96 * deviation / value).filter(|half| *half < 9.0);
                (name.clone(), half.map(|half| value * (side * half).exp()))
            })
            .collect()
    };
    UncertaintyV1 {
        method: uncertainty.method.to_owned(),
        standard_deviation: uncertainty.standard_deviation.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect(),
        condition: Some(uncertainty.condition),
        interval_low: ends(-1.0),
        interval_high: ends(1.0),
        ..UncertaintyV1::default()
    }
}
