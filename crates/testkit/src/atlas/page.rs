//! The page of the atlas, `docs/atlas.md`.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crumple_stage::wrapped;

use crate::PAGE_COLUMNS;
use crate::atlas::readings::READINGS;
use crate::atlas::{Atlas, Figure, Found, Pulse};

const FT_M: f64 = 0.3048;
/// A demand of a regulation that its own corners miss by more is shown.
const SHORT: f64 = 0.02;

const HEAD: &str = "\
# Atlas: what others have measured

<!-- Written by `just atlas`; do not edit. -->

What tests, standards and papers have published, beside what Crumple gives of the same thing. `just atlas` runs every
row by the programs: a real car (NHTSA 10146, a Camry at 57 km/h), a real small overlap, made cars, a recorder's table,
pulses typed in from regulations. It needs the reference records (`CRUMPLE_SHARED`).

One car hits if it lies among the cars, a median if it lies in the interval of the median, an interval if it holds the
figure; where that does not fit, *counts* says what does. Letters are notes below the tables, numbers in brackets are
[sources](#sources). *Seen* says how the figure was read: in the text of its source, in the abstract, quoted by another
work, computed from published data, or from memory. A figure from memory tests arithmetic and says nothing about a
standard.
";

/// Why a row misses, or what is to be known of it.
pub(crate) fn reason(found: &Found) -> &'static str {
    let reading = READINGS.iter().find(|reading| reading.figure == found.figure && reading.of == found.of);
    reading.map(|reading| reading.why).or_else(|| pulse_reason(found)).unwrap_or_default()
}

fn pulse_reason(found: &Found) -> Option<&'static str> {
    let is_shock = found.figure.starts_with("mil-sawtooth");
    (is_shock && found.of == "delta-v").then_some(
        "CFC 60 overshoots after a shock of a few ms, and the dip counts as rebound; one sample at the tip adds",
    )
}

/// The page in Markdown.
pub fn page(atlas: &Atlas, found: &[Found]) -> String {
    let hits = found.iter().filter(|one| one.hit).count();
    let mut page = format!("{HEAD}\n{} rows run: {hits} hits, {} misses.\n", found.len(), found.len() - hits);
    let (sources, mut notes) = (sources(atlas, found), Notes::default());
    page +=
        "\n## Tests\n\n| published | value | counts | seen | of | Crumple | | |\n|---|---|---|---|---|---|---|---|\n";
    let mut before = "";
    for one in found {
        let Some(figure) = atlas.figure(&one.figure) else { continue };
        let tests = figure.n.map_or_else(String::new, |n| format!(", N {n}"));
        let published = match figure.id == before {
            // Said in the row above.
            true => "| | | |".to_owned(),
            false => format!(
                "{} | {} | {} | {}{tests} {} |",
                figure.quantity,
                figure.published(),
                figure.counts(),
                figure.certainty,
                place(&sources, &figure.source)
            ),
        };
        let letters = notes.letters([figure.accepted_by.as_deref().unwrap_or_default(), reason(one)]);
        let _infallible =
            writeln!(page, "| {published} {} | {} | {} | {letters} |", one.of, figure.given(one), mark(one.hit));
        before = &figure.id;
    }
    page += &notes.list();
    page += &pulses(atlas, found, &sources);
    page += &wrong(atlas);
    page += "\n## Figures that nothing at hand can be compared with\n\n";
    for figure in &atlas.figures {
        if let Some(why) = &figure.not_run {
            let published = figure.published();
            let published = if published == "-" { String::new() } else { format!(" {published}") };
            page += &item("-", &format!("{}{published} {}: {why}.", figure.quantity, place(&sources, &figure.source)));
        }
    }
    page += "\n## Sources\n\n";
    for (number, source) in (1..).zip(&sources) {
        let _infallible = writeln!(page, "{number}. {source}");
    }
    page
}

/// An item of a list, wrapped.
fn item(mark: &str, text: &str) -> String {
    let indent = " ".repeat(mark.len() + 1);
    format!("{mark} {}\n", wrapped(text, PAGE_COLUMNS - indent.len()).join(&format!("\n{indent}")))
}

/// Sentences that a table refers to by letters, each once.
#[derive(Debug, Default)]
struct Notes<'a>(Vec<&'a str>);

impl<'a> Notes<'a> {
    /// The letters of these sentences; nothing of empty ones.
    fn letters(&mut self, texts: [&'a str; 2]) -> String {
        let letter = |text: &'a str| {
            let known = self.0.iter().position(|own| *own == text);
            let place = known.unwrap_or_else(|| {
                self.0.push(text);
                self.0.len() - 1
            });
            letter(place)
        };
        texts.into_iter().filter(|text| !text.is_empty()).map(letter).collect::<Vec<_>>().join(", ")
    }

    /// The sentences by their letters.
    fn list(&self) -> String {
        let all = self.0.iter().enumerate();
        let items: String = all.map(|(place, text)| item("-", &format!("{}: {text}", letter(place)))).collect();
        format!("\n{items}")
    }
}

/// `a` to `z`, then `aa`.
fn letter(place: usize) -> String {
    let last = char::from(b'a' + (place % 26) as u8);
    if place < 26 { last.to_string() } else { letter(place / 26 - 1) + &last.to_string() }
}

fn mark(hit: bool) -> &'static str {
    if hit { "hit" } else { "**miss**" }
}

/// Sources in the order of the page: of the rows that run, of pulses, of what is not run.
fn sources<'a>(atlas: &'a Atlas, found: &[Found]) -> Vec<&'a str> {
    let mut seen = BTreeSet::new();
    let of_found = found.iter().filter_map(|one| Some(atlas.figure(&one.figure)?.source.as_str()));
    let of_pulses = atlas.pulses.iter().map(|pulse| pulse.source.as_str());
    let not_run = atlas.figures.iter().filter(|figure| figure.not_run.is_some()).map(|figure| figure.source.as_str());
    of_found.chain(of_pulses).chain(not_run).filter(|source| seen.insert(*source)).collect()
}

/// The number of a source, as the page has it.
fn place(sources: &[&str], source: &str) -> String {
    let place = sources.iter().position(|own| *own == source).unwrap_or_default() + 1;
    format!("[{place}]")
}

/// Three digits, or what a whole number has.
fn digits(value: f64) -> String {
    let decimals = match value.abs() {
        v if v >= 99.95 || v == 0.0 => 0,
        v if v >= 9.995 => 1,
        v if v >= 0.9995 => 2,
        _ => 3,
    };
    format!("{value:.decimals$}").replace('-', "−")
}

impl Figure {
    /// Factor and name of the unit that people read.
    fn shown(&self) -> (f64, &str) {
        match self.unit.as_str() {
            "m" => (1e3, " mm"),
            "" | "1" => (1.0, ""),
            "%" => (1.0, " %"),
            "g" => (1.0, " g"),
            "km/h" => (1.0, " km/h"),
            "m/s" => (1.0, " m/s"),
            "N/mm" => (1.0, " N/mm"),
            "N/m" => (1e-3, " kN/m"),
            "cm" => (1.0, " cm"),
            unit => (1.0, unit),
        }
    }

    /// The figure and its spread.
    fn published(&self) -> String {
        let (factor, unit) = self.shown();
        let digits = |value: f64| digits(factor * value);
        let range = match (self.low, self.high) {
            (Some(low), Some(high)) => Some(format!("{} to {}", digits(low), digits(high))),
            (Some(low), None) => Some(format!("from {}", digits(low))),
            (None, Some(high)) => Some(format!("up to {}", digits(high))),
            (None, None) => None,
        };
        let spread = self.spread.as_ref().map_or_else(String::new, |spread| format!(", {spread}"));
        match (self.value, range) {
            (Some(value), Some(range)) => format!("{}{unit} ({range}{spread})", digits(value)),
            (Some(value), None) if self.spread.is_some() => format!("{}{unit} ({})", digits(value), &spread[2..]),
            (Some(value), None) => format!("{}{unit}", digits(value)),
            (None, Some(range)) => format!("{range}{unit}{spread}"),
            (None, None) => "-".to_owned(),
        }
    }

    /// What counts as a hit, where the spread does not say it.
    fn counts(&self) -> String {
        let digits = |value: f64| digits(self.shown().0 * value);
        match self.accept {
            Some([Some(low), Some(high)]) => format!("{} to {}", digits(low), digits(high)),
            Some([Some(low), None]) => format!("from {}", digits(low)),
            Some([None, Some(high)]) => format!("up to {}", digits(high)),
            Some([None, None]) | None => String::new(),
        }
    }

    /// What the programs give, in the same unit.
    fn given(&self, found: &Found) -> String {
        let (factor, unit) = self.shown();
        let interval = found.interval.map_or_else(String::new, |[low, high]| {
            format!(" ({} to {})", digits(factor * low), digits(factor * high))
        });
        format!("{}{unit}{interval}", digits(factor * found.value))
    }
}

const PULSES: &str = "
## Pulses of regulations

Corners as a table at 10 kHz with their own change of velocity as impact speed, through `ingest`, `filter` (CFC 60) and
`integrate`. Left of the arrow stands what numpy gives of the same corners, once. ✓: the same to three digits. A tip of
16.0 g reads 15.84 g behind CFC 60: a limit of \"at least 16 g\" must name the class.

| pulse | corners seen in | delta-v, m/s | peak, g | stroke, mm | OLC, g | |
|---|---|---|---|---|---|---|
";

fn pulses(atlas: &Atlas, found: &[Found], sources: &[&str]) -> String {
    let (mut table, mut notes) = (PULSES.to_owned(), Notes::default());
    for pulse in &atlas.pulses {
        let cell = |of: &str, expected: Option<f64>, factor: f64| {
            let one = found.iter().find(|one| one.figure == pulse.id && one.of == of);
            match one.zip(expected) {
                Some((one, expected)) if one.hit => format!("{} ✓", digits(factor * expected)),
                Some((one, expected)) => {
                    format!("{} → {} **miss**", digits(factor * expected), digits(factor * one.value))
                }
                None => String::new(),
            }
        };
        let expected = pulse.expected;
        let why = found.iter().find(|one| one.figure == pulse.id && !one.hit).map(reason).unwrap_or_default();
        let letters = notes.letters(["", why]);
        let _infallible = writeln!(
            table,
            "| `{}`{} | {} {} | {} | {} | {} | {} | {letters} |",
            pulse.id,
            if pulse.conditions.is_empty() { String::new() } else { format!(", {}", pulse.conditions) },
            pulse.certainty,
            place(sources, &pulse.source),
            cell("delta-v", Some(expected.delta_v_m_per_s), 1.0),
            cell("peak", Some(expected.peak_g), 1.0),
            cell("stroke", expected.stroke_m, 1e3),
            cell("OLC", expected.olc_g, 1.0)
        );
    }
    table + &notes.list()
}

/// Figures that contradict what stands beside them in their own source.
fn wrong(atlas: &Atlas) -> String {
    let mut text = "\n## Figures that are wrong in their source\n\n".to_owned();
    for Pulse { id, source, demanded_ft_s, points_s_g, .. } in &atlas.pulses {
        let Some((demanded, pulse)) = demanded_ft_s.zip(atlas.pulses.iter().find(|pulse| pulse.id == *id)) else {
            continue;
        };
        let area = pulse.area_m_per_s() / FT_M;
        if let (true, Some([_, [rise_s, peak_g], _])) = (area < demanded * (1.0 - SHORT), points_s_g.first_chunk()) {
            text += &item(
                "-",
                &format!(
                    "`{id}` ({source}) demands {demanded:.0} ft/s, {peak_g} g and a rise of {} ms at most. A triangle \
                     of these numbers has {rise_s} s · {peak_g} g = {area:.2} ft/s, {:.1} % less: a pulse that meets \
                     all three needs a longer tail.",
                    digits(1e3 * rise_s),
                    100.0 * (1.0 - area / demanded)
                ),
            );
        }
    }
    text += WRONG;
    text
}

const WRONG: &str = "\
- A model of four masses (Zenodo 19661518) states a stop from 15.6 m/s in which the chassis moves 70 mm at 140 m/s². A
  stop within 70 mm needs 15.6²/(2 · 0.07) = 1738 m/s² on average, and 140 m/s² needs 869 mm: the numbers are the
  response of the model to a force, not a crash.
- The formula of github.com/joe-cormier/pycrash for b1, `-b0/C + sqrt(b0² + 2)`, has no mass and no energy; its constant
  0.802 is right (17.6²/386.09 = 0.8023).
";
