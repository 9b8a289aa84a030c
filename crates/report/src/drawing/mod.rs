//! Vector graphics for pages: what a figure says, the SVG that becomes of it, small lines for tables, and the numbers
//! and texts in them.
//!
//! A [`Figure`] is panels of curves, bands and marks over axes with one legend; [`Drawing`] lays a panel out for a
//! page, [`Figure::to_svg`] the whole as a file of its own. The same figure gives the same bytes.

mod figures;
mod text;

pub use crumple_stage::numbers;
pub use figures::figure::{Axis, Curve, Entry, Figure, Label, Link, Mark, Panel, over, over_time, span};
pub use figures::file::swatch;
pub use figures::look::{Colour, Dash, Look, Symbol, Width, file_rules, page_rules, palette};
pub use figures::panel::{Drawing, WIDTH};
pub use figures::sparkline::sparkline;
pub use text::escape;
