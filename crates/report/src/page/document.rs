//! `report.html`: one file that a browser shows without a network.

use std::io::{self, Write};

use super::{
    candidates, channels, conclusion as top, energy, header, how_well, key_numbers, model_picture, models, numbers,
    predictions, ratings, remarks, what_if,
};
use crate::drawing::figure::Figure;
use crate::figures::all::all_figures;
use crate::results::conclusion::conclusion;
use crate::text::escape::{html, json_in_script};
use crate::{Ranking, Run};

const STYLE: &str = include_str!("style.css");
const DRAW: &str = include_str!("draw.js");
/// plotly.js, taken from the plotly crate by the build script.
const PLOTLY: &str = include_str!(concat!(env!("OUT_DIR"), "/plotly.min.js"));

/// What the browser may load: what is in the file. It keeps the promise of a report without a network, whatever plotly
/// or the text of a test may ask for.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
                      font-src data:; base-uri 'none'; form-action 'none'";

/// A report, ready to be written.
#[derive(Debug)]
pub struct Page {
    /// Everything up to plotly's script.
    head: String,
    /// Everything after it.
    tail: String,
}

impl Page {
    /// Lays the report out. The same run gives the same bytes.
    pub fn new(run: &Run, ranking: &Ranking) -> Self {
        let figures = all_figures(run, ranking);
        let (said, concerns) = conclusion(run, ranking);
        let phrases = run.language.phrases();
        let mut body = String::with_capacity(1 << 20);
        body.push_str(&format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"generator\" content=\"crumple-report {}\">\n<title>{} – Crumple</title>\n\
             <style>\n{STYLE}{}{}{}</style>\n</head>\n<body>\n",
            env!("CARGO_PKG_VERSION"),
            html(&run.test.title),
            model_picture::STYLE,
            candidates::STYLE,
            what_if::STYLE
        ));
        header::write(&mut body, run, |body| top::write(body, &said, phrases));
        body.push_str("<main>\n");
        key_numbers::write(&mut body, run);
        model_picture::write(&mut body, run, ranking);
        top::write_before_use(&mut body, &said, &concerns, phrases);
        let mut pair_open = false;
        for (index, figure) in figures.iter().enumerate() {
            // Two figures of half a width share a row; a lone one has it for itself.
            let next_is_half = figures.get(index + 1).is_some_and(|next| next.half_width);
            if figure.half_width && !pair_open && next_is_half {
                body.push_str("<div class=\"pair\">\n");
                pair_open = true;
            }
            write_figure(&mut body, figure);
            if pair_open && !(figure.half_width && next_is_half) {
                body.push_str("</div>\n");
                pair_open = false;
            }
        }
        what_if::write(&mut body, run, ranking);
        candidates::write(&mut body, run, ranking);
        how_well::write(&mut body, run, ranking);
        predictions::write(&mut body, run);
        ratings::write(&mut body, run, ranking);
        energy::write(&mut body, run, ranking);
        models::write(&mut body, run);
        numbers::write(&mut body, run);
        channels::write(&mut body, run);
        remarks::write_missing(&mut body, run);
        remarks::write_notes(&mut body, run, &concerns);
        remarks::write_limits(&mut body, run, ranking);
        remarks::write_provenance(&mut body, run);
        body.push_str("</main>\n<script>");
        Self { head: body, tail: format!("</script>\n<script>\n{DRAW}</script>\n</body>\n</html>\n") }
    }

    /// Writes it.
    pub fn write_to(&self, mut writer: impl Write) -> io::Result<()> {
        writer.write_all(self.head.as_bytes())?;
        writer.write_all(PLOTLY.as_bytes())?;
        writer.write_all(self.tail.as_bytes())
    }
}

fn write_figure(out: &mut String, figure: &Figure) {
    let Figure { id, title, height_px, .. } = figure;
    out.push_str(&format!(
        "<section class=\"figure\" aria-labelledby=\"{id}-title\">\n<h2 id=\"{id}-title\">{}</h2>\n\
         <div class=\"plot\" id=\"{id}\" role=\"img\" aria-describedby=\"{id}-caption\" \
         style=\"height:{height_px}px\"></div>\n\
         <script type=\"application/json\" id=\"{id}-data\">{}</script>\n\
         <p class=\"caption\" id=\"{id}-caption\">{}</p>\n</section>\n",
        html(title),
        json_in_script(&figure.to_json()),
        html(&figure.caption)
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_script_is_plotly_alone_and_cannot_end_its_element() {
        assert!(PLOTLY.contains("plotly.js v") && PLOTLY.contains("window.Plotly"));
        assert!(!PLOTLY.contains("</script") && !PLOTLY.contains("<!--"));
        // MathJax would be another 2 MB.
        assert!(PLOTLY.len() < 5_000_000, "{}", PLOTLY.len());
    }
}
