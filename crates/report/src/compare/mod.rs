//! Several runs on one page: curves over each other, numbers, parameters and settings side by side, differences marked.
//! What counts as different is crumple-diff's.

pub mod causes;
pub mod compared;
pub mod compared_run;
pub mod document;
pub mod expected;
pub mod facts;
pub mod figure;
pub mod first_screen;
pub mod numbers;
pub mod quantities;
pub mod review;
pub mod review_files;
pub mod scenarios;
pub mod settings;
pub mod table;
pub mod why;
