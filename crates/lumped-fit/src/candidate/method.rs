//! Methods by which parameters are found: their names in files and what each is.

use std::fmt;
use std::str::FromStr;

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
    /// By the general global search, ended by a descent.
    LShade,
    /// By the interior-point method of the single-mass paper.
    InteriorPoint,
}

/// Name in candidate ids and pipeline files, and what the method is in a few words, in the order of the variants. The
/// names are part of the file format.
const TABLE: [(Method, &str, &str); 7] = [
    (Method::ClosedForm, "closed-form", "from the crash events"),
    (Method::DirectFit, "direct-fit", "to the motion of the test"),
    (Method::CoefficientMatching, "coefficient-matching", "from an identified model with four poles: every solution"),
    (Method::CurveFit, "curve-fit", "from four real exponentials, as the ERA paper prints it: for reproduction only"),
    (Method::Firefly, "firefly", "population search of the single-mass paper"),
    (Method::LShade, "l-shade", "general global search, then a descent"),
    (Method::InteriorPoint, "interior-point", "side constraints as in the single-mass paper"),
];

/// All methods.
pub const METHODS: [Method; TABLE.len()] = {
    let mut methods = [Method::ClosedForm; TABLE.len()];
    let mut k = 0;
    while k < TABLE.len() {
        methods[k] = TABLE[k].0;
        k += 1;
    }
    methods
};

impl Method {
    /// The name in candidate ids and pipeline files.
    pub const fn name(self) -> &'static str {
        TABLE[self as usize].1
    }

    /// What it is, in a few words.
    pub const fn about(self) -> &'static str {
        TABLE[self as usize].2
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_follows_the_variants() {
        for (k, method) in METHODS.into_iter().enumerate() {
            assert_eq!(method as usize, k);
            assert_eq!(method.name().parse(), Ok(method));
        }
    }
}
