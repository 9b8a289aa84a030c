//! Colours, dashes and symbols, and the style sheet they make.

/// A colour by what it stands for. After Okabe and Ito (2008), which stay apart for the colour-blind; the light ones
/// darkened to 3:1 on white (WCAG 2.2, 1.4.11) and yellow left out, and lightened for a dark page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// The measured record.
    Test,
    /// The record before filtering.
    Raw,
    /// Marks of events.
    Event,
    /// What stays in the background.
    Muted,
    /// Curves of one kind, told apart by their number.
    Series(usize),
}

/// A line's pattern, so that curves differ without colour too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dash {
    /// A full line.
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
    /// Dashes and dots in turn.
    DashDot,
}

/// How thick a line is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Width {
    /// Of a record before filtering.
    Thin,
    /// Of most curves.
    Medium,
    /// Of the test below models.
    Thick,
}

/// A mark of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symbol {
    /// A filled circle.
    Disc,
    /// A hollow circle.
    Ring,
    /// A diagonal cross.
    Cross,
    /// An upright cross.
    Plus,
    /// Both crosses.
    Star,
    /// A filled diamond.
    Diamond,
    /// A hollow square.
    Square,
    /// A hollow triangle.
    Triangle,
    /// A faint dot of a cloud of many: the shortest to write.
    Point,
}

/// How an entry of a legend is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Its colour.
    pub colour: Colour,
    /// The pattern of its lines.
    pub dash: Dash,
    /// How thick they are.
    pub width: Width,
    /// The mark of its points; `None`: it is lines alone.
    pub symbol: Option<Symbol>,
    /// Whether it is an area alone.
    pub area: bool,
}

/// Colours of one kind of curve before they repeat.
pub const SERIES: usize = 6;
const DASHES: [Dash; 4] = [Dash::Solid, Dash::Dashed, Dash::Dotted, Dash::DashDot];

/// Name, on white, on the dark page.
const PALETTE: [(&str, &str, &str); 14] = [
    ("s0", "#0072b2", "#4db1e8"),
    ("s1", "#d55e00", "#ff8a3d"),
    ("s2", "#00805f", "#2ec99a"),
    ("s3", "#b0558a", "#e792c4"),
    ("s4", "#9a6700", "#e0b040"),
    ("s5", "#2f6fb4", "#9cc4f5"),
    ("test", "#1b2733", "#e8edf2"),
    ("raw", "#7c8894", "#8b98a5"),
    ("event", "#b0126d", "#ff7ac6"),
    ("muted", "#55616d", "#a9b4bf"),
    ("text", "#1b2733", "#e8edf2"),
    ("grid", "#e3e7eb", "#2c353e"),
    ("window", "#edf3f8", "#1d2935"),
    ("paper", "#ffffff", "#14191f"),
];

impl Colour {
    /// Its name in style sheets.
    pub fn name(self) -> &'static str {
        match self {
            Self::Test => "test",
            Self::Raw => "raw",
            Self::Event => "event",
            Self::Muted => "muted",
            Self::Series(k) => PALETTE[k % SERIES].0,
        }
    }
}

impl Look {
    /// A line of medium width.
    pub fn line(colour: Colour, dash: Dash) -> Self {
        Self { colour, dash, width: Width::Medium, symbol: None, area: false }
    }

    /// The `k`-th of curves of one kind: colours in turn, then with another dash.
    pub fn of_series(k: usize) -> Self {
        Self::line(Colour::Series(k), DASHES[(k + k / SERIES) % DASHES.len()])
    }

    /// Points alone.
    pub fn marks(colour: Colour, symbol: Symbol) -> Self {
        Self { symbol: Some(symbol), ..Self::line(colour, Dash::Solid) }
    }

    /// A filled area.
    pub fn area(colour: Colour) -> Self {
        Self { area: true, ..Self::line(colour, Dash::Solid) }
    }

    /// With another width.
    #[must_use]
    pub fn width(self, width: Width) -> Self {
        Self { width, ..self }
    }

    /// Classes of a line.
    pub fn classes(self) -> String {
        let dash = match self.dash {
            Dash::Solid => "",
            Dash::Dashed => " d1",
            Dash::Dotted => " d2",
            Dash::DashDot => " d3",
        };
        let width = match self.width {
            Width::Thin => " w1",
            Width::Medium => "",
            Width::Thick => " w3",
        };
        format!("l {}{dash}{width}", self.colour.name())
    }
}

impl Symbol {
    /// Class of its paths beside the colour: filled, lines, or the round ends of lines without length.
    pub fn class(self) -> &'static str {
        match (self, self.shape().0) {
            (Self::Point, _) => "l pt",
            (_, true) => "f",
            _ => "l",
        }
    }

    /// Whether it is filled, and its outline about a point as the rest of a path's `d` after a move to it.
    pub fn shape(self) -> (bool, &'static str) {
        match self {
            Self::Disc => (true, "m-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0"),
            Self::Ring => (false, "m-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0"),
            Self::Cross => (false, "m-4-4l8 8m0-8l-8 8"),
            Self::Plus => (false, "m-5 0h10m-5-5v10"),
            Self::Star => (false, "m-5 0h10m-5-5v10m-3.5-8.5l7 7m0-7l-7 7"),
            Self::Diamond => (true, "m0-5l5 5l-5 5l-5-5z"),
            Self::Square => (false, "m-4-4h8v8h-8z"),
            Self::Triangle => (false, "m0-5l5 9h-10z"),
            Self::Point => (false, "h0"),
        }
    }
}

/// The palette as custom properties: of a page, which follows the reader's scheme and is light on paper.
pub fn palette() -> String {
    let set = |of: fn(&(&str, &str, &'static str)) -> String| PALETTE.iter().map(of).collect::<String>();
    let light = set(|(name, light, _)| format!("--{name}:{light};"));
    let dark = set(|(name, _, dark)| format!("--{name}:{dark};"));
    format!(
        ":root{{color-scheme:light dark;{light}}}\n\
         @media screen and (prefers-color-scheme:dark){{:root{{{dark}}}}}\n"
    )
}

/// Rules for everything that a panel draws. `value` writes a colour of the palette.
fn rules(value: impl Fn(&str) -> String) -> String {
    let mut css = String::from(
        "svg text{font-family:system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif;\
         font-size:13px;font-variant-numeric:tabular-nums}\n\
         .l{fill:none;stroke-width:2;stroke-linejoin:round;vector-effect:non-scaling-stroke}\
         .w1{stroke-width:1}.w3{stroke-width:3.2}\
         .d1{stroke-dasharray:8 4}.d2{stroke-dasharray:2 3}.d3{stroke-dasharray:9 3 2 3}\
         .b{stroke:none;fill-opacity:.2}.g{stroke-width:1;fill:none;vector-effect:non-scaling-stroke}\
         text.n{font-weight:600}\
         .pt{stroke-width:5;stroke-linecap:round;stroke-opacity:.55}.link{stroke-width:2}\n",
    );
    for (name, _, _) in &PALETTE[..10] {
        let colour = value(name);
        css.push_str(&format!(".l.{name}{{stroke:{colour}}}.f.{name},.b.{name},.n.{name}{{fill:{colour}}}"));
    }
    css.push_str(&format!(
        "\nsvg text{{fill:{}}}svg .t{{fill:{}}}.g{{stroke:{}}}.frame{{fill:none;stroke:{}}}.window{{fill:{}}}\
         .halo{{paint-order:stroke;stroke:{};stroke-width:4}}.dot{{fill:{};stroke:{};stroke-width:1.5}}\
         .link{{fill:{};stroke:{}}}\n",
        value("text"),
        value("muted"),
        value("grid"),
        value("raw"),
        value("window"),
        value("paper"),
        value("event"),
        value("paper"),
        value("paper"),
        value("s1"),
    ));
    css
}

/// The style sheet of figures on a page that holds [`palette`].
pub fn page_rules() -> String {
    rules(|name| format!("var(--{name})"))
}

/// The style sheet of a figure in a file of its own: on white, with colours that every viewer reads.
pub fn file_rules() -> String {
    rules(|name| PALETTE.iter().find(|(other, ..)| *other == name).map_or_else(String::new, |p| p.1.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contrast as WCAG 2.2 defines it.
    fn contrast(a: &str, b: &str) -> f64 {
        let luminance = |hex: &str| {
            let channel = |at: usize| {
                let c = f64::from(u8::from_str_radix(&hex[at..at + 2], 16).unwrap()) / 255.0;
                if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
            };
            0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5) + 0.05
        };
        let (a, b) = (luminance(a), luminance(b));
        a.max(b) / a.min(b)
    }

    #[test]
    fn curves_and_texts_stand_out_on_both_papers_and_in_the_shaded_window() {
        let colour = |name: &str| PALETTE.iter().find(|p| p.0 == name).unwrap();
        for &(name, light, dark) in &PALETTE[..11] {
            // Text of its own colour: 4.5:1 (1.4.3). Lines: 3:1 (1.4.11).
            let least = if ["event", "muted", "text", "test"].contains(&name) { 4.5 } else { 3.0 };
            for back in ["paper", "window"] {
                let (on_light, on_dark) = (contrast(light, colour(back).1), contrast(dark, colour(back).2));
                assert!(on_light >= least && on_dark >= least, "{name} on {back}: {on_light:.2}, {on_dark:.2}");
            }
        }
    }

    #[test]
    fn the_first_two_dozen_curves_differ_in_colour_or_dash_and_neighbours_in_dash() {
        let looks: Vec<Look> = (0..24).map(Look::of_series).collect();
        for (k, look) in looks.iter().enumerate() {
            let twin = looks[..k].iter().find(|o| o.colour.name() == look.colour.name() && o.dash == look.dash);
            assert!(twin.is_none(), "{k}");
            assert!(k == 0 || looks[k - 1].dash != look.dash, "{k}");
        }
    }
}
