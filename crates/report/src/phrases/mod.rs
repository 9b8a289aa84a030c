//! All texts of pages, Markdown and console by subject, and numbers as people write them. `{name}` in a text is filled
//! in.

/// Texts as fields of a struct: `name: "text";`.
macro_rules! texts {
    ($name:ident $($field:ident: $text:expr;)+) => {
        #[doc = concat!("Texts: ", stringify!($name), ".")]
        #[derive(Debug, serde::Serialize)]
        #[allow(missing_docs, reason = "a field is named after its text")]
        pub struct $name {
            $(#[doc = $text] pub $field: &'static str,)+
        }

        impl $name {
            /// The texts.
            pub const TEXTS: Self = Self { $($field: $text,)+ };
            /// The texts, with the name of each.
            pub const NAMED: &[(&str, &str)] = &[$((stringify!($field), $text),)+];
        }
    };
}

mod candidates;
mod conclusion;
mod figures;
mod how_well;
mod identification;
mod model_picture;
mod numbers;
mod page;
mod predictions;
mod remarks;
mod runs;
mod scripts;
pub mod words;

pub use candidates::CandidateTexts;
pub use conclusion::ConclusionTexts;
pub use figures::FigureTexts;
pub use how_well::HowWellTexts;
pub use identification::IdentificationTexts;
pub use model_picture::ModelTexts;
pub use numbers::NumberTexts;
pub use page::PageTexts;
pub use predictions::PredictionTexts;
pub use remarks::RemarkTexts;
pub use runs::{FleetTexts, JointTexts, RunTexts};
pub use scripts::{CursorTexts, WhatIfTexts};

/// All texts, by what they are about: a field a subject.
macro_rules! phrases {
    ($($(#[$doc:meta])+ $field:ident: $texts:ident;)+) => {
        /// The texts, by what they are about.
        #[derive(Debug)]
        pub struct Phrases {
            $($(#[$doc])+ pub $field: $texts,)+
        }

        /// The texts of every subject.
        pub static PHRASES: Phrases = Phrases { $($field: $texts::TEXTS,)+ };
        /// Every text with its subject and its name.
        pub fn named() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
            let all = [$((stringify!($field), $texts::NAMED),)+];
            all.into_iter().flat_map(|(subject, texts)| texts.iter().map(move |(name, text)| (subject, *name, *text)))
        }
    };
}

phrases! {
    /// Conclusion, warnings, console.
    conclusion: ConclusionTexts;
    /// Header and channels.
    page: PageTexts;
    /// Key numbers, events and metrics.
    numbers: NumberTexts;
    /// Figures of the crash.
    figures: FigureTexts;
    /// Identified models and their figures.
    identification: IdentificationTexts;
    /// One model of several tests.
    joint: JointTexts;
    /// Pictures of models.
    model: ModelTexts;
    /// Candidates and which to use.
    candidates: CandidateTexts;
    /// How well models follow the test.
    how_well: HowWellTexts;
    /// Predictions.
    predictions: PredictionTexts;
    /// What is missing, notes, limits, provenance.
    remarks: RemarkTexts;
    /// Several runs on one page.
    runs: RunTexts;
    /// The page of a fleet, and what its pages share.
    fleet: FleetTexts;
    /// What the script of the figures says.
    cursor: CursorTexts;
    /// The sliders and what their script says.
    what_if: WhatIfTexts;
}
