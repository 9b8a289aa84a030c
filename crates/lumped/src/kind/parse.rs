//! A family by its name in candidate ids and pipeline files.
//!
//! Letters and hyphens exactly as [`ModelKind::name`] has them; of crushed structures the kind of one mass. Errors: any
//! other text, with all names in the message.

use std::str::FromStr;

use crate::error::LumpedError;
use crate::kind::model_kind::ModelKind;

impl FromStr for ModelKind {
    type Err = LumpedError;

    fn from_str(text: &str) -> Result<Self, LumpedError> {
        Self::ALL.into_iter().find(|kind| kind.name() == text).ok_or_else(|| LumpedError::UnknownModel {
            given: text.to_owned(),
            expected: {
                let mut names = Self::ALL.map(Self::name).to_vec();
                names.dedup();
                names.join(", ")
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_reads_back() {
        for kind in ModelKind::ALL {
            let one_mass = if kind == ModelKind::LoadPaths { ModelKind::ForceDeflection } else { kind };
            assert_eq!(kind.name().parse(), Ok(one_mass));
        }
        assert!(matches!("Kelvin".parse::<ModelKind>(), Err(LumpedError::UnknownModel { .. })));
    }
}
