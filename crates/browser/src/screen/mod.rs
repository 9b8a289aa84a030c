//! What a page is shown on.
//! May use nothing.

mod size;

pub use size::Screen;
