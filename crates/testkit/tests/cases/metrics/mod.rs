//! Crash metrics, whichever crate computes them. An expected number that nothing computes is a failure.

mod check;
mod filters;
mod models;
mod occupant;
mod pulse;
mod ratings;
mod real_records;
mod roadside;

use check::Check;
use crumple_testkit::reference_signals::{Case, Reference, text};
use serde_json::Value;

pub fn check(file: Value) -> crate::Check {
    let reference = Reference::of(file);
    Box::new(move |case| run(&reference, case))
}

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
