//! Several runs on one page: their curves over each other, numbers, parameters and settings side by side, marked where
//! they differ. Uses page, drawing, figures, conclusions, results and text; what counts as different is crumple-diff's.

pub mod document;
pub mod figure;
pub mod first_screen;
pub mod numbers;
pub mod settings;
pub mod table;
