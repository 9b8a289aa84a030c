//! What a check has found.

/// What one check has found in one run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Found {
    /// How much was compared with the truth.
    pub checked: usize,
    /// What contradicts it.
    pub wrong: Vec<String>,
    /// Statements that may fail now and then: of what, quantity, whether they hold.
    pub counted: Vec<(&'static str, String, bool)>,
}

impl Found {
    /// Something that must hold; else what is wrong.
    pub fn holds(&mut self, condition: bool, what: impl FnOnce() -> String) {
        self.checked += 1;
        if !condition {
            self.wrong.push(what());
        }
    }

    /// A number must be that of the truth, to so much.
    pub fn near(&mut self, what: &str, own: f64, truth: f64, tolerance: f64) {
        self.holds((own - truth).abs() <= tolerance, || format!("{what} is {own:.6}, in truth {truth:.6}"));
    }

    /// The same of numbers that may be missing: the one of the run must be there where the truth is.
    pub fn same(&mut self, what: &str, own: Option<f64>, truth: Option<f64>, relative: f64) {
        if let Some(truth) = truth {
            self.holds(own.is_some(), || format!("{what} is not there, in truth {truth:.6}"));
            if let Some(own) = own {
                self.near(what, own, truth, relative * truth.abs() + 1e-9);
            }
        }
    }

    /// A statement that holds as often as its level says.
    pub fn count(&mut self, kind: &'static str, quantity: &str, holds: bool) {
        self.checked += 1;
        self.counted.push((kind, quantity.to_owned(), holds));
    }
}
