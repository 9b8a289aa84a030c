//! Texts without a check, each with its reason: labels that claim nothing, and texts of other surfaces.

/// Subjects of `phrases` that none of the surfaces shows: they stand below the first screen, on other pages, or in
/// another program.
pub const ELSEWHERE: &[(&str, &str)] = &[
    ("figures", "axes, legends and captions of figures, below the first screen"),
    ("identification", "section of the identified models, below the first screen of a crash"),
    ("joint", "one model of several tests: said by just together, not by a run"),
    ("candidates", "table of all candidates, below the first screen"),
    ("how_well", "tables of ratings and energy, below the first screen"),
    ("predictions", "table of predictions, below the first screen"),
    ("runs", "pages of several runs"),
    ("fleet", "pages of a fleet"),
    ("cursor", "what the script of the figures says when somebody points"),
    ("what_if", "the sliders"),
];

/// Texts that name what stands beside them and claim nothing.
pub const LABELS: &[&str] = &[
    "page.brand",
    "page.brand_generic",
    "page.untitled",
    "page.vehicle",
    "page.test_mass",
    "page.impact_speed",
    "page.barrier",
    "page.channel_taken",
    "page.sampling",
    "page.axis",
    "page.to",
    "page.yes",
    "page.no",
    "numbers.key_numbers",
    "numbers.motion_over_ground",
    "numbers.peak_cfc",
    "numbers.peak_filtered",
    "numbers.inputs",
    "numbers.resolution",
    "numbers.interval",
    "numbers.olc",
    "numbers.hic",
    "model.title",
    "model.caption",
    "conclusion.verdict",
    "conclusion.level",
    "conclusion.about_record",
    "conclusion.about_model",
    "conclusion.about_predictions",
    "conclusion.about_occupants",
    "conclusion.about_wall_force",
    "conclusion.about_identified_models",
    "conclusion.ground_label",
    "conclusion.model_label",
    "conclusion.warnings_label",
    "conclusion.missing_label",
    "conclusion.files_label",
    "conclusion.failed_label",
    "conclusion.doubtful_label",
    "conclusion.and",
    "conclusion.given",
    "conclusion.read_the_notes",
    "conclusion.curve",
    "conclusion.as_one_spring",
    "conclusion.over_sensors",
];

/// Texts of a subject of runs that no run can print, each with its reason.
pub const NOT_OF_A_RUN: &[(&str, &str)] = &[
    ("conclusion.because_tests_disagree", "one model of several tests: said by just together"),
    (
        "conclusion.because_other_axis",
        "a record that another program wrote: ingest doubts such a pulse, which goes first",
    ),
    ("conclusion.other_axis", "as the reason of the status"),
];

/// Subjects of which only the texts with a rule stand on the surfaces; the others stand below the first screen.
pub const BELOW: &[(&str, &str)] = &[
    ("page", "words of every table, and the channels"),
    ("numbers", "tables of events and metrics"),
    ("model", "words in the drawing of a model, which are its parameters"),
    ("remarks", "notes, limits and provenance"),
];
