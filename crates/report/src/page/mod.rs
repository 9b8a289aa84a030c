//! The page as HTML: its frame and its sections.

pub mod candidates;
pub mod channels;
pub mod conclusion;
mod contents;
pub mod document;
pub mod energy;
pub mod figures;
pub mod header;
pub mod how_well;
pub mod key_numbers;
pub mod model_picture;
pub mod models;
pub mod numbers;
pub mod predictions;
pub mod ratings;
pub mod remarks;
pub mod what_if;

/// Heading of a section whose content is shown on demand; [`UNFOLDED`] ends it.
fn folded(title: &str) -> String {
    format!("<h2>{title}</h2>\n<details><summary>show</summary>\n")
}

/// The end of a section with a heading of [`folded`].
const UNFOLDED: &str = "</details>\n</section>\n";
