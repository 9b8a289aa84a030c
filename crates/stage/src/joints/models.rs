//! Rows of the joint of identify: matrices, poles, modes and fits of one model.

use crumple_artifact::Artifact;
use crumple_artifact::records::{IdentificationV1, ModeV1, ModesV2, StateSpaceV1, TransferFunctionV1};
use crumple_numerics::lti::{Complex, eigenvalues};
use crumple_signal::{About, Kind, Weight};
use nalgebra::DMatrix;

use crate::joints::{Finding, Invariant, RunParts, records};

/// Rows of the stage.
pub(crate) static ROWS: [Invariant; 4] = [
    Invariant {
        kind: Kind {
            code: "CR401",
            weight: Weight::Decisive,
            explanation: [
                "The matrices of a model do not fit together.",
                "A model of order n has a of n rows of n numbers, b of n rows, c of n columns, d as many rows as c \
                 and as many columns as b (docs/format.md, StateSpace); a transfer function has a denominator that \
                 starts with 1.",
                "There is no such model: nothing can be computed from it.",
                "write matrices of one order in the program of the stage identify",
            ],
        },
        ends_the_run: true,
        find: ragged,
    },
    Invariant {
        kind: Kind {
            code: "CR402",
            weight: Weight::Decisive,
            explanation: [
                "A mode is no pole of its model.",
                "Each mode is compared with the eigenvalues of a; of a sampled model they are ln(z)/T. 1 % of the \
                 pole is left.",
                "Modes and model are of different systems.",
                "read the modes off the matrix a that is written",
            ],
        },
        ends_the_run: true,
        find: modes_of_another_model,
    },
    Invariant {
        kind: Kind {
            code: "CR403",
            weight: Weight::Decisive,
            explanation: [
                "Frequency or damping of a mode are not those of its pole.",
                "The natural frequency is |p| in rad/s, the damping ratio -Re p/|p| (docs/format.md, Modes); 1 % and \
                 0.01 are left.",
                "A frequency in Hz is 6.28 times too small: stiffness made from it is 39 times too small.",
                "write natural_frequency_rad_per_s in rad/s and the damping ratio of the pole",
            ],
        },
        ends_the_run: true,
        find: mode_is_not_of_its_pole,
    },
    Invariant {
        kind: Kind {
            code: "CR404",
            weight: Weight::Decisive,
            explanation: [
                "A fit is above 100 %.",
                "A fit is 100 (1 - |y - yh|/|y - mean|) % (docs/format.md, Identification): 100 % at most.",
                "The number is another one, and the models cannot be compared by it.",
                "write the fit in percent as the format defines it",
            ],
        },
        ends_the_run: true,
        find: fit_above_all,
    },
];

fn finding(values: Vec<(&'static str, f64)>, text: String) -> Vec<Finding> {
    vec![Finding { stage: "identify", about: About::IdentifiedModels, values, text }]
}

/// What is wrong with the shapes of a model's matrices.
pub(crate) fn shape_fault(model: &StateSpaceV1) -> Option<String> {
    let order = model.a.len();
    let columns = |rows: &[Vec<f64>]| rows.first().map_or(0, Vec::len);
    let (inputs, outputs) = (columns(&model.b), model.c.len());
    let parts = [
        ("a", &model.a, order, order),
        ("b", &model.b, order, inputs),
        ("c", &model.c, outputs, order),
        ("d", &model.d, outputs, inputs),
    ];
    for (name, matrix, rows, columns) in parts {
        if matrix.len() != rows || matrix.iter().any(|row| row.len() != columns) {
            let lengths = matrix.iter().map(|row| row.len().to_string()).collect::<Vec<_>>().join(", ");
            return Some(format!("{name} has rows of [{lengths}] numbers, expected {rows} of {columns}"));
        }
    }
    (model.sample_time_s < 0.0).then(|| format!("sample_time_s is {}, expected 0 or more", model.sample_time_s))
}

/// Every topic of a model with what is wrong with its matrices.
fn faults(artifact: &Artifact) -> impl Iterator<Item = (String, String)> {
    let spaces =
        records::<StateSpaceV1>(artifact, "/model/").filter_map(|(id, model)| Some((id, shape_fault(&model)?)));
    let functions = records::<TransferFunctionV1>(artifact, "/model/").filter_map(|(id, model)| {
        let first = model.denominator.first().copied();
        (first != Some(1.0)).then(|| (id, format!("the denominator starts with {first:?}, expected 1")))
    });
    spaces.chain(functions).map(|(id, fault)| (format!("/model/{id}"), fault))
}

fn ragged(parts: &RunParts<'_>) -> Vec<Finding> {
    let found = parts.made().flat_map(|(stage, artifact)| faults(artifact).map(move |fault| (stage, fault)));
    let said = |(stage, (topic, fault)): (&'static str, (String, String))| Finding {
        stage,
        about: About::IdentifiedModels,
        values: Vec::new(),
        text: format!("topic {topic}: {fault}"),
    };
    found.map(said).collect()
}

/// The poles of a model, 1/s; none of one whose matrix is ragged, or has no eigenvalues that were found.
fn poles(model: &StateSpaceV1) -> Vec<Complex> {
    if shape_fault(model).is_some() {
        return Vec::new();
    }
    let a = DMatrix::from_row_iterator(model.a.len(), model.a.len(), model.a.iter().flatten().copied());
    let sampled = |z: Complex| if model.sample_time_s > 0.0 { z.ln() / model.sample_time_s } else { z };
    eigenvalues(&a).map(|values| values.into_iter().map(sampled).collect()).unwrap_or_default()
}

/// The modes of every model with its id.
fn modes(artifact: &Artifact) -> impl Iterator<Item = (&str, ModeV1)> {
    records::<ModesV2>(artifact, "/modes/").flat_map(|(id, record)| record.modes.into_iter().map(move |m| (id, m)))
}

/// The model of a topic below `/model/`, where its form has the poles of the system: `<id>`, `<id>/continuous`,
/// `<id>/discrete`.
fn model_of(topic: &str) -> Option<&str> {
    match topic.split_once('/') {
        None => Some(topic),
        Some((id, "continuous" | "discrete")) => Some(id),
        Some(_) => None,
    }
}

/// Share of a pole that a mode may lie beside it.
const OF_A_POLE: f64 = 0.01;

fn modes_of_another_model(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(artifact) = parts.of("identify") else { return Vec::new() };
    let of_models: Vec<(&str, Vec<Complex>)> = records::<StateSpaceV1>(artifact, "/model/")
        .filter_map(|(topic, model)| Some((model_of(topic)?, poles(&model))))
        .collect();
    for (id, mode) in modes(artifact) {
        let poles = of_models.iter().filter(|(of, _)| *of == id).flat_map(|(_, poles)| poles);
        let stated = Complex::new(mode.re_per_s, mode.im_rad_per_s);
        let beside = |pole: &Complex| (pole - stated).norm().min((pole.conj() - stated).norm());
        let Some(nearest) = poles.min_by(|a, b| beside(a).total_cmp(&beside(b))) else { continue };
        if beside(nearest) <= OF_A_POLE * stated.norm().max(nearest.norm()) {
            continue;
        }
        let text = format!(
            "{id} has a mode at {:.4} {:+.4}i 1/s, the nearest pole of its matrix a is {:.4} {:+.4}i 1/s",
            stated.re, stated.im, nearest.re, nearest.im
        );
        let values = vec![
            ("mode_re_per_s", stated.re),
            ("mode_im_rad_per_s", stated.im),
            ("pole_re_per_s", nearest.re),
            ("pole_im_rad_per_s", nearest.im),
        ];
        return finding(values, text);
    }
    Vec::new()
}

fn mode_is_not_of_its_pole(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(artifact) = parts.of("identify") else { return Vec::new() };
    for (id, mode) in modes(artifact) {
        let radius = mode.re_per_s.hypot(mode.im_rad_per_s);
        let frequency = mode.natural_frequency_rad_per_s;
        if (frequency - radius).abs() > OF_A_POLE * radius.max(frequency.abs()) {
            let text = format!("{id} has a mode of {frequency:.4} rad/s whose pole is {radius:.4} rad/s from zero");
            return finding(vec![("frequency_rad_per_s", frequency), ("pole_rad_per_s", radius)], text);
        }
        let ratio = -mode.re_per_s / radius.max(f64::MIN_POSITIVE);
        if let Some(damping) = mode.damping_ratio.filter(|damping| (damping - ratio).abs() > 0.01) {
            let text = format!("{id} has a mode of damping ratio {damping:.4} whose pole has {ratio:.4}");
            return finding(vec![("damping_ratio", damping), ("of_the_pole", ratio)], text);
        }
    }
    Vec::new()
}

fn fit_above_all(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(artifact) = parts.of("identify") else { return Vec::new() };
    let fits = records::<IdentificationV1>(artifact, "/identification/").flat_map(|(id, record)| {
        record.fit_percent.into_iter().chain(record.output_fits_percent.into_iter().flatten()).map(move |fit| (id, fit))
    });
    let Some((id, fit)) = fits.into_iter().find(|(_, fit)| *fit > 100.0 + 1e-9) else { return Vec::new() };
    finding(vec![("fit_percent", fit)], format!("{id} states a fit of {fit:.1} %"))
}
