//! One model of several tests: the tests, and what the model of the others says of each.

use crumple_artifact::records::{AgainstTestV1, JointTestV1, PredictionV1, TestsV2};

/// The tests of a joint model.
#[derive(Debug, Clone, Default)]
pub struct JointTests {
    /// Each test, in the order given.
    pub tests: Vec<TestOfJointModel>,
}

/// A test of a joint model.
#[derive(Debug, Clone)]
pub struct TestOfJointModel {
    /// The test.
    pub test: JointTestV1,
    /// What the model of the others says of it.
    pub left_out: LeftOut,
}

/// A test predicted from the others.
#[derive(Debug, Clone)]
pub enum LeftOut {
    /// Nobody has tried.
    NotTried,
    /// It was not predicted, and why.
    NotPredicted(String),
    /// The prediction of the recommended candidate, else of the closest.
    Predicted(Box<PredictionV1>),
}

impl JointTests {
    /// The tests of a record, none left out yet.
    pub fn new(tests: TestsV2) -> Self {
        Self {
            tests: tests.tests.into_iter().map(|test| TestOfJointModel { test, left_out: LeftOut::NotTried }).collect(),
        }
    }

    /// `a + b + c`.
    pub fn names(&self) -> String {
        self.tests.iter().map(|test| test.test.name.as_str()).collect::<Vec<_>>().join(" + ")
    }

    /// Names of the tests whose crush the others miss, each with the error.
    pub fn missed(&self) -> Vec<(&str, f64)> {
        let missed = |test: &TestOfJointModel| test.against()?.missed_crush_percent();
        self.tests.iter().filter_map(|test| Some((test.test.name.as_str(), missed(test)?))).collect()
    }
}

impl TestOfJointModel {
    /// The test beside its prediction from the others.
    pub fn against(&self) -> Option<&AgainstTestV1> {
        match &self.left_out {
            LeftOut::Predicted(prediction) => prediction.against.as_ref(),
            LeftOut::NotTried | LeftOut::NotPredicted(_) => None,
        }
    }
}
