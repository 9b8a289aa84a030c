//! Figures on the page: heading, legend, panels, caption. They are drawn without a script, which adds a cursor, a zoom
//! and downloads.

use rayon::prelude::*;

use crate::drawing::escape::html;
use crate::drawing::{Drawing, Figure, swatch};
use crate::frame::caption;

/// Writes figures into a grid of two columns where the window has room for them, under headings of an element.
pub(crate) fn write(out: &mut String, figures: &[Figure], heading: &str) {
    if figures.is_empty() {
        return;
    }
    out.push_str("<div class=\"figures\">\n");
    out.extend(figures.par_iter().map(|figure| written(figure, heading)).collect::<Vec<_>>());
    out.push_str("</div>\n");
}

fn written(figure: &Figure, heading: &str) -> String {
    let mut out = String::new();
    let id = figure.id;
    let wide = if figure.panels.len() > 1 { " wide" } else { "" };
    out.push_str(&format!(
        "<section class=\"figure{wide}\" id=\"{id}\" aria-labelledby=\"{id}-title\">\n\
         <{heading} id=\"{id}-title\">{}</{heading}>\n<ul class=\"legend\" aria-label=\"Curves, to show or hide\">\n",
        html(&figure.title)
    ));
    for entry in &figure.legend {
        // A box that is ticked shows its curves by style alone, so that it works without a script.
        out.push_str(&format!(
            "<li><label><input type=\"checkbox\" autocomplete=\"off\"{}>\
             <svg viewBox=\"0 0 28 12\" aria-hidden=\"true\">{}</svg>{}</label></li>\n",
            if entry.shown { " checked" } else { "" },
            swatch(entry),
            html(&entry.name)
        ));
    }
    if figure.legend.iter().any(|entry| !entry.shown) {
        // The names of curves that wait are shown on demand, by style alone.
        out.push_str(
            "<li class=\"all\"><label><input type=\"checkbox\" autocomplete=\"off\">names of the hidden \
             curves</label></li>\n",
        );
    }
    out.push_str("</ul>\n<div class=\"panels\">\n");
    let svg = |(place, panel)| Drawing::new(figure, panel).svg(&format!("{id}-{place}"), true);
    out.extend(figure.panels.par_iter().enumerate().map(svg).collect::<Vec<_>>());
    out.push_str("</div>\n");
    if !figure.caption.is_empty() {
        out.push_str(&caption(&html(&figure.caption)));
    }
    out.push_str("</section>\n");
    out
}

/// Rules by which a legend's box hides its curves.
pub(crate) fn toggle_rules<'a>(figures: impl Iterator<Item = &'a Figure>) -> String {
    let most = figures.map(|figure| figure.legend.len()).max().unwrap_or(0);
    let rule = |k: usize| {
        format!(
            ".figure:has(.legend li:nth-child({}) input:not(:checked)) :is(.panels,.file) .e{k}{{display:none}}\n",
            k + 1
        )
    };
    (0..most).map(rule).collect()
}
