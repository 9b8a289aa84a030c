//! Figures of a run as files of their own: SVG, and PNG by the fonts of the system.

use std::fs;
use std::io::Write;
use std::path::Path;

use crate::drawing::Figure;
use anyhow::{Context, anyhow};
use crumple_artifact::{OutputKind, write_atomically};
use crumple_stage::Usage;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::{Database, Family, Query};
use resvg::usvg::{Options, Tree};

/// Pixels of a PNG for each unit of the drawing: a figure of two panels is 2,300 pixels wide, 20 cm at 300 dpi.
const SCALE: f32 = 2.0;
/// Families that a system without an alias for sans-serif is likely to have, the first before the others.
const SANS_SERIF: [&str; 5] = ["DejaVu Sans", "Liberation Sans", "Noto Sans", "Arial", "Helvetica"];

/// Fonts for the text of a PNG.
pub struct Fonts(Options<'static>);

impl Fonts {
    /// Those of this computer.
    pub fn of_system() -> Result<Self, Usage> {
        let mut fonts = Database::new();
        fonts.load_system_fonts();
        Self::new(fonts)
    }

    /// Refuses a computer without any: pictures without text mislead.
    fn new(mut fonts: Database) -> Result<Self, Usage> {
        let Some(any) = fonts.faces().find_map(|face| Some(face.families.first()?.0.clone())) else {
            return Err(Usage::new("no font is installed on this computer, and the text of a PNG needs one")
                .hint("install one, for example the package fonts-dejavu-core, or write vector graphics with --svg"));
        };
        let has = |fonts: &Database, family| fonts.query(&Query { families: &[family], ..Query::default() }).is_some();
        if !has(&fonts, Family::SansSerif) {
            let known = SANS_SERIF.into_iter().find(|name| has(&fonts, Family::Name(name)));
            fonts.set_sans_serif_family(known.map_or(any, str::to_owned));
        }
        Ok(Self(Options { fontdb: fonts.into(), ..Options::default() }))
    }

    /// A figure as PNG, on white. Its bytes depend on the fonts; those of the SVG do not.
    pub fn png(&self, figure: &Figure) -> anyhow::Result<Vec<u8>> {
        let tree = Tree::from_str(&figure.to_svg(), &self.0)?;
        let [width, height] =
            [tree.size().width(), tree.size().height()].map(|units| (SCALE * units).ceil().max(1.0) as u32);
        let mut pixels =
            Pixmap::new(width, height).ok_or_else(|| anyhow!("{width} by {height} pixels are too many"))?;
        resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
        Ok(pixels.encode_png()?)
    }
}

/// Each figure as `<id>.<ending>`, its bytes made by `picture`.
pub fn write_figures(
    folder: &Path,
    ending: &str,
    figures: &[Figure],
    picture: impl Fn(&Figure) -> anyhow::Result<Vec<u8>>,
) -> anyhow::Result<()> {
    let write = || -> anyhow::Result<()> {
        fs::create_dir_all(folder)?;
        for figure in figures {
            let bytes = picture(figure).with_context(|| format!("figure {}", figure.id))?;
            write_atomically(&folder.join(figure.id).with_extension(ending), OutputKind::Figure, |file| {
                Ok::<_, anyhow::Error>(file.write_all(&bytes)?)
            })?;
        }
        Ok(())
    };
    write().with_context(|| format!("cannot write the figures into {}", folder.display()))
}

#[cfg(test)]
mod tests {
    use crate::drawing::{Axis, Colour, Dash, Look, Panel};

    use super::*;

    fn figure(title: &str) -> Figure {
        let mut figure = Figure::new("f", title);
        let entry = figure.entry("test", Look::line(Colour::Test, Dash::Solid), true);
        let mut panel = Panel::new(Axis::new("time, ms"), Axis::new("force, kN"));
        panel.line(entry, vec![[0.0, 0.0], [50.0, 30.0], [80.0, 10.0]]);
        figure.panels.push(panel);
        figure
    }

    /// Pixels of the title that are not white.
    fn inked(pixels: &Pixmap) -> usize {
        let title = (0..70).flat_map(|y| (0..800).map(move |x| (x, y)));
        title.filter(|(x, y)| pixels.pixel(*x, *y).is_some_and(|pixel| pixel.red() < 128)).count()
    }

    #[test]
    fn a_picture_has_curves_and_text() {
        let Ok(fonts) = Fonts::of_system() else {
            eprintln!("SKIPPED: no font is installed");
            return;
        };
        let [with, without] =
            ["Force <of> the wall", ""].map(|title| Pixmap::decode_png(&fonts.png(&figure(title)).unwrap()).unwrap());
        assert_eq!(with.width(), 2 * (560 + 32));
        assert!(inked(&with) > 300 && inked(&without) == 0, "{} {}", inked(&with), inked(&without));
        // The curve: near black, below the title.
        let dark = with.pixels().iter().filter(|pixel| pixel.red() < 60 && pixel.alpha() == 255).count();
        assert!(dark > inked(&with) + 1_000, "{dark}");
    }

    #[test]
    fn a_computer_without_fonts_is_told_what_to_do() {
        let error = Fonts::new(Database::new()).err().unwrap();
        assert!(error.to_string().contains("no font is installed"), "{error}");
    }
}
