//! Every reference case of crash metrics within its tolerance, whichever crate computes it.
//!
//! Prints a count for each metric and as its last line `N of M cases`. `CRUMPLE_METRICS_CASES` names another file of
//! the same shape. A metric that is not known here, or an expected number that nothing computes, is a failure.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod check;
mod filters;
mod models;
mod occupant;
mod pulse;
mod ratings;
mod real_records;
mod roadside;

use std::collections::BTreeMap;
use std::process::ExitCode;

use check::Check;
use crumple_testkit::reference_signals::{Case, Reference, text};

fn run(reference: &Reference, case: &Case) -> Vec<String> {
    let mut check = Check::new(reference, case);
    match text(&case["metric"]) {
        "cfc.coefficients" => filters::coefficients(&mut check),
        "cfc.two_pass_response" => filters::two_pass_response(&mut check),
        "cfc.filter" => filters::filter(&mut check),
        "ingest.zero_and_time_zero" => filters::zero_and_time_zero(&mut check),
        "crash.kinematics" => pulse::kinematics(&mut check),
        "pulse.sliding_mean" => pulse::sliding_mean(&mut check),
        "pulse.olc" => pulse::olc(&mut check),
        "pulse.vpi" => pulse::vpi(&mut check),
        "pulse.ride_down" => pulse::ride_down(&mut check),
        "reconstruction.crush_energy" => pulse::crush_energy(&mut check),
        "head.hic" => occupant::hic(&mut check),
        "head.hicd" => occupant::hic_d(&mut check),
        "head.clip" => occupant::clip(&mut check),
        "road.asi" => roadside::asi(&mut check),
        "road.thiv_phd" => roadside::thiv_phd(&mut check),
        "rating.iso18571" => ratings::iso18571(&mut check),
        "rating.cora" => ratings::cora(&mut check),
        "rating.residuals" => ratings::residuals(&mut check),
        "model.kelvin_identification" => models::kelvin(&mut check),
        "model.maxwell_from_roots" => models::maxwell(&mut check),
        "model.elastoplastic" => models::elastoplastic(&mut check),
        "model.two_msd_from_denominator" => models::double(&mut check),
        "model.modal_from_eigenvalue" => models::mode(&mut check),
        "record.end_to_end" => real_records::end_to_end(&mut check),
        unknown => check.fail(format!("unknown metric {unknown}")),
    }
    check.finish()
}

/// A program of its own, so that the count is the last line.
fn main() -> ExitCode {
    if crumple_testkit::asked_for_tests("reference") {
        return ExitCode::SUCCESS;
    }
    let Some(reference) = Reference::open_chosen() else { return ExitCode::SUCCESS };
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    let mut failures = Vec::new();
    for case in reference.all() {
        let count = counts.entry(case["metric"].as_str().unwrap_or("(no metric)")).or_default();
        count.1 += 1;
        // A case of another shape panics in its own test; the others still count.
        let found = std::panic::catch_unwind(|| run(&reference, case)).unwrap_or_else(|panic| {
            let message = panic.downcast_ref::<String>().cloned();
            vec![message.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned())).unwrap_or_default()]
        });
        if found.is_empty() {
            count.0 += 1;
        }
        failures.extend(found.into_iter().map(|failure| format!("{}: {failure}", case["id"])));
    }
    for (metric, (passed, all)) in &counts {
        println!("{metric}: {passed} of {all}");
    }
    for failure in &failures {
        println!("FAILED {failure}");
    }
    let (passed, all) = counts.values().fold((0, 0), |(p, a), (passed, all)| (p + passed, a + all));
    println!("{passed} of {all} cases");
    if passed == all && all > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
