//! The page as a whole.

use std::io::Write;
use std::path::Path;

use anyhow::Context;
use crumple_artifact::{OutputKind, write_atomically};

use crate::page::failures::failures;
use crate::page::histogram::histogram;
use crate::page::markup::escaped;
use crate::page::quantities::{CRUSH, MASS, OLC, RESTITUTION, SPEED, STIFFNESS, YEAR};
use crate::page::run_table::run_table;
use crate::page::scatter::scatter;
use crate::tables::rows::Row;

/// Writes `fleet.html` in one piece.
pub(crate) fn write_page(fleet: &Path, rows: &[Row]) -> anyhow::Result<()> {
    let path = fleet.join("fleet.html");
    let page = page(fleet, rows);
    write_atomically(&path, OutputKind::Report, |file| file.write_all(page.as_bytes()))
        .with_context(|| format!("cannot write {}", path.display()))
}

fn page(fleet: &Path, rows: &[Row]) -> String {
    let name = escaped(&fleet.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default());
    let done = rows.iter().filter(|row| row.ended.exit_code == 0).count();
    let figures: String =
        [STIFFNESS, CRUSH, OLC].into_iter().flat_map(|y| [MASS, SPEED, YEAR].map(|x| scatter(rows, x, y))).collect();
    let distributions: String =
        [MASS, SPEED, CRUSH, OLC, STIFFNESS, RESTITUTION].map(|quantity| histogram(rows, quantity)).concat();
    let failures = failures(rows);
    let failed = if failures.is_empty() { String::new() } else { format!("<h2>Without a result</h2>{failures}") };
    format!(
        "<!DOCTYPE html>\n<html lang=en><meta charset=utf-8><meta name=viewport content=\"width=device-width\">\n\
         <meta name=generator content=\"crumple-fleet {}\">\n\
         <title>{name}: {} runs</title>\n<style>\n{}</style>\n<h1>{name}</h1>\n\
         <p>{} runs, {done} done. Tables of all that is here: <a href=tests.csv>tests</a>, \
         <a href=candidates.csv>candidates</a>, <a href=metrics.csv>metrics</a>, \
         <a href=predictions.csv>predictions</a>, each as .parquet too.</p>\n{failed}\n\
         <h2>Over mass, speed and model year</h2>\n\
         <p>A point a run; the line is the least-squares line, open circles lie more than four robust standard \
         deviations off it and lead to their reports.</p>\n<div class=f>{figures}</div>\n\
         <h2>Distributions</h2>\n<div class=f>{distributions}</div>\n\
         <h2>Runs</h2>\n<p>A click on a column sorts.</p>\n{}\n<script>\n{}</script>\n",
        env!("CARGO_PKG_VERSION"),
        rows.len(),
        include_str!("style.css"),
        rows.len(),
        run_table(fleet, rows),
        include_str!("sort.js"),
    )
}
