//! Simulation-based calibration: the ranks of the truth within the posteriors that intervals stand for, by family and
//! condition, as a page and a drawing. With right posteriors ranks are uniform.

use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use crumple_stage::wrapped;

use crate::PAGE_COLUMNS;
use crate::contact_cover;
use crate::interval_cover::{CoverError, Draw, FAMILIES, cover_of};
use crate::records::Errors;

/// Bins of a histogram.
pub const BINS: usize = 5;
/// 95 % quantile of chi-square with four degrees of freedom, [`BINS`] less one.
const CHI_SQUARE_95: f64 = 9.488;
/// The middle 95 % of a posterior.
const MIDDLE: std::ops::RangeInclusive<f64> = 0.025..=0.975;
/// Deviations of a count that it is below by chance in one case of a thousand.
const ONE_IN_1000: f64 = 3.09;
/// Fewer than five expected in a bin: chi-square does not apply.
const FEWEST: usize = 5 * BINS;

/// What the records of a row have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Condition {
    /// Trigger and delay of a filter.
    Laboratory,
    /// The same, and a ring.
    Ringing,
    /// Contact, braking, soft fronts: those of its kind of record.
    Events,
}

impl Condition {
    /// For people.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Laboratory => "trigger and delay",
            Self::Ringing => "trigger, delay and ring",
            Self::Events => "events",
        }
    }
}

/// What the shape of ranks says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Too few to say.
    TooFew,
    /// As of right posteriors.
    Uniform,
    /// A hump.
    TooWide,
    /// Higher at both ends.
    TooNarrow,
    /// A slope: truths lie high.
    ValuesTooLow,
    /// A slope: truths lie low.
    ValuesTooHigh,
}

impl Shape {
    /// For a page; what may mislead stands out.
    pub const fn words(self) -> &'static str {
        match self {
            Self::TooFew => "too few",
            Self::Uniform => "uniform",
            Self::TooWide => "too wide",
            Self::TooNarrow => "**too narrow**",
            Self::ValuesTooLow => "**values too low**",
            Self::ValuesTooHigh => "**values too high**",
        }
    }
}

/// Ranks of one number.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranks {
    /// Family of the fitted model, or kind of record.
    pub of: String,
    /// What its records have.
    pub condition: Condition,
    /// Whether it is of a fitted model of one mass with few parameters, as those that a run recommends.
    pub is_simple: bool,
    /// Parameter or event.
    pub number: String,
    /// From 0 to 1, one a record with a closed interval.
    pub ranks: Vec<f64>,
}

impl Ranks {
    /// How many lie in each bin.
    pub fn counts(&self) -> [usize; BINS] {
        let mut counts = [0; BINS];
        for rank in &self.ranks {
            counts[((rank * BINS as f64) as usize).min(BINS - 1)] += 1;
        }
        counts
    }

    /// Chi-square against equal bins; `None` of too few ranks.
    pub fn chi_square(&self) -> Option<f64> {
        let expected = self.ranks.len() as f64 / BINS as f64;
        let square = |count: usize| (count as f64 - expected).powi(2) / expected;
        (self.ranks.len() >= FEWEST).then(|| self.counts().into_iter().map(square).sum())
    }

    /// What the shape says.
    pub fn shape(&self) -> Shape {
        let Some(chi_square) = self.chi_square() else { return Shape::TooFew };
        if chi_square <= CHI_SQUARE_95 {
            return Shape::Uniform;
        }
        let (counts, mean) = (self.counts(), self.ranks.iter().sum::<f64>() / self.ranks.len() as f64);
        let outer = (counts[0] + counts[BINS - 1]) as f64 / self.ranks.len() as f64;
        // Three deviations of the mean of that many uniform ranks.
        let one_sided = 3.0 / (12.0 * self.ranks.len() as f64).sqrt();
        match outer {
            _ if mean > 0.5 + one_sided => Shape::ValuesTooLow,
            _ if mean < 0.5 - one_sided => Shape::ValuesTooHigh,
            outer if outer < 2.0 / BINS as f64 => Shape::TooWide,
            _ => Shape::TooNarrow,
        }
    }

    /// How many truths lie in the middle 95 % of their posterior.
    pub fn held(&self) -> usize {
        self.ranks.iter().filter(|rank| MIDDLE.contains(*rank)).count()
    }

    /// Whether surely fewer truths than 95 % lie in the middle 95 %.
    pub fn misleads(&self) -> bool {
        let count = self.ranks.len() as f64;
        let by_chance = 0.95 * count - ONE_IN_1000 * (count * 0.95 * 0.05).sqrt();
        self.ranks.len() >= FEWEST && (self.held() as f64) < by_chance
    }
}

/// Ranks of all families and kinds whose name has one of the `wanted` parts, over the records of these numbers; the
/// same for any number of threads. Errors: a program that is missing or fails.
pub fn ranks_of(
    wanted: &dyn Fn(&str) -> bool,
    numbers: &Range<usize>,
    (bin, pipeline): (&Path, &Path),
    folder: &Path,
) -> Result<Vec<Ranks>, CoverError> {
    let mut all = Vec::new();
    for family in FAMILIES.iter().filter(|family| wanted(family.name)) {
        let is_simple = matches!(family.draw, Draw::Kelvin | Draw::Elastoplastic | Draw::Maxwell);
        for (condition, errors) in [(Condition::Laboratory, Errors::Laboratory), (Condition::Ringing, Errors::Ringing)]
        {
            let cover = cover_of(family, numbers.clone(), errors, (bin, folder))?;
            let of = |(number, counts): (String, crate::interval_cover::Counts)| Ranks {
                of: family.name.to_owned(),
                condition,
                is_simple,
                number,
                ranks: counts.ranks,
            };
            all.extend(cover.parameters.into_iter().map(of));
        }
    }
    for kind in contact_cover::KINDS.iter().filter(|kind| wanted(kind.name)) {
        let held = contact_cover::cover_of(kind, numbers.clone(), (bin, pipeline), folder, false)?;
        for (number, ranks) in ["dynamic crush", "time of crush", "delta-v"].into_iter().zip(held.ranks) {
            let (of, number) = (kind.name.to_owned(), number.to_owned());
            all.push(Ranks { of, condition: Condition::Events, is_simple: false, number, ranks });
        }
    }
    Ok(all)
}

const HEAD: &str = "\
# Calibration of the intervals

<!-- Written by `just calibration`; do not edit. -->

Does the uncertainty mean what it says? Cars of known parameters are drawn, recorded [as a laboratory
does](methods/prediction.md#records-as-a-laboratory-measures-them) and run. Each record gives a posterior of each
parameter, and the truth has a rank in it: 0.3 if 30 % of the posterior lies below the truth. Over many records the
ranks of a right posterior are uniform from 0 to 1 (Talts et al., 2018, simulation-based calibration).

A run states a value and an interval, so the posterior is taken as the distribution that has the value as its median and
the interval as its 95 % (events: 90 %), to each side log-normal, or normal where the interval reaches zero. Ranks of
open intervals do not exist. *Ring* adds a decaying sine of 60 to 250 Hz and 5 to 15 % of the peak, as a mount adds it.
Events are those of `just interval-benchmark --contact`, whose contact, braking and soft fronts are unknown to the run.

![Histograms of the ranks](images/calibration.svg)

Bars that rise at both ends say: too narrow. A hump says: wider than need be. A slope says: values too low (rising) or
too high (falling). Red misleads, grey has too few ranks.

Two things show. The filter of a laboratory only delays, by 0.25 ms in half of these records, while an interval holds
time zero to both sides alike: values lean to one side inside of intervals that hold them. A ring is taken for misfit
that could be anywhere, so the intervals of models of one mass become several times too wide.
";

/// The page in Markdown.
pub fn page(all: &[Ranks], records: usize) -> String {
    let tested = all.iter().filter(|ranks| ranks.chi_square().is_some()).count();
    let with = |shape: Shape| all.iter().filter(|ranks| ranks.shape() == shape).count();
    let counted = format!(
        "{records} records a family and condition. The ranks are counted in {BINS} equal bins; chi-square of four \
         degrees of freedom is below {CHI_SQUARE_95:.2} in 95 % of uniform cases. Of {tested} numbers with at least \
         {FEWEST} ranks {} are uniform, {} too wide, {} too narrow, {} have values too low and {} too high. Where all \
         were right, {:.0} would not look uniform by chance.",
        with(Shape::Uniform),
        with(Shape::TooWide),
        with(Shape::TooNarrow),
        with(Shape::ValuesTooLow),
        with(Shape::ValuesTooHigh),
        0.05 * tested as f64
    );
    let mut page = format!("{HEAD}\n{}\n", wrapped(&counted, PAGE_COLUMNS).join("\n"));
    page += "\n| of | records with | number | ranks | bins | chi-square | |\n|---|---|---|---|---|---|---|\n";
    for ranks in all {
        let chi_square = ranks.chi_square().map_or_else(|| "-".to_owned(), |chi_square| format!("{chi_square:.1}"));
        let bins: Vec<String> = ranks.counts().iter().map(usize::to_string).collect();
        let _infallible = writeln!(
            page,
            "| {} | {} | {} | {} | {} | {chi_square} | {} |",
            ranks.of,
            ranks.condition.words(),
            ranks.number,
            ranks.ranks.len(),
            bins.join(" "),
            ranks.shape().words()
        );
    }
    page
}

/// Size of a panel, its histogram, and the panels in a row, px.
const PANEL: [f64; 2] = [150.0, 92.0];
const BARS: [f64; 2] = [130.0, 48.0];
const IN_A_ROW: usize = 6;
/// Height of the title of a group, px.
const TITLE: f64 = 26.0;

/// All histograms as SVG, a group of panels a family and condition; a line at what uniform ranks have.
pub fn drawing(all: &[Ranks]) -> String {
    let (mut body, mut y) = (String::new(), 0.0);
    for group in all.chunk_by(|a, b| (&a.of, a.condition) == (&b.of, b.condition)) {
        let title = format!("{}: {}", group[0].of, group[0].condition.words());
        let _infallible = writeln!(body, "<text x=\"10\" y=\"{:.0}\" class=\"t\">{title}</text>", y + TITLE - 8.0);
        y += TITLE;
        let drawn: Vec<&Ranks> = group.iter().filter(|ranks| !ranks.ranks.is_empty()).collect();
        for row in drawn.chunks(IN_A_ROW) {
            for (place, ranks) in row.iter().enumerate() {
                panel(&mut body, ranks, [10.0 + place as f64 * PANEL[0], y]);
            }
            y += PANEL[1];
        }
    }
    let width = 20.0 + IN_A_ROW as f64 * PANEL[0];
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {y:.0}\" font-family=\"sans-serif\">\n\
         <style>text{{font-size:10px;fill:#333}}.t{{font-size:13px;font-weight:bold}}rect{{fill:#4477aa}}\
         .bad{{fill:#cc6677}}.few{{fill:#bbb}}line{{stroke:#222;stroke-dasharray:3 2}}</style>\n\
         <rect width=\"100%\" height=\"100%\" style=\"fill:#fff\"/>\n{body}</svg>\n"
    )
}

fn panel(body: &mut String, ranks: &Ranks, [x, y]: [f64; 2]) {
    let counts = ranks.counts();
    let expected = ranks.ranks.len() as f64 / BINS as f64;
    let largest = counts.iter().fold(2.0 * expected, |largest, count| largest.max(*count as f64)).max(1.0);
    let class = match ranks.shape() {
        Shape::TooFew => "few",
        Shape::Uniform | Shape::TooWide => "ok",
        Shape::TooNarrow | Shape::ValuesTooLow | Shape::ValuesTooHigh => "bad",
    };
    let (width, base) = (BARS[0] / BINS as f64, y + 12.0 + BARS[1]);
    let _infallible =
        writeln!(body, "<text x=\"{x:.0}\" y=\"{:.0}\">{} ({})</text>", y + 8.0, ranks.number, ranks.ranks.len());
    for (place, count) in counts.iter().enumerate() {
        let height = BARS[1] * *count as f64 / largest;
        let _infallible = writeln!(
            body,
            "<rect class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{height:.1}\"/>",
            x + place as f64 * width,
            base - height,
            width - 1.0
        );
    }
    let level = base - BARS[1] * expected / largest;
    let _infallible =
        writeln!(body, "<line x1=\"{x:.0}\" x2=\"{:.0}\" y1=\"{level:.1}\" y2=\"{level:.1}\"/>", x + BARS[0]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(ranks: impl Iterator<Item = f64>) -> Ranks {
        let (of, number) = ("kelvin".to_owned(), "k".to_owned());
        Ranks { of, condition: Condition::Laboratory, is_simple: true, number, ranks: ranks.collect() }
    }

    #[test]
    fn shapes_of_ranks_are_told_apart() {
        let grid = || (0..100).map(|k| (f64::from(k) + 0.5) / 100.0);
        let uniform = of(grid());
        assert_eq!((uniform.counts(), uniform.chi_square(), uniform.shape()), ([20; BINS], Some(0.0), Shape::Uniform));
        let narrow = of(grid().map(|u| if u < 0.5 { 0.5 * u } else { 0.5 + 0.5 * u }));
        assert_eq!((narrow.shape(), narrow.held(), narrow.misleads()), (Shape::TooNarrow, 90, false));
        let narrower = of(grid().map(|u| if u < 0.5 { 0.18 * u } else { 0.82 + 0.18 * u }));
        // Of each half those from 0.025/0.18 = 0.139 on: 36 of 50.
        assert_eq!((narrower.held(), narrower.misleads()), (72, true));
        let wide = of(grid().map(|u| 0.35 + 0.3 * u));
        assert_eq!((wide.shape(), wide.misleads()), (Shape::TooWide, false));
        assert_eq!(of(grid().map(f64::sqrt)).shape(), Shape::ValuesTooLow);
        assert_eq!(of(grid().map(|u| u * u)).shape(), Shape::ValuesTooHigh);
        let few = of(grid().take(FEWEST - 1));
        assert_eq!((few.shape(), few.misleads()), (Shape::TooFew, false));
        // Ends count.
        assert_eq!(of([0.0, 1.0].into_iter()).counts(), [1, 0, 0, 0, 1]);
    }

    #[test]
    fn page_and_drawing_hold_every_number() {
        let all = [
            of((0..50).map(|k| f64::from(k) / 50.0)),
            Ranks { condition: Condition::Ringing, ..of([0.5].into_iter()) },
        ];
        let page = page(&all, 50);
        assert!(page.contains("| kelvin | trigger and delay | k | 50 | 10 10 10 10 10 | 0.0 | uniform |"), "{page}");
        assert!(page.contains("| kelvin | trigger, delay and ring | k | 1 | 0 0 1 0 0 | - | too few |"), "{page}");
        let drawn = drawing(&all);
        assert_eq!((drawn.matches("<rect class").count(), drawn.matches("<line").count()), (2 * BINS, 2), "{drawn}");
    }
}
