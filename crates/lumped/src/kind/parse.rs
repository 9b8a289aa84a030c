//! A family by its name in candidate ids and pipeline files.
//!
//! Letters and hyphens exactly as [`ModelKind::name`] has them. Errors: any other text, with all names in the message.

use std::str::FromStr;

use crate::error::LumpedError;
use crate::kind::model_kind::ModelKind;

impl FromStr for ModelKind {
    type Err = LumpedError;

    fn from_str(text: &str) -> Result<Self, LumpedError> {
        Self::ALL.into_iter().find(|kind| kind.name() == text).ok_or_else(|| LumpedError::UnknownModel {
            given: text.to_owned(),
            expected: Self::ALL.map(Self::name).join(", "),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_reads_back() {
        for kind in ModelKind::ALL {
            assert_eq!(kind.name().parse(), Ok(kind));
        }
        assert!(matches!("Kelvin".parse::<ModelKind>(), Err(LumpedError::UnknownModel { .. })));
    }
}
