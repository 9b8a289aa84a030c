//! A figure as a file of its own: panels side by side, title and legend, on white.

use std::fmt::Write;

use super::figure::{Entry, Figure};
use super::look::{Symbol, file_rules};
use super::panel::{Drawing, WIDTH};
use crate::drawing::text::escape::html;

const MARGIN: f64 = 16.0;
const HEAD: f64 = 40.0;
/// Width of a character of the legend on average, with room, and height of its rows.
const CHARACTER: f64 = 7.4;
const ROW: f64 = 22.0;
const SWATCH: f64 = 34.0;

impl Figure {
    /// The figure as an SVG document that every viewer reads: colours and type in it, nothing loaded. Curves that are
    /// hidden at first are left out.
    pub fn to_svg(&self) -> String {
        let drawings: Vec<Drawing> = self.panels.iter().map(|panel| Drawing::new(self, panel)).collect();
        let columns = drawings.len().clamp(1, 2);
        let width = 2.0 * MARGIN + WIDTH * columns as f64;
        let mut body = String::new();
        let mut below = HEAD;
        for (row, pair) in drawings.chunks(columns).enumerate() {
            for (column, drawing) in pair.iter().enumerate() {
                let _ = write!(
                    body,
                    "<svg x=\"{}\" y=\"{below:.1}\" width=\"{WIDTH}\" height=\"{h:.1}\" \
                     viewBox=\"0 0 {WIDTH} {h:.1}\">\n\
                     <desc>panel {}</desc>\n{}</svg>\n",
                    MARGIN + WIDTH * column as f64,
                    row * columns + column + 1,
                    drawing.content(false),
                    h = drawing.height(),
                );
            }
            below += pair.iter().map(Drawing::height).fold(0.0, f64::max);
        }
        let mut x = MARGIN;
        below += ROW;
        for entry in self.legend.iter().filter(|entry| entry.shown) {
            let wide = SWATCH + CHARACTER * entry.name.chars().count() as f64 + 12.0;
            if x > MARGIN && x + wide > width - MARGIN {
                (x, below) = (MARGIN, below + ROW);
            }
            let _ = writeln!(
                body,
                "<g transform=\"translate({x:.1} {:.1})\">{}<text x=\"{SWATCH}\" y=\"10\">{}</text></g>",
                below - 10.0,
                swatch(entry),
                html(&entry.name)
            );
            x += wide;
        }
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width} {height:.0}\" role=\"img\">\n<title>{title}</title>\n<desc>{}</desc>\n\
             <style>\n{}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n\
             <text x=\"{MARGIN}\" y=\"25\" font-weight=\"600\">{title}</text>\n{body}</svg>\n",
            html(&self.caption),
            file_rules(),
            title = html(&self.title),
            height = below + MARGIN,
        )
    }
}

/// What stands before a name of a legend, 28 wide and 10 high.
pub fn swatch(entry: &Entry) -> String {
    let look = entry.look;
    let colour = look.colour.name();
    if look.area {
        return format!("<path class=\"b {colour}\" d=\"M1 1h26v10h-26z\"/>");
    }
    match look.symbol {
        None => format!("<path class=\"{}\" d=\"M1 6h26\"/>", look.classes()),
        Some(symbol) => {
            let shape = Symbol::shape(symbol).1;
            format!("<path class=\"{} {colour}\" d=\"M14 6{shape}\"/>", symbol.class())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::figure::{Axis, Panel};
    use super::super::look::Look;
    use super::*;

    #[test]
    fn a_file_is_well_formed_self_contained_and_leaves_hidden_curves_out() {
        let mut figure = Figure::new("f", "A < B & \"C\"");
        figure.caption = "says <nothing>".into();
        for (k, shown) in [true, false, true].into_iter().enumerate() {
            let entry = figure.entry(
                format!("curve {k} with a rather long name, so that the legend wraps"),
                Look::of_series(k),
                shown,
            );
            let mut panel = Panel::new(Axis::new("x"), Axis::new("y"));
            panel.line(entry, vec![[0.0, 0.0], [1.0, f64::from(u8::from(shown))]]);
            figure.panels.push(panel);
        }
        let svg = figure.to_svg();
        assert!(!svg.contains("var(") && !svg.contains("href") && !svg.contains("url("));
        assert!(svg.contains("curve 0") && !svg.contains("curve 1"));
        // Every element that is opened is closed.
        let opened = svg.matches("<svg").count() + svg.matches("<g").count() + svg.matches("<text").count();
        let closed = svg.matches("</svg>").count() + svg.matches("</g>").count() + svg.matches("</text>").count();
        assert_eq!(opened, closed);
        assert!(svg.contains("A &lt; B &amp; &quot;C&quot;") && svg.starts_with("<svg xmlns="));
    }
}
