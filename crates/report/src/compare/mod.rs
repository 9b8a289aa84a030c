//! Several runs on one page: curves over each other, numbers, parameters and settings side by side, differences marked.
//! What counts as different is crumple-diff's.

pub mod compared_run;
pub mod document;
pub mod figure;
pub mod first_screen;
pub mod numbers;
pub mod quantities;
pub mod review;
pub mod review_files;
pub mod settings;
pub mod table;
pub mod why;
