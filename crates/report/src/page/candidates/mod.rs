//! The candidates: which to use and why, a row a distinct curve, every one with its remarks.

use crate::findings::{Ranking, Run, Status};
use crate::frame::Column;

mod bars;
mod curves;
mod every_candidate;
mod recommendation;
mod uncertainty;

/// What the bars look like, for the style of the page.
pub(super) const STYLE: &str = include_str!("style.css");

// Columns that two tables have.
const CRUSH_ERROR: Column = Column::number("ΔC").of("mm").means("Dynamic crush, model minus test.");
const TIME_ERROR: Column = Column::number("Δt<sub>m</sub>, ms").means("Time of dynamic crush, model minus test.");

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking, status: Option<Status>) {
    if run.candidates.is_empty() && run.recommendation.is_none() {
        return;
    }
    out.push_str(
        "<section id=\"candidates\" aria-labelledby=\"candidates-title\">\n\
         <h2 id=\"candidates-title\">Which model to use</h2>\n",
    );
    recommendation::write_roles(out, run, status);
    curves::write(out, run, ranking);
    recommendation::write_evidence(out, run);
    every_candidate::write(out, run, ranking);
    out.push_str("</section>\n");
}
