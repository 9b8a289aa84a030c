//! `report.html`: one file that a browser shows without a network.

use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;

use super::{
    candidates, channels, conclusion as top, energy, figures, header, how_well, key_numbers, model_picture, models,
    numbers, predictions, ratings, remarks, what_if,
};
use crate::conclusions::conclusion::conclusion;
use crate::drawing::look::{page_rules, palette};
use crate::figures::all::{crash_figures, identification_figures};
use crate::text::escape::html;
use crate::{Ranking, Run, summary};

const STYLE: &str = include_str!("style.css");
const FIGURES: &str = include_str!("figures.js");

/// What the browser may load: what is in the file. It keeps the promise of a report without a network, whatever the
/// text of a test may ask for.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
                      font-src data:; base-uri 'none'; form-action 'none'";

/// A report, ready to be written.
#[derive(Debug)]
pub struct Page(String);

impl Page {
    /// Lays the report out. The same run gives the same bytes.
    pub fn new(run: &Run, ranking: &Ranking) -> Self {
        let (crash, identification) = (crash_figures(run, ranking), identification_figures(run));
        let (said, concerns) = conclusion(run, ranking);
        let phrases = run.language.phrases();
        let mut body = String::with_capacity(1 << 20);
        body.push_str(&format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"generator\" content=\"crumple-report {}\">\n<title>{} – Crumple</title>\n\
             <style>\n{}{STYLE}{}{}{}{}</style>\n<style id=\"figure-style\">\n{}</style>\n</head>\n<body>\n",
            env!("CARGO_PKG_VERSION"),
            html(&run.test.title),
            palette(),
            model_picture::STYLE,
            candidates::STYLE,
            what_if::STYLE,
            figures::toggle_rules(crash.iter().chain(&identification)),
            page_rules()
        ));
        header::write(&mut body, run, |body| top::write(body, &said, phrases));
        body.push_str("<main>\n");
        key_numbers::write(&mut body, run);
        model_picture::write(&mut body, run, ranking);
        top::write_before_use(&mut body, &said, &concerns, phrases);
        figures::write(&mut body, &crash, "h2");
        if run.is_generic() {
            models::write(&mut body, run, &identification);
        }
        what_if::write(&mut body, run, ranking);
        candidates::write(&mut body, run, ranking);
        how_well::write(&mut body, run, ranking);
        predictions::write(&mut body, run);
        ratings::write(&mut body, run, ranking);
        energy::write(&mut body, run, ranking);
        if !run.is_generic() {
            models::write(&mut body, run, &identification);
        }
        numbers::write(&mut body, run);
        channels::write(&mut body, run);
        remarks::write_missing(&mut body, run);
        remarks::write_notes(&mut body, run, &concerns);
        remarks::write_limits(&mut body, run, ranking);
        remarks::write_provenance(&mut body, run);
        if let Ok(packed) = packed_summary(run, ranking) {
            body.push_str(&format!("<script type=\"text/plain\" id=\"summary-data\">{packed}</script>\n"));
        }
        body.push_str(&format!("</main>\n<script>\n{FIGURES}</script>\n</body>\n</html>\n"));
        Self(reachable(&body))
    }

    /// Writes it.
    pub fn write_to(&self, mut writer: impl Write) -> io::Result<()> {
        writer.write_all(self.0.as_bytes())
    }
}

/// The summary for its download, gzip in base 64: a sixth of its length.
fn packed_summary(run: &Run, ranking: &Ranking) -> io::Result<String> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(summary(run, ranking).to_json()?.as_bytes())?;
    Ok(STANDARD.encode(encoder.finish()?))
}

/// Definitions that stand in `title` come by tap and key too: what has one can be focused, and the style shows it.
fn reachable(page: &str) -> String {
    // In texts a quotation mark is an entity, so that this is an attribute wherever it stands.
    page.replace(" title=\"", " tabindex=\"0\" title=\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_script_is_small_and_cannot_end_its_element() {
        assert!(!FIGURES.contains("</script") && !FIGURES.contains("<!--"));
        assert!(FIGURES.len() < 20_000, "{}", FIGURES.len());
    }
}
