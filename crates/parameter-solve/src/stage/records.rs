//! Results as records of the artifact and lines of the summary.

use std::collections::BTreeMap;

use crumple_lumped::{CoefficientMatch, MatchedSolution, Model, Parameter, ParameterKind};
use crumple_lumped_fit::{
    Assessed, BlockBootstrap, Candidate, Comparison, EvaluatedCandidate, Fit, KnownNumbers, MassDivisions, Matched,
    Minimum, Profile, Propagation, SensorFit, Uncertainty,
};
use crumple_numerics::estimation::statistics::NORMAL_95;
use crumple_stage::records::{
    CandidateV1, Certainty, FitV1, MassDivisionsV1, MatchingRootV1, MatchingSolutionV1, MatchingSweepV1, MatchingV1,
    PhysicalCoordinatesV1, ProfileV1, ReplicatesV1, SensorFitV1, UncertaintyV1,
};
use crumple_stage::{Output, Record};
use nalgebra::SMatrix;
use rayon::prelude::*;

use crate::stage::comparison::evaluation_record;

// A candidate as the artifact and a person get it.

/// Writes `/parameters/<id>` of every candidate, fitted to sensors of which `channel` is the pulse, and what a person
/// should hear at once; beside the tests of the comparison. One with a number that no record holds is left out, for a
/// reason that the notes say.
pub fn write_candidates<'a>(
    candidates: &'a [Candidate],
    channel: &str,
    comparison: Option<&Comparison>,
    out: &mut Output,
) -> anyhow::Result<Vec<EvaluatedCandidate<'a>>> {
    let assess = |candidate: &'a Candidate| {
        let mut record = record(candidate, channel);
        let compared = comparison.filter(|_| record.first_impossible().is_none());
        let evaluations = compared.map_or_else(Vec::new, |comparison| comparison.evaluate(candidate));
        record.evaluation = compared.and_then(|comparison| evaluation_record(comparison, &evaluations));
        (record, EvaluatedCandidate { candidate, known: KnownNumbers::default(), evaluations })
    };
    let assessed: Vec<(CandidateV1, EvaluatedCandidate<'a>)> = candidates.par_iter().map(assess).collect();
    let mut written = Vec::new();
    for (record, one) in assessed {
        let id = one.candidate.id();
        if !out.put_candidate(&format!("/parameters/{id}"), &id, &record)? {
            continue;
        }
        out.summary(parameters_line(one.candidate, &record));
        summary_text(one.candidate).into_iter().for_each(|text| out.summary(text));
        written.push(EvaluatedCandidate { known: known_numbers(&record), ..one });
    }
    Ok(written)
}

/// What the record of a candidate says of its numbers.
fn known_numbers(record: &CandidateV1) -> KnownNumbers {
    let owned = |names: Vec<&str>| names.into_iter().map(str::to_owned).collect();
    KnownNumbers {
        asked: owned(record.asked().collect()),
        open: owned(record.undetermined()),
        order_of_magnitude: record.parameters_of(Certainty::OrderOfMagnitude).len(),
    }
}

fn record(candidate: &Candidate, channel: &str) -> CandidateV1 {
    let assessed = candidate.assessed.as_ref().map(|assessed| uncertainty_record(candidate, assessed));
    let of_fit = || candidate.uncertainty.as_ref().map(|known| uncertainty_of_fit(known, &candidate.model));
    let open = || candidate.stated.as_ref().and(candidate.minimum.as_ref()).map(open_record);
    CandidateV1 {
        model: candidate.model.kind().name().to_owned(),
        method: candidate.found_by().to_owned(),
        law: candidate.model.law().map(str::to_owned),
        parameters: candidate.model.parameters(),
        physical: candidate.model.is_physical(),
        equivalent_to: candidate.equivalent_id(),
        fit: candidate.fit.as_ref().map(|fit| fit_record(fit, channel)),
        uncertainty: assessed.or_else(of_fit).or_else(open),
        notes: candidate.notes.iter().map(ToString::to_string).collect(),
        evaluation: None,
        mass_divisions: MassDivisions::of(candidate).map(|divisions| MassDivisionsV1 {
            largest_mass_ratio: divisions.largest_mass_ratio,
            sweep: sweep_records(&divisions.sweep),
        }),
    }
}

/// How a candidate was fitted, to sensors of which `channel` is the pulse.
fn fit_record(fit: &Fit, channel: &str) -> FitV1 {
    let sensor = |sensor: &SensorFit| SensorFitV1 {
        channel: sensor.channel.clone(),
        mass: sensor.mass as u32,
        quantity: sensor.quantity.name().to_owned(),
        rmse: sensor.rmse,
        noise: sensor.noise,
    };
    FitV1 {
        channel: channel.to_owned(),
        quantity: fit.quantity.name().to_owned(),
        from_s: fit.from_s,
        to_s: fit.to_s,
        samples: fit.samples as u64,
        rmse: fit.rmse,
        iterations: fit.iterations,
        evaluations: fit.evaluations,
        stop_reason: fit.stop_reason.name().to_owned(),
        active_bounds: fit.active_bounds.clone(),
        sensors: fit.sensors.iter().map(sensor).collect(),
    }
}

/// `kelvin/closed-form/1: stiffness 321.9 kN/m, ...` in the units of the trade, and how many of them the record leaves
/// open.
fn parameters_line(candidate: &Candidate, record: &CandidateV1) -> String {
    let open = match (record.undetermined().len(), record.asked().count()) {
        (0, _) => String::new(),
        (n, of) => format!("; {n} of {of} not determined"),
    };
    let parameters: Vec<String> = record
        .parameters
        .iter()
        .map(|(name, value)| {
            let kind = candidate.model.parameter_kind(name).unwrap_or(ParameterKind::Mass);
            let symbol = kind.symbol_of(name);
            match kind {
                ParameterKind::Damping => format!("{symbol} {:.3} kN s/m", value / 1e3),
                ParameterKind::Stiffness => format!("{symbol} {:.2} kN/m", value / 1e3),
                ParameterKind::Rate => format!("{symbol} {value:.3} m/s"),
                ParameterKind::Force => format!("{symbol} {:.1} kN", value / 1e3),
                ParameterKind::RateFactor => format!("{symbol} {value:.4} s/m"),
                ParameterKind::Length => format!("{symbol} {:.1} mm", 1e3 * value),
                ParameterKind::Mass => format!("{symbol} {value:.1} kg"),
                ParameterKind::Other => format!("{name} {value:.4}"),
            }
        })
        .map(|text| text.replace('_', " "))
        .collect();
    format!("{}: {}{open}", candidate.id(), parameters.join(", "))
}

// What coefficient matching found, as the artifact gets it.

/// What goes to `/matching/<model id>`.
pub fn matching_record(matched: &Matched, source: &str) -> MatchingV1 {
    let coefficient_match = &matched.coefficient_match;
    let mut candidates = matched.candidates.iter();
    let mut polynomial = vec![1.0];
    polynomial.extend(coefficient_match.polynomial);
    MatchingV1 {
        m1_kg: coefficient_match.m1_kg,
        m2_kg: coefficient_match.m2_kg,
        polynomial,
        largest_mass_ratio: coefficient_match.largest_mass_ratio,
        roots: coefficient_match
            .roots
            .iter()
            .map(|root| MatchingRootV1 {
                re_per_s2: root.zeta.re,
                im_per_s2: root.zeta.im,
                multiplicity: root.multiplicity as u32,
                certified_radius_per_s2: root.certificate.map(|c| c.radius),
            })
            .collect(),
        solutions: coefficient_match
            .solutions
            .iter()
            .map(|s| MatchingSolutionV1 {
                k1_re_n_per_m: s.k1_n_per_m.re,
                k1_im_n_per_m: s.k1_n_per_m.im,
                k2_re_n_per_m: s.k2_n_per_m.re,
                k2_im_n_per_m: s.k2_n_per_m.im,
                c1_re_n_s_per_m: s.c1_n_s_per_m.re,
                c1_im_n_s_per_m: s.c1_n_s_per_m.im,
                c2_re_n_s_per_m: s.c2_n_s_per_m.re,
                c2_im_n_s_per_m: s.c2_n_s_per_m.im,
                real: s.real,
                physical: s.physical,
                multiplicity: s.multiplicity as u32,
                dual: s.dual as u32,
                residual: s.residual,
                // Candidates are the real solutions, in the same order.
                candidate: if s.real { candidates.next().map(Candidate::id) } else { None },
                zero_re_per_s: s.zero().map(|zero| zero.re),
                zero_im_per_s: s.zero().map(|zero| zero.im),
            })
            .collect(),
        sweep: sweep_records(&matched.sweep),
        notes: matched.remarks.clone(),
        source: Some(source.to_owned()),
        zeta_of_the_start_per_s2: matched.zeta_of_the_start,
        coordinates: matched
            .coordinates
            .iter()
            .map(|(place, physical)| PhysicalCoordinatesV1 {
                candidate: matched.candidates[*place].id(),
                mass_kg: rows(&physical.mass_kg),
                damping_n_s_per_m: rows(&physical.damping_n_s_per_m),
                stiffness_n_per_m: rows(&physical.stiffness_n_per_m),
                transformation: rows(&physical.transformation),
                condition: physical.condition,
                residual: physical.residual,
                chassis_mismatch: physical.chassis_mismatch,
                start: physical.start.map(Vec::from),
            })
            .collect(),
    }
}

/// The real solutions of a sweep over the division of the mass.
fn sweep_records(sweep: &[(f64, CoefficientMatch)]) -> Vec<MatchingSweepV1> {
    let real =
        sweep.iter().flat_map(|(fraction, at)| at.solutions.iter().filter(|s| s.real).map(move |s| (fraction, s)));
    let record = |(fraction, s): (&f64, &MatchedSolution)| MatchingSweepV1 {
        front_mass_fraction: *fraction,
        k1_n_per_m: s.k1_n_per_m.re,
        k2_n_per_m: s.k2_n_per_m.re,
        c1_n_s_per_m: s.c1_n_s_per_m.re,
        c2_n_s_per_m: s.c2_n_s_per_m.re,
        physical: s.physical,
    };
    real.map(record).collect()
}

/// A matrix row by row.
fn rows<const N: usize>(matrix: &SMatrix<f64, N, N>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}

// The uncertainty of a candidate, as a record and in words.

/// Both ends of an interval.
type Ends = (Option<f64>, Option<f64>);

/// What goes to the artifact.
fn uncertainty_record(candidate: &Candidate, assessed: &Assessed) -> UncertaintyV1 {
    let (j, method) = (&assessed.assessment, linearised(candidate.is_as_measured()));
    let side = |of: fn(&Ends) -> Option<f64>| j.interval.iter().map(|(name, ends)| (name.clone(), of(ends))).collect();
    UncertaintyV1 {
        method: match assessed.front_mass_uncertainty {
            0.0 => method.to_owned(),
            half => format!("{method}, and a share of the mass in front that may be {half} off"),
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
fn linearised(through_filter: bool) -> &'static str {
    if through_filter {
        "linearised about the minimum seen through the record's filter, autocorrelated residuals"
    } else {
        "linearised about the minimum, autocorrelated residuals"
    }
}

/// Everything that was free stays open.
fn open_record(minimum: &Minimum) -> UncertaintyV1 {
    let method = linearised(minimum.observed.is_as_measured()).to_owned();
    let open: BTreeMap<String, Option<f64>> = minimum.free_names().into_iter().map(|name| (name, None)).collect();
    UncertaintyV1 { method, interval_low: open.clone(), interval_high: open, ..UncertaintyV1::default() }
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

/// What a person should hear at once of a candidate: the parameters that the record does not identify, and propagated
/// intervals. `None` where there is nothing.
fn summary_text(candidate: &Candidate) -> Option<String> {
    let Assessed { assessment, propagation, .. } = candidate.assessed.as_ref()?;
    let mut parts = Vec::new();
    let unidentified = assessment.profile.iter().filter(|p| !p.identifiable()).map(|p| p.parameter.as_str());
    let unidentified = candidate.in_words(unidentified);
    if !unidentified.is_empty() {
        parts.push(format!("not identifiable: {unidentified}"));
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
    (!parts.is_empty()).then(|| format!("{}: {}", candidate.id(), parts.join("; ")))
}

/// The uncertainty that a fit to several sensors or a matching brings along, with 95 % intervals from its standard
/// deviations: log-normal, so that a spring stays positive, 1.96 relative deviations wide; open beyond a factor of
/// `e^9`, and for what is on a bound.
fn uncertainty_of_fit(uncertainty: &Uncertainty, model: &Model) -> UncertaintyV1 {
    let parameters = model.parameters();
    let is_given = |p: &Parameter| p.of_the_test || p.kind == ParameterKind::Mass;
    let ends = |side: f64| {
        parameters
            .iter()
            .filter(|(name, _)| model.kind().parameter(name).is_some_and(|parameter| !is_given(parameter)))
            .map(|(name, value)| {
                let known = uncertainty.standard_deviation.get(name.as_str()).filter(|_| *value > 0.0);
                let half = known.map(|deviation| NORMAL_95 * deviation / value).filter(|half| *half < 9.0);
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
