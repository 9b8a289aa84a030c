//! All words of pages, Markdown and console, English and German beside each other. `{name}` in a text is filled in.
//! Uses no other room.

/// Texts as fields of a struct: `name: "English", "Deutsch";`. One that lacks a language does not compile.
macro_rules! texts {
    ($name:ident $($field:ident: $english:expr, $german:expr;)+) => {
        #[doc = concat!("Texts of one language: ", stringify!($name), ".")]
        #[derive(Debug, serde::Serialize)]
        #[allow(missing_docs, reason = "a field is named after its text")]
        pub struct $name {
            $(#[doc = $english] pub $field: &'static str,)+
        }

        impl $name {
            /// In English.
            pub const ENGLISH: Self = Self { $($field: $english,)+ };
            /// In German.
            pub const GERMAN: Self = Self { $($field: $german,)+ };
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

/// The texts of one language, by what they are about.
#[derive(Debug)]
pub struct Phrases {
    /// Conclusion, warnings, console.
    pub conclusion: ConclusionTexts,
    /// Header and channels.
    pub page: PageTexts,
    /// Key numbers, events and metrics.
    pub numbers: NumberTexts,
    /// Figures of the crash.
    pub figures: FigureTexts,
    /// Identified models and their figures.
    pub identification: IdentificationTexts,
    /// One model of several tests.
    pub joint: JointTexts,
    /// Pictures of models.
    pub model: ModelTexts,
    /// Candidates and which to use.
    pub candidates: CandidateTexts,
    /// How well models follow the test.
    pub how_well: HowWellTexts,
    /// Predictions.
    pub predictions: PredictionTexts,
    /// What is missing, notes, limits, provenance.
    pub remarks: RemarkTexts,
    /// Several runs on one page.
    pub runs: RunTexts,
    /// The page of a fleet, and what its pages share.
    pub fleet: FleetTexts,
    /// What the script of the figures says.
    pub cursor: CursorTexts,
    /// The sliders and what their script says.
    pub what_if: WhatIfTexts,
}

/// All texts in a language, by the constant of that name.
macro_rules! phrases {
    ($language:ident) => {
        Phrases {
            conclusion: ConclusionTexts::$language,
            page: PageTexts::$language,
            numbers: NumberTexts::$language,
            figures: FigureTexts::$language,
            identification: IdentificationTexts::$language,
            joint: JointTexts::$language,
            model: ModelTexts::$language,
            candidates: CandidateTexts::$language,
            how_well: HowWellTexts::$language,
            predictions: PredictionTexts::$language,
            remarks: RemarkTexts::$language,
            runs: RunTexts::$language,
            fleet: FleetTexts::$language,
            cursor: CursorTexts::$language,
            what_if: WhatIfTexts::$language,
        }
    };
}

/// English.
pub const ENGLISH: Phrases = phrases!(ENGLISH);
/// German.
pub const GERMAN: Phrases = phrases!(GERMAN);
