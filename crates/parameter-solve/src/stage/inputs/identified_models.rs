//! Identified models with four poles among the inputs.

use crumple_lumped::{Complex, RealisedModel};
use crumple_lumped_fit::{CoefficientSpread, Identified, Quartic};
use crumple_numerics::lti::{eigenvalues, matrix_logarithm};
use crumple_stage::Inputs;
use crumple_stage::records::{EvidenceV1, ExponentialSumV1, ModesV2, StateSpaceV1, TransferFunctionV1};
use nalgebra::{DMatrix, Matrix4, RowVector4, Vector4};

/// Every model with four poles: transfer functions of fourth order with the state space of the same name where there is
/// one, then state spaces without a transfer function, sums of four exponentials, and modes of four poles that belong
/// to none of them.
pub fn identified_models(input: &Inputs) -> anyhow::Result<Vec<Identified>> {
    let mut models: Vec<Identified> = Vec::new();
    for (id, model) in input.records::<TransferFunctionV1>("/model/")? {
        if let [leading, t, u, v, w] = model.denominator[..]
            && leading != 0.0
        {
            let quartic = Quartic::Coefficients([t, u, v, w].map(|c| c / leading));
            let source = "denominator of the transfer function";
            let spread = spread(input, &id)?;
            let delay_s = model.delay_s.unwrap_or(0.0);
            let numerator = Some(model.numerator);
            models.push(Identified { id, quartic, numerator, source, realised: None, spread, delay_s });
        }
    }
    let spaces = input.records::<StateSpaceV1>("/model/")?;
    for (id, model) in &spaces {
        // The continuous one of a pair says all.
        let base = base_of(id);
        if id.ends_with("/discrete") && spaces.iter().any(|(other, _)| *other == format!("{base}/continuous")) {
            continue;
        }
        let Some((a, rows)) = continuous(model) else { continue };
        let realised = realised(&a, &rows, model);
        if let Some(known) = models.iter_mut().find(|known| base_of(&known.id) == base) {
            known.realised = realised;
            continue;
        }
        let poles = eigenvalues(&DMatrix::from_column_slice(4, 4, a.as_slice()))?;
        if let Ok(poles) = <[Complex; 4]>::try_from(poles) {
            let delay_s = model.delay_s.unwrap_or(0.0);
            let bare = Identified::of_poles(id.clone(), poles, "eigenvalues of the state matrix of");
            models.push(Identified { realised, delay_s, ..bare });
        }
    }
    for (id, sum) in input.records::<ExponentialSumV1>("/model/")? {
        if let [a, b, c, d] = &sum.terms[..] {
            let poles = [a, b, c, d].map(|term| Complex::new(term.re_per_s, term.im_rad_per_s));
            models.push(Identified::of_poles(id, poles, "exponents of the sum"));
        }
    }
    for (id, modes) in input.records::<ModesV2>("/modes/")? {
        if let [a, b, c, d] = &modes.modes[..]
            && !models.iter().any(|model| base_of(&model.id) == id)
        {
            let poles = [a, b, c, d].map(|mode| Complex::new(mode.re_per_s, mode.im_rad_per_s));
            models.push(Identified::of_poles(id, poles, "poles of the modes of"));
        }
    }
    Ok(models)
}

/// How well the coefficients of a transfer function are known, by the evidence that its identification left.
fn spread(input: &Inputs, id: &str) -> anyhow::Result<Option<CoefficientSpread>> {
    let evidence: Option<EvidenceV1> = input.record_if(&format!("/evidence/{}", base_of(id)))?;
    Ok(evidence.and_then(|evidence| {
        CoefficientSpread::of_covariance(&evidence.denominator_covariance)
            .or_else(|| CoefficientSpread::of_deviations(&evidence.denominator_deviations))
    }))
}

/// `era-4` of `era-4/continuous`.
fn base_of(id: &str) -> &str {
    ["/continuous", "/discrete", "/transfer-function"].iter().find_map(|end| id.strip_suffix(end)).unwrap_or(id)
}

/// State matrix in continuous time and output rows of a model with four states; `None` for another order or where the
/// sampled matrix has no logarithm.
fn continuous(model: &StateSpaceV1) -> Option<(Matrix4<f64>, Vec<RowVector4<f64>>)> {
    let flat: Vec<f64> = model.a.iter().flatten().copied().collect();
    if model.a.len() != 4 || flat.len() != 16 {
        return None;
    }
    let a = Matrix4::from_row_slice(&flat);
    let a = if model.sample_time_s > 0.0 {
        let log = matrix_logarithm(&DMatrix::from_column_slice(4, 4, a.as_slice())).ok()?;
        Matrix4::from_column_slice((log / model.sample_time_s).as_slice())
    } else {
        a
    };
    let rows = model.c.iter().filter(|row| row.len() == 4).map(|row| RowVector4::from_row_slice(row)).collect();
    Some((a, rows))
}

/// One output is the compartment's; of two the first is that of the chassis. `None` where the words of the output name
/// no motion.
fn realised(a: &Matrix4<f64>, rows: &[RowVector4<f64>], model: &StateSpaceV1) -> Option<RealisedModel> {
    let derivative = ["displacement", "velocity", "acceleration"].iter().position(|q| model.output.starts_with(q))?;
    let (chassis, compartment) = match rows {
        [compartment] => (None, *compartment),
        [chassis, compartment] => (Some(*chassis), *compartment),
        _ => return None,
    };
    // The state right after an impulse is the column of the input: the start of a free motion.
    let column: Vec<f64> = model.b.iter().filter_map(|row| row.first().copied()).collect();
    let free = model.input.contains("impulse") && column.len() == 4;
    let start = free.then(|| Vector4::from_column_slice(&column));
    Some(RealisedModel { a: *a, compartment, chassis, derivative, start })
}
