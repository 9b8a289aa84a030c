//! Where the parts of a drawing stand: texts never meet each other or a line.
//!
//! The barrier is at the right. Between two neighbours every element has a lane of its own, its words above it; an
//! element that passes a mass has a lane below that mass. Words are broken to the width of their lane. With three
//! masses or more the lanes are too narrow for words: there they stand in rows under the drawing.

use super::parts::Parts;

/// Width of a drawing: a phone's, so that its text is read there at its own size.
pub const WIDTH: f64 = 350.0;
/// Height of a line of text.
pub const LINE: f64 = 13.5;
/// Width of a character at most, on average over a line: of the widest of the fonts the page asks for, bold.
const CHARACTER: f64 = 7.0;
const BARRIER: f64 = WIDTH - 14.0;
const TOP: f64 = 8.0;
const GLYPH: f64 = 26.0;
const CURVE: f64 = 40.0;
const BETWEEN: f64 = 8.0;

/// A rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Box {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

/// A line of text about the middle of a place, or from its left.
#[derive(Debug, Clone, PartialEq)]
pub struct Words {
    /// The text.
    pub text: String,
    /// What it takes.
    pub place: Box,
    /// Whether it is the first of its part.
    pub first: bool,
    /// Whether it is centred.
    pub centred: bool,
}

/// An element's line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lane {
    /// Left end, at the rear mass.
    pub from: f64,
    /// Right end.
    pub to: f64,
    /// Height of its middle.
    pub y: f64,
}

/// Everything in its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Masses, in the order of the parts.
    pub masses: Vec<Box>,
    /// Elements, in the order of the parts.
    pub lanes: Vec<Lane>,
    /// All words.
    pub words: Vec<Words>,
    /// Left edge of the barrier.
    pub barrier: f64,
    /// Height of the ground.
    pub ground: f64,
    /// Height of all.
    pub height: f64,
}

/// Puts the parts in their places.
pub fn layout(parts: &Parts) -> Layout {
    let count = parts.masses.len().max(1);
    let crowded = count > 2;
    let mass_width = [110.0, 58.0].get(count - 1).copied().unwrap_or(44.0);
    let gap = (BARRIER - 2.0 - mass_width * count as f64) / count as f64;
    let left_of = |mass: usize| BARRIER - (gap + mass_width) * (mass + 1) as f64;
    let mut words = Vec::new();
    let mut lanes = vec![Lane { from: 0.0, to: 0.0, y: 0.0 }; parts.elements.len()];

    // Lanes between neighbours, then those that pass a mass.
    let mut bottoms = vec![TOP; count];
    let between_neighbours = |at: usize| {
        let element = &parts.elements[at];
        element.rear.is_some_and(|rear| element.front.map_or(0, |front| front + 1) == rear)
    };
    let (near, far): (Vec<usize>, Vec<usize>) = (0..parts.elements.len()).partition(|at| between_neighbours(*at));
    let mut put = |at: usize, from: f64, to: f64, top: f64| -> f64 {
        let element = &parts.elements[at];
        let height = if matches!(element.glyph, super::parts::Glyph::Curve(_)) { CURVE } else { GLYPH };
        let symbol = [element.symbol.clone()];
        let lines: &[String] = if crowded { &symbol } else { &element.lines };
        let lines = broken(lines, to - from - 4.0);
        for (k, (text, first)) in lines.iter().enumerate() {
            let place = Box { x: from + 2.0, y: top + LINE * k as f64, width: to - from - 4.0, height: LINE };
            words.push(Words { text: text.clone(), place, first: *first, centred: true });
        }
        let glyph = top + LINE * lines.len() as f64 + 2.0;
        lanes[at] = Lane { from, to, y: glyph + 0.5 * height };
        glyph + height + BETWEEN
    };
    for at in near {
        let rear = parts.elements[at].rear.unwrap_or_default();
        let from = left_of(rear) + mass_width;
        bottoms[rear] = put(at, from, from + gap, bottoms[rear]);
    }
    let names: Vec<Vec<(String, bool)>> = parts
        .masses
        .iter()
        .map(|mass| broken(if crowded { std::slice::from_ref(&mass.symbol) } else { &mass.lines }, mass_width - 6.0))
        .collect();
    let tallest = names.iter().map(|lines| TOP + LINE * lines.len() as f64 + 20.0).fold(0.0, f64::max);
    let mut bottom = bottoms.iter().copied().fold(tallest.max(TOP + 60.0), f64::max);
    let mut heights = vec![bottom; count];
    for at in far {
        let element = &parts.elements[at];
        let rear = element.rear.unwrap_or(count - 1);
        let to = element.front.map_or(BARRIER, left_of);
        bottom = put(at, left_of(rear) + mass_width, to, bottom + BETWEEN);
        heights[rear] = bottom;
        if let Some(front) = element.front {
            heights[front] = bottom;
        }
    }
    let masses: Vec<Box> =
        (0..count).map(|i| Box { x: left_of(i), y: TOP - 4.0, width: mass_width, height: heights[i] - TOP }).collect();
    for (place, lines) in masses.iter().zip(&names) {
        let top = place.y + 0.5 * (place.height - LINE * lines.len() as f64);
        for (k, (text, first)) in lines.iter().enumerate() {
            let at = Box { x: place.x + 3.0, y: top + LINE * k as f64, width: place.width - 6.0, height: LINE };
            words.push(Words { text: text.clone(), place: at, first: *first, centred: true });
        }
    }
    let ground = bottom + 8.0;
    let mut height = ground + 22.0;
    if crowded {
        // Masses beside each other, a row an element.
        let masses = parts.masses.iter().map(|mass| format!("{} = {}", mass.symbol, mass.lines.join(", ")));
        let of_elements = parts.elements.iter().map(|element| element.lines.join(", "));
        for row in std::iter::once(masses.collect::<Vec<_>>().join("; ")).chain(of_elements) {
            for (text, first) in broken(&[row], WIDTH - 8.0) {
                let place = Box { x: 4.0, y: height, width: WIDTH - 8.0, height: LINE };
                words.push(Words { text, place, first, centred: false });
                height += LINE;
            }
        }
        height += 4.0;
    }
    Layout { masses, lanes, words, barrier: BARRIER, ground, height }
}

/// Lines broken at blanks to a width; whether each is the beginning of the first one.
fn broken(lines: &[String], width: f64) -> Vec<(String, bool)> {
    let room = ((width / CHARACTER) as usize).max(1);
    let mut out: Vec<(String, bool)> = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        let mut current = String::new();
        for word in line.split(' ') {
            if !current.is_empty() && current.chars().count() + 1 + word.chars().count() > room {
                out.push((std::mem::take(&mut current), index == 0));
            }
            if !current.is_empty() {
                current.push(' ');
            }
            current.push_str(word);
        }
        out.push((current, index == 0));
    }
    out
}

impl Words {
    /// What the text itself takes of its place, at most.
    #[cfg(test)]
    pub fn ink(&self) -> Box {
        let width = CHARACTER * self.text.chars().count() as f64;
        let x = if self.centred { self.place.x + 0.5 * (self.place.width - width) } else { self.place.x };
        Box { x, width, ..self.place }
    }
}

#[cfg(test)]
mod tests {
    use super::super::parts::{ElementPart, Glyph, MassPart};
    use super::*;

    fn overlap(a: &Box, b: &Box) -> bool {
        a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height
    }

    /// A row of masses, spring and damper in front of each, with long words; `past`: a curve from the barrier to the
    /// last mass.
    fn row(count: usize, past: bool) -> Parts {
        let words = |symbol: &str| vec![format!("{symbol} 1234.5 kN·s/m ?"), "1021.2 to 12345.6".to_owned()];
        let element = |front: Option<usize>, rear: usize, glyph: Glyph, symbol: String| ElementPart {
            front,
            rear: Some(rear),
            glyph,
            lines: words(&symbol),
            symbol,
            open: false,
        };
        let mass = |i: usize| MassPart {
            symbol: format!("m{i}"),
            lines: vec!["1234.5 kg ?".to_owned(), "1021 to 1234".to_owned()],
            open: true,
        };
        let mut elements: Vec<ElementPart> = (0..count)
            .flat_map(|i| {
                let front = i.checked_sub(1);
                [element(front, i, Glyph::Spring, format!("k{i}")), element(front, i, Glyph::Damper, format!("c{i}"))]
            })
            .collect();
        if past {
            elements.push(element(None, count - 1, Glyph::Curve(vec![(0.0, 0.0), (1.0, 1.0)]), "F∥".to_owned()));
        }
        Parts { masses: (0..count).map(mass).collect(), elements }
    }

    #[test]
    fn words_meet_neither_each_other_nor_a_lane_nor_the_edges() {
        for (count, past) in [(1, false), (2, false), (2, true), (3, false), (4, true)] {
            let parts = row(count, past);
            let layout = layout(&parts);
            let inks: Vec<Box> = layout.words.iter().map(Words::ink).collect();
            for (k, ink) in inks.iter().enumerate() {
                let text = &layout.words[k].text;
                assert!(ink.x >= 0.0 && ink.x + ink.width <= WIDTH, "{count} {text}: {ink:?}");
                assert!(ink.y + ink.height <= layout.height, "{count} {text}");
                let met = inks[..k].iter().position(|other| overlap(ink, other));
                assert_eq!(met.map(|other| &layout.words[other].text), None, "{count} masses, {text}");
                let met = layout.lanes.iter().any(|lane| {
                    overlap(ink, &Box { x: lane.from, y: lane.y - 11.0, width: lane.to - lane.from, height: 22.0 })
                });
                assert!(!met, "{count} masses: {text} on a line");
            }
        }
    }

    #[test]
    fn every_element_reaches_from_its_mass_to_the_one_in_front() {
        let parts = row(2, true);
        let layout = layout(&parts);
        for (element, lane) in parts.elements.iter().zip(&layout.lanes) {
            let rear = layout.masses[element.rear.unwrap()];
            assert_eq!(lane.from, rear.x + rear.width);
            assert_eq!(lane.to, element.front.map_or(layout.barrier, |front| layout.masses[front].x));
            assert!(rear.y <= lane.y && lane.y <= rear.y + rear.height, "the mass is as high as its lanes");
        }
    }
}
