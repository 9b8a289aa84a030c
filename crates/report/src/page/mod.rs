//! The page as HTML: its frame and its sections.
//! Uses figures, drawing, results and text.

pub mod candidates;
pub mod channels;
pub mod document;
pub mod energy;
mod figures;
pub mod header;
pub mod models;
pub mod numbers;
pub mod predictions;
pub mod ratings;
pub mod recommendation;
pub mod remarks;
pub mod uncertainty;
