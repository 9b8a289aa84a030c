//! What a page is shown on.

mod size;

pub use size::Screen;
