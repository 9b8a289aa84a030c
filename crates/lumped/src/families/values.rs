//! The parameters of a family as a list, in the order of its table.

use crate::error::{finite, positive};
use crate::{LumpedError, ModelKind, ParameterKind};

/// Refuses values without meaning: what is not finite, and what must be positive and is not.
///
/// Negative springs and dampers pass where the equations allow them: solvers do return such sets. In series, and where
/// a spring unloads along a line of its own, the equations do not.
pub(crate) fn check_values(kind: ModelKind, values: &[f64]) -> Result<(), LumpedError> {
    let is_strict = matches!(kind, ModelKind::Maxwell | ModelKind::Elastoplastic);
    kind.parameters().iter().zip(values).try_for_each(|(parameter, value)| match parameter.kind {
        ParameterKind::Stiffness | ParameterKind::Damping if !is_strict => finite(parameter.name, *value),
        _ => positive(parameter.name, *value),
    })
}

/// Gives a family its list of values and its check. What is no parameter comes after the bar.
macro_rules! values {
    ($model:ident { $($field:ident),+ $(| $other:ident: $value:expr)? }) => {
        impl $model {
            /// Its parameters, in the order of [`ModelKind::parameters`](crate::ModelKind::parameters).
            pub(crate) fn values(&self) -> Vec<f64> {
                vec![$(self.$field),+]
            }

            /// The model of these parameters; one that is left out is not a number.
            pub(crate) fn from_values(values: &[f64]) -> Self {
                let mut values = values.iter().copied();
                Self { $($field: values.next().unwrap_or(f64::NAN),)+ $($other: $value)? }
            }

            /// Refuses parameters without meaning: masses and knots that are not positive, knots that do not rise,
            /// values that are not finite.
            pub fn check(&self) -> Result<(), LumpedError> {
                self.structure().map(drop)
            }
        }
    };
}

pub(crate) use values;
