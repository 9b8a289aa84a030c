//! The drawing as SVG, to be read by people and screen readers alike. Colours are those of the page.

use std::fmt::Write;

use crate::drawing::escape::html;

use super::layout::{LINE, Lane, Layout, WIDTH};
use super::motion::Motion;
use super::parts::{ElementPart, Glyph, Parts};

/// The picture of a model. `number` makes its ids those of one picture of the page; `motion` is for the page's cursor.
pub fn drawing(
    number: usize,
    name: &str,
    parts: &Parts,
    layout: &Layout,
    motion: Option<&Motion>,
    speed: Option<&str>,
) -> String {
    let until = motion.map_or_else(String::new, |motion| format!(" data-until=\"{:.1}\"", motion.until_ms));
    let mut out = format!(
        "<svg class=\"model-picture\"{until} viewBox=\"0 0 {WIDTH} {:.0}\" role=\"img\" \
         aria-labelledby=\"model-{number}-name model-{number}-words\">\n\
         <title id=\"model-{number}-name\">{}</title>\n<desc id=\"model-{number}-words\">{}\
         </desc>\n",
        layout.height,
        html(name),
        html(&in_words(parts))
    );
    frame(&mut out, layout, speed);
    for (element, lane) in parts.elements.iter().zip(&layout.lanes) {
        draw_element(&mut out, element, lane);
    }
    for (k, (mass, place)) in parts.masses.iter().zip(&layout.masses).enumerate() {
        let places = motion.map_or_else(String::new, |motion| {
            let places: Vec<String> = motion.places[k].iter().map(|x| format!("{x:.0}")).collect();
            format!(" data-places=\"{}\"", places.join(" "))
        });
        let _ = writeln!(
            out,
            "<rect class=\"mass{}\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"5\"{places}/>",
            if mass.open { " open" } else { "" },
            place.x,
            place.y,
            place.width,
            place.height
        );
    }
    for words in &layout.words {
        let (x, anchor) = if words.centred {
            (words.place.x + 0.5 * words.place.width, " text-anchor=\"middle\"")
        } else {
            (words.place.x, "")
        };
        let _ = writeln!(
            out,
            "<text class=\"{}\" x=\"{x:.1}\" y=\"{:.1}\"{anchor}>{}</text>",
            if words.first { "value" } else { "interval" },
            words.place.y + 0.78 * LINE,
            html(&words.text)
        );
    }
    out.push_str("</svg>\n");
    out
}

/// What the drawing shows, in a sentence a part.
fn in_words(parts: &Parts) -> String {
    let node = |node: Option<usize>| match node {
        None => "the barrier".to_owned(),
        Some(i) if parts.masses.len() == 1 => parts.masses[i].symbol.replace('m', "the mass"),
        Some(i) => format!("mass {}", i + 1),
    };
    let masses = parts.masses.iter().map(|mass| format!("Mass {}: {}.", mass.symbol, mass.lines.join(", ")));
    let elements = parts.elements.iter().map(|element| {
        let kind = match element.glyph {
            Glyph::Spring => "Spring",
            Glyph::Damper => "Damper",
            Glyph::SpringAndDamper => "Spring and damper in series",
            Glyph::Curve(_) => "Force-deflection curve",
        };
        let (front, rear) = (node(element.front), node(element.rear));
        format!("{kind} between {front} and {rear}: {}.", element.lines.join(", "))
    });
    masses.chain(elements).collect::<Vec<_>>().join(" ")
}

/// Ground, barrier and the arrow of the impact speed.
fn frame(out: &mut String, layout: &Layout, speed: Option<&str>) {
    let (barrier, ground) = (layout.barrier, layout.ground);
    let _ = writeln!(
        out,
        "<path class=\"ground\" d=\"M2 {ground:.1}H{barrier:.1}\"/>\n\
         <rect class=\"barrier\" x=\"{barrier:.1}\" y=\"2\" width=\"8\" height=\"{:.1}\"/>",
        ground + 4.0
    );
    if let Some(speed) = speed {
        let _ = writeln!(
            out,
            "<text class=\"interval\" x=\"4\" y=\"{:.1}\">{} →</text>\n\
             <text class=\"interval\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">barrier</text>",
            ground + 15.0,
            html(speed),
            barrier + 8.0,
            ground + 17.0
        );
    }
}

fn draw_element(out: &mut String, element: &ElementPart, lane: &Lane) {
    let path = match &element.glyph {
        Glyph::Spring => spring(lane.from, lane.to, lane.y),
        Glyph::Damper => damper(lane.from, lane.to, lane.y),
        Glyph::SpringAndDamper => {
            let middle = 0.5 * (lane.from + lane.to);
            spring(lane.from, middle, lane.y) + &damper(middle, lane.to, lane.y)
        }
        Glyph::Curve(points) => curve(points, lane),
    };
    let kind = match element.glyph {
        Glyph::Spring | Glyph::SpringAndDamper => "spring",
        Glyph::Damper => "damper",
        Glyph::Curve(_) => "curve",
    };
    let open = if element.open { " open" } else { "" };
    let _ = writeln!(out, "<path class=\"{kind}{open}\" d=\"{path}\"/>");
}

/// A zigzag between two straight ends.
fn spring(from: f64, to: f64, y: f64) -> String {
    const TEETH: u32 = 8;
    let end = (0.12 * (to - from)).min(16.0);
    let (start, step) = (from + end, (to - from - 2.0 * end) / f64::from(TEETH));
    let mut path = format!("M{from:.1} {y:.1}H{start:.1}");
    for k in 0..TEETH {
        let side = if k % 2 == 0 { -9.0 } else { 9.0 };
        let _ = write!(path, "L{:.1} {:.1}", start + step * (f64::from(k) + 0.5), y + side);
    }
    let _ = write!(path, "L{:.1} {y:.1}H{to:.1}", to - end);
    path
}

/// A rod with a piston in an open cylinder.
fn damper(from: f64, to: f64, y: f64) -> String {
    let middle = 0.5 * (from + to);
    let (back, mouth) = (middle + 14.0, middle - 14.0);
    let (top, bottom) = (y - 10.0, y + 10.0);
    format!(
        "M{from:.1} {y:.1}H{middle:.1}M{middle:.1} {:.1}V{:.1}M{mouth:.1} {top:.1}H{back:.1}V{bottom:.1}H{mouth:.1}\
         M{back:.1} {y:.1}H{to:.1}",
        y - 7.0,
        y + 7.0
    )
}

/// The small curve in its box, with a line to either side.
fn curve(points: &[(f64, f64)], lane: &Lane) -> String {
    let width = (0.6 * (lane.to - lane.from)).min(90.0);
    let (left, half) = (0.5 * (lane.from + lane.to - width), 18.0);
    let (top, bottom, right) = (lane.y - half, lane.y + half, left + width);
    let mut path = format!(
        "M{:.1} {y:.1}H{left:.1}M{right:.1} {y:.1}H{:.1}M{left:.1} {top:.1}H{right:.1}V{bottom:.1}H{left:.1}Z",
        lane.from,
        lane.to,
        y = lane.y
    );
    for (k, (x, y)) in points.iter().enumerate() {
        let command = if k == 0 { 'M' } else { 'L' };
        let _ =
            write!(path, "{command}{:.1} {:.1}", left + 4.0 + x * (width - 8.0), bottom - 3.0 - y * (2.0 * half - 6.0));
    }
    path
}
