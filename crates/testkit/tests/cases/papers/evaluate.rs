//! Every kind of case: inputs in, recomputed quantities out, by the project's own libraries.

use serde_json::Value;

use crate::papers::inputs::Inputs;
use crate::papers::{chains, one_mass, systems};

/// The recomputed quantities of a case, named as in the case files. An unknown kind is an error with its name.
pub fn evaluate(kind: &str, inputs: &Value) -> Result<Value, String> {
    let i = Inputs(inputs);
    match kind {
        "charpoly_two_mass" => chains::charpoly_two_mass(&i),
        chain if chain.starts_with("charpoly") => chains::charpoly_chain(&i),
        "crush" => chains::crush(&i),
        "match" => chains::matching(&i),
        "kelvin_curve" => one_mass::kelvin_curve(&i),
        "kelvin_invert" => one_mass::kelvin_invert(&i),
        "kelvin_identify" => one_mass::kelvin_identify(&i),
        "kelvin_response" => one_mass::kelvin_response(&i),
        "elastoplastic" => one_mass::elastoplastic(&i),
        "maxwell_constants" => one_mass::maxwell_printed(&i),
        "maxwell" => one_mass::maxwell(&i),
        "nonlinear" => one_mass::nonlinear(&i),
        "firefly_constants" => one_mass::firefly(&i),
        "quotient" => systems::quotient(&i),
        "eig" => systems::eig(&i),
        "realization" => systems::realization(&i),
        "transfer_function" => systems::transfer_function(&i),
        "lsq_k2c2" => chains::lsq_rear(&i),
        "lsq_k1c1" => chains::lsq_front(&i),
        "exp_sum" => systems::exponential_sum(&i),
        "roots_to_coefficients" => systems::roots_to_coefficients(&i),
        unknown => Err(format!("unknown kind {unknown}")),
    }
}
