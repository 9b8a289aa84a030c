//! The procedures of the papers, as printed.

use crumple_signal::{About, Weight, remarks};
use crumple_stage::Usage;
use crumple_sysid::Order;

use crate::stage::options::choices::{Hold, Initial, Method, Paper};
use crate::stage::options::flags::Options;

/// States and samples of the realisations that the ERA paper shows.
pub const ERA_RUNS: [(Order, usize); 4] =
    [(Order::Given(2), 100), (Order::Given(2), 50), (Order::Given(4), 60), (Order::Given(4), 2501)];

/// What is said of the curve fit of the ERA paper.
pub const CURVE_FIT_REMARKS: [&str; 3] = [
    "paper curve-fit: equation 16 of the ERA paper as printed: four real exponentials, free at the start, fitted to \
     the displacement; its program and starting values are not printed, this is the best of many starts",
    "paper curve-fit: nothing constrains the position and the impact speed at the start: the printed sum starts at \
     -0.05 m with 20.2 m/s, of a car of 9.7 m/s",
    "paper curve-fit: a record does not determine eight numbers of four nearly equal exponents (condition number of \
     the printed ones 2e11); exponentials-4 beside it is constrained at the start and may oscillate",
];

/// What is said of the sum beside it, which has the position of the record at the start, or its velocity too.
pub const BESIDE_CURVE_FIT: [&str; 2] = [
    "beside the paper's curve fit: the sum may oscillate, and is constrained to position of the record at the start",
    "beside the paper's curve fit: the sum may oscillate, and is constrained to position and velocity of the record at \
     the start",
];

/// Whether the exponentials of a run with this paper are its curve fit.
pub fn has_curve_fit(paper: Paper) -> bool {
    matches!(paper, Paper::Era | Paper::CurveFit)
}

/// What a paper prescribes, put in the place of the options. Errors: options that contradict it.
pub fn follow(options: &mut Options) -> Result<(), Usage> {
    let Some(paper) = options.paper else { return Ok(()) };
    let beyond = |own: &[Method]| options.methods.iter().any(|method| !own.contains(method));
    let taken = match paper {
        Paper::Era => vec![
            // The curve fit of the same paper stands beside its realisations.
            ("methods", beyond(&[Method::Era, Method::Exponentials])),
            ("orders", !options.orders.is_empty()),
            ("samples", options.samples.is_some()),
            ("rows", options.rows.is_some()),
            ("columns", options.columns.is_some()),
            ("channels", !options.channels.is_empty()),
            ("hankel_size", options.hankel_size.is_some()),
            ("free_decay", options.free_decay.is_some()),
        ],
        Paper::Tfest => vec![
            ("methods", !options.methods.is_empty() && options.methods != [Method::Tfest]),
            ("poles", options.poles.is_some()),
            ("zeros", options.zeros.is_some()),
            ("initial", options.initial.is_some()),
            ("hold", options.hold.is_some()),
            ("max_iterations", !options.max_iterations.is_empty()),
        ],
        Paper::CurveFit => vec![("methods", !options.methods.is_empty() && options.methods != [Method::Exponentials])],
    };
    let curve_fit = paper == Paper::CurveFit || options.methods.contains(&Method::Exponentials) && has_curve_fit(paper);
    let fitted = [
        ("terms", curve_fit && options.terms.is_some_and(|terms| terms != 4)),
        ("real", curve_fit && options.real == Some(false)),
        ("conditions", curve_fit && !options.conditions.is_empty()),
    ];
    if let Some((name, _)) = taken.iter().chain(&fitted).find(|(_, given)| *given) {
        return Err(Usage::new(format!("paper \"{paper}\" prescribes {name}, which is given too"))
            .hint(format!("leave out {name}, or the paper")));
    }
    if options.methods.is_empty() {
        options.methods = vec![match paper {
            Paper::Era => Method::Era,
            Paper::CurveFit => Method::Exponentials,
            Paper::Tfest => Method::Tfest,
        }];
    }
    if curve_fit {
        (options.terms, options.real) = (Some(4), Some(true));
    }
    if paper == Paper::Tfest {
        options.initial = Some(Initial::Zero);
        options.hold = Some(Hold::ZeroOrder);
        options.max_iterations = vec![20];
    }
    Ok(())
}

/// What differs from the way the stage would go by itself, for the notes of every model of the paper's procedure.
pub fn remarks(paper: Paper) -> &'static [&'static str] {
    match paper {
        Paper::Era => &[
            "paper era: the procedure of the ERA paper as printed: the crash pulse itself is the Markov sequence, D is \
             its first sample, the state matrices are balanced",
            "paper era: B and C carry the singular values to the power +1/2; the printed -1/2 does not reproduce the \
             sequence",
            "paper era: natural frequencies are moduli of the poles, rad/s; the paper's values for 60 samples are 2 pi \
             times too large",
            "paper era: a window much shorter than a period, as 50 to 100 samples at 10 kHz are, shows the filter and \
             the start of the pulse, not the car; by itself the stage takes the whole record",
        ],
        Paper::Tfest => &[
            "paper tfest: the procedure of the transfer-function paper as printed: 4 poles, 1 zero, at most 20 \
             iterations; the toolbox's defaults, which the paper does not print, are taken as steps between samples \
             and rest before the record",
            "paper tfest: the record starts at the impact speed; by itself the stage estimates that motion, takes \
             straight lines between samples, and iterates until the gradient vanishes",
            "paper tfest: deceleration to its own double integral is 1/s^2 for any body; a stable fit of four poles \
             reflects the length of the record",
        ],
        Paper::CurveFit => &[],
    }
}

impl AsPrinted {
    /// One of the texts above.
    pub fn new(remark: &str) -> Self {
        Self { reason: remark.to_owned() }
    }
}

remarks! {
    /// Remarks of procedures of the papers.
    pub REMARKS;

    /// A model follows the procedure of a paper as printed, or stands beside such a one.
    CR458 AsPrinted { reason: String }
    bears on (About::IdentifiedModels, Weight::None)
    decided "--paper asks for it. The texts compare what is printed with what the stage does otherwise \
             (docs/papers.md)."
    means "The model is for comparison with the paper. It is not the one to use."
    remedy "nothing; leave --paper out for the models of the stage itself"
    says reason.clone();
}
