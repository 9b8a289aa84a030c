//! The names that options take, each an enum: one list for flags, pipeline files and the artifact.

use std::fmt;
use std::str::FromStr;

use clap::ValueEnum;
use crumple_sysid::{Criterion, InitialConditions, Resampling, Start, Weighting};
use serde::{Deserialize, Serialize};

/// An enum of names, the first the default; `as` an enum of the library, each variant as the one that it names there.
macro_rules! names {
    ($(#[$doc:meta])* $name:ident: $first:ident $(, $variant:ident)*) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum $name {
            #[default]
            $first,
            $($variant,)*
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.to_possible_value().as_ref().map_or("", |value| value.get_name()))
            }
        }
    };
    ($(#[$doc:meta])* $name:ident as $library:ty: $first:ident = $known:ident $(, $variant:ident = $other:ident)*) => {
        names!($(#[$doc])* $name: $first $(, $variant)*);

        impl From<$name> for $library {
            fn from(named: $name) -> Self {
                match named {
                    $name::$first => Self::$known,
                    $($name::$variant => Self::$other,)*
                }
            }
        }
    };
}

names!(
    /// A method of identification.
    Method: Era, Okid, Tfest, Exponentials, N4sid, Moesp, Cva, Arx, OutputError
);
names!(
    /// The size of the Hankel matrix of ERA.
    HankelSize: Half, TwiceOrder
);
names!(
    /// The criterion for the number of lags.
    LagCriterion as Criterion: Aicc = Aicc, Bic = Bic
);
names!(
    /// The input between its samples.
    Hold as crumple_sysid::Hold: FirstOrder = First, ZeroOrder = Zero
);
names!(
    /// The motion at the start of the window.
    Initial as InitialConditions: Estimate = Estimate, Zero = Zero, Auto = Auto
);
names!(
    /// A way to starting points of a transfer function.
    StartName as Start: Svf = Svf, Iv = Iv, N4sid = N4sid, Arx = Arx, Integrators = Integrators,
    Random = Random
);
names!(
    /// What a sum of exponentials has at the start of the window.
    Condition: Position, Velocity, Acceleration
);
names!(
    /// How noise is drawn from residuals.
    Noise as Resampling: Blocks = Blocks, Autoregression = Autoregression
);
names!(
    /// A paper whose procedure is followed.
    Paper: Era, CurveFit, Tfest
);

impl Method {
    /// Whether it takes records for impulse responses, and has no input.
    pub fn is_of_free_motion(self) -> bool {
        self == Self::Era
    }

    /// The weighting of a subspace method.
    pub fn weighting(self) -> Option<Weighting> {
        match self {
            Self::N4sid => Some(Weighting::N4sid),
            Self::Moesp => Some(Weighting::Moesp),
            Self::Cva => Some(Weighting::Cva),
            _ => None,
        }
    }
}

/// Where free motion starts: at the time of separation, or where the pulse stays under a share of its peak.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum FreeDecay {
    /// The time of the rebound velocity.
    Separation,
    /// This share of the peak.
    Share(f64),
}

impl FreeDecay {
    /// The share; 0 of the separation.
    pub fn share(self) -> f64 {
        match self {
            Self::Separation => 0.0,
            Self::Share(share) => share,
        }
    }
}

impl FromStr for FreeDecay {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "separation" {
            return Ok(Self::Separation);
        }
        let percent = text.strip_suffix('%').and_then(|number| number.trim().parse::<f64>().ok());
        percent
            .filter(|percent| *percent > 0.0 && *percent < 100.0)
            .map(|percent| Self::Share(percent / 100.0))
            .ok_or_else(|| {
                format!("free decay {text:?} is neither \"separation\" nor a share of the peak, for instance 5%")
            })
    }
}

impl TryFrom<String> for FreeDecay {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<FreeDecay> for String {
    fn from(decay: FreeDecay) -> Self {
        match decay {
            FreeDecay::Separation => "separation".to_owned(),
            FreeDecay::Share(share) => format!("{}%", 100.0 * share),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_one_in_flags_and_files() {
        for method in Method::value_variants() {
            let in_file = serde_json::to_value(method).unwrap();
            assert_eq!(in_file, method.to_string());
            assert_eq!(Method::from_str(&method.to_string(), false), Ok(*method));
        }
        for start in StartName::value_variants() {
            assert_eq!(Start::from(*start).name(), start.to_string());
        }
    }

    #[test]
    fn a_free_decay_is_a_share_of_the_peak_or_the_separation() {
        assert_eq!("5%".parse(), Ok(FreeDecay::Share(0.05)));
        assert_eq!(serde_json::from_str::<FreeDecay>("\"separation\"").unwrap(), FreeDecay::Separation);
        assert!("5".parse::<FreeDecay>().unwrap_err().contains("neither"));
    }
}
