//! One row a run, sorted by a click on a column.

use std::fmt::Write as _;
use std::path::Path;

use rayon::prelude::*;

use crate::page::markup::{escaped, link, number};
use crate::page::quantities::{CRUSH, MASS, OLC, Quantity, RESTITUTION, SPEED, STIFFNESS};
use crate::page::sparkline::sparkline;
use crate::tables::rows::Row;
use crate::tables::tests_table::status;

/// Columns of numbers.
const NUMBERS: [Quantity; 6] = [MASS, SPEED, CRUSH, OLC, STIFFNESS, RESTITUTION];

/// The table.
pub(crate) fn run_table(fleet: &Path, rows: &[Row]) -> String {
    let several =
        rows.iter().any(|row| row.run.pipeline_name != rows[0].run.pipeline_name || !row.run.settings.is_empty());
    let mut html = "<table id=runs><thead><tr><th>record<th>vehicle".to_owned();
    if several {
        html.push_str("<th>pipeline");
    }
    for quantity in NUMBERS {
        // Writing to a string does not fail.
        let _ = write!(html, "<th class=n>{}", quantity.label());
    }
    html.push_str("<th>recommended<th>pulse</thead><tbody>\n");
    let row_html: Vec<String> = rows.par_iter().map(|row| table_row(fleet, row, several)).collect();
    html.extend(row_html);
    html.push_str("</tbody></table>");
    html
}

fn table_row(fleet: &Path, row: &Row, several: bool) -> String {
    let name = escaped(&row.run.record.identity);
    let mut html = match row.summary {
        Some(_) => format!("<tr><td><a href=\"{}/report.html\">{name}</a>", link(&row.run.folder)),
        None => format!("<tr><td>{name}"),
    };
    let vehicle = row.summary.as_ref().and_then(|summary| summary.test.vehicle.as_deref());
    // Writing to a string does not fail.
    let _ = write!(html, "<td>{}", escaped(vehicle.unwrap_or_default()));
    if several {
        let settings = row.run.settings();
        let _ = write!(html, "<td>{} {}", escaped(&row.run.pipeline_name), escaped(&settings));
    }
    for quantity in NUMBERS {
        let _ = write!(html, "<td>{}", (quantity.of)(row).map_or_else(String::new, |value| number(value, 3)));
    }
    let recommended = row.summary.as_ref().and_then(|summary| summary.recommended.as_deref());
    let model = recommended.map(|id| id.split('/').next().unwrap_or(id));
    let word = model.unwrap_or(if row.ended.exit_code == 0 { "none" } else { status(row.ended.exit_code) });
    let _ = writeln!(html, "<td>{}<td>{}", escaped(word), sparkline(fleet, row).unwrap_or_default());
    html
}
