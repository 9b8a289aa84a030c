//! What became of each record in a comparison of two results.

use crumple_diff::Comparison;

use super::review::Review;

/// A record in a comparison.
#[derive(Debug)]
pub struct Compared {
    /// What it is called on both sides.
    pub name: String,
    /// What became of it.
    pub outcome: Outcome,
}

/// What became of a record.
#[derive(Debug)]
#[allow(clippy::large_enum_variant, reason = "one a record, and nearly all of them are reviews")]
pub enum Outcome {
    /// Both sides have results of it.
    Reviewed(Review, Comparison),
    /// Only the second side has results of it: nobody has accepted them.
    New {
        /// What is there and where.
        problem: String,
    },
    /// There is nothing to compare.
    Trouble(Trouble),
}

/// Why there is nothing to compare.
#[derive(Debug)]
pub struct Trouble {
    /// Which of the three it is.
    pub kind: TroubleKind,
    /// What was found where.
    pub problem: String,
    /// One thing to do.
    pub hint: String,
}

/// What keeps a record from being compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TroubleKind {
    /// The last run of it failed: what lies there is of an earlier one.
    Refused,
    /// The second side has no run of it.
    Missing,
    /// A result is damaged, or results of two runs are mixed.
    Unreadable,
}

impl Compared {
    /// The review, where both sides have results.
    pub fn review(&self) -> Option<(&Review, &Comparison)> {
        match &self.outcome {
            Outcome::Reviewed(review, comparison) => Some((review, comparison)),
            _ => None,
        }
    }

    /// Whether both sides have results, and these are the same.
    pub fn is_same(&self) -> bool {
        self.review().is_some_and(|(_, comparison)| comparison.same)
    }

    /// Why it could not be compared; `None`: it was.
    pub fn trouble(&self) -> Option<&Trouble> {
        match &self.outcome {
            Outcome::Trouble(trouble) => Some(trouble),
            _ => None,
        }
    }

    /// What became of it, in a word.
    pub fn word(&self) -> &'static str {
        match &self.outcome {
            Outcome::Reviewed(_, comparison) if comparison.same => "same",
            Outcome::Reviewed(..) => "different",
            Outcome::New { .. } => "not-accepted",
            Outcome::Trouble(trouble) => trouble.kind.word(),
        }
    }

    /// What became of it, for people.
    pub fn said_word(&self) -> &'static str {
        match &self.outcome {
            Outcome::New { .. } => "never accepted",
            _ => self.word(),
        }
    }

    /// Why there is no review of it.
    pub fn problem(&self) -> Option<&str> {
        match &self.outcome {
            Outcome::Reviewed(..) => None,
            Outcome::New { problem } | Outcome::Trouble(Trouble { problem, .. }) => Some(problem),
        }
    }
}

impl TroubleKind {
    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Refused => "refused",
            Self::Missing => "missing",
            Self::Unreadable => "unreadable",
        }
    }
}
