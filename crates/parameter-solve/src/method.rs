use std::fmt;
use std::str::FromStr;

use crumple_lumped::ModelKind;

/// Models this crate can solve for, in the order of the result.
pub const MODELS: [ModelKind; 6] = [
    ModelKind::Kelvin,
    ModelKind::Elastoplastic,
    ModelKind::Maxwell,
    ModelKind::Nonlinear1,
    ModelKind::Nonlinear2,
    ModelKind::DoubleSpringMassDamper,
];

/// Those solved for where none is asked for.
pub const DEFAULT_MODELS: [ModelKind; 5] = [
    ModelKind::Kelvin,
    ModelKind::Elastoplastic,
    ModelKind::Maxwell,
    ModelKind::Nonlinear2,
    ModelKind::DoubleSpringMassDamper,
];

/// All methods.
pub const METHODS: [Method; 5] =
    [Method::ClosedForm, Method::DirectFit, Method::CoefficientMatching, Method::CurveFit, Method::Firefly];

/// Those used where none is asked for: they need the motion of the test only.
pub const DEFAULT_METHODS: [Method; 2] = [Method::ClosedForm, Method::DirectFit];

/// How parameters are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Method {
    /// From the events of the crash, by formula.
    ClosedForm,
    /// By fitting the response to the record.
    DirectFit,
    /// From the characteristic polynomial of an identified model.
    CoefficientMatching,
    /// From exponents and amplitudes as the ERA paper does it, for reproduction.
    CurveFit,
    /// By the firefly search of the single-mass paper.
    Firefly,
}

impl Method {
    /// The name in candidate ids and pipeline files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ClosedForm => "closed-form",
            Self::DirectFit => "direct-fit",
            Self::CoefficientMatching => "coefficient-matching",
            Self::CurveFit => "curve-fit",
            Self::Firefly => "firefly",
        }
    }

    /// Whether it is a way to solve for this model.
    pub const fn solves(self, model: ModelKind) -> bool {
        match self {
            Self::ClosedForm => matches!(model, ModelKind::Kelvin | ModelKind::Elastoplastic),
            Self::DirectFit => matches!(
                model,
                ModelKind::Maxwell | ModelKind::Nonlinear1 | ModelKind::Nonlinear2 | ModelKind::DoubleSpringMassDamper
            ),
            Self::CoefficientMatching | Self::CurveFit => matches!(model, ModelKind::DoubleSpringMassDamper),
            Self::Firefly => matches!(model, ModelKind::Nonlinear2),
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Method {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        METHODS
            .into_iter()
            .find(|m| m.name() == text)
            .ok_or_else(|| format!("unknown method {text:?}, expected one of {}", METHODS.map(Self::name).join(", ")))
    }
}
