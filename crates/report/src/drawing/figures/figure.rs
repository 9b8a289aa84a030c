//! What a figure says: panels of curves, bands and marks over axes, and one legend for all of them. No coordinates of
//! paper stand here; `panel` draws it.

use std::borrow::Cow;

use crumple_numerics::thinning::extremes;
use crumple_signal::Sampled;
use crumple_signal::display::{factor_shown, unit_shown};

use super::look::{Colour, Dash, Look};

/// A figure of the report: panels that share a legend.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Id of its element on the page and name of its file.
    pub id: &'static str,
    /// Heading above it.
    pub title: String,
    /// What it shows and what to take from it, plain text.
    pub caption: String,
    /// Names of the curves, each with how it is drawn in every panel.
    pub legend: Vec<Entry>,
    /// The panels, in the order of reading.
    pub panels: Vec<Panel>,
}

/// One name of a legend.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Plain text.
    pub name: String,
    /// How its curves are drawn.
    pub look: Look,
    /// Whether its curves are seen at first.
    pub shown: bool,
}

/// One pair of axes and what is drawn between them.
#[derive(Debug, Clone)]
pub struct Panel {
    /// The axis along.
    pub x: Axis,
    /// The axis upward.
    pub y: Axis,
    /// Height between the axes' ends, in units of which a panel is 560 wide.
    pub height: f64,
    /// Whether `x` is the time of the record: such panels share a cursor and a zoom.
    pub time: bool,
    /// Where `x` is the displacement and `y` the acceleration of the same body times a factor, both of panels over
    /// time: that factor, by which the cursor over time has a place here.
    pub follows: Option<f64>,
    /// Curves and clouds of points, the first below the others.
    pub curves: Vec<Curve>,
    /// Filled areas below the curves.
    pub bands: Vec<Curve>,
    /// Stretches of `x` shaded over the whole height.
    pub windows: Vec<[f64; 2]>,
    /// Lines across the whole height, named above the panel.
    pub marks: Vec<Mark>,
    /// Points that marks speak of.
    pub dots: Vec<[f64; 2]>,
    /// Thin lines that help the eye, below everything.
    pub guides: Vec<Vec<[f64; 2]>>,
    /// Texts beside points of the plane; those without room are left out.
    pub labels: Vec<Label>,
    /// Points that lead to other pages.
    pub links: Vec<Link>,
}

/// An axis: what it is called, how far it reaches.
#[derive(Debug, Clone, Default)]
pub struct Axis {
    /// Quantity and unit: `force, kN`.
    pub title: String,
    /// Unit of the points, where the page shows them in that of its reader; empty: as they are.
    pub unit: &'static str,
    /// Whether equal factors are equal distances.
    pub logarithmic: bool,
    /// Ends of the first view; `None`: all that is shown at first.
    pub view: Option<[f64; 2]>,
    /// Whether only whole numbers are marked.
    pub whole: bool,
}

/// Points of an entry of the legend.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Its place in the legend.
    pub entry: usize,
    /// `x` and `y` in the units of the axes; a value that is not finite leaves a gap.
    pub points: Vec<[f64; 2]>,
    /// Whether the points are marked and not joined.
    pub marked: bool,
}

/// A named line across a panel.
#[derive(Debug, Clone)]
pub struct Mark {
    /// Where, in the unit of `x`.
    pub at: f64,
    /// Its name; empty: none.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// Its line.
    pub dash: Dash,
}

/// A text beside a point.
#[derive(Debug, Clone)]
pub struct Label {
    /// The point.
    pub at: [f64; 2],
    /// The text.
    pub text: String,
}

/// A point that leads to another page.
#[derive(Debug, Clone)]
pub struct Link {
    /// The point.
    pub at: [f64; 2],
    /// Path of that page from the folder of this one.
    pub address: String,
    /// What it says when pointed at, plain text.
    pub text: String,
}

impl Figure {
    /// A figure without panels.
    pub fn new(id: &'static str, title: impl Into<String>) -> Self {
        Self { id, title: title.into(), caption: String::new(), legend: vec![], panels: vec![] }
    }

    /// Puts a name into the legend; its place is what curves refer to.
    pub fn entry(&mut self, name: impl Into<String>, look: Look, shown: bool) -> usize {
        self.legend.push(Entry { name: name.into(), look, shown });
        self.legend.len() - 1
    }

    /// Leaves out names without a curve, and panels without any.
    #[must_use]
    pub fn tidy(mut self) -> Self {
        for panel in &mut self.panels {
            panel.curves.retain(|curve| curve.points.iter().any(|p| p.iter().all(|x| x.is_finite())));
            panel.bands.retain(|band| band.points.len() > 2);
        }
        self.panels.retain(|panel| !panel.curves.is_empty());
        let is_drawn = |entry: usize| {
            self.panels.iter().flat_map(|panel| panel.curves.iter().chain(&panel.bands)).any(|c| c.entry == entry)
        };
        let kept: Vec<usize> = (0..self.legend.len()).filter(|entry| is_drawn(*entry)).collect();
        let place = |entry: usize| kept.iter().position(|k| *k == entry).unwrap_or_default();
        for curve in self.panels.iter_mut().flat_map(|panel| panel.curves.iter_mut().chain(&mut panel.bands)) {
            curve.entry = place(curve.entry);
        }
        self.legend = kept.into_iter().map(|entry| self.legend[entry].clone()).collect();
        self
    }
}

impl Panel {
    /// An empty panel.
    pub fn new(x: Axis, y: Axis) -> Self {
        Self {
            x,
            y,
            height: 230.0,
            time: false,
            follows: None,
            curves: vec![],
            bands: vec![],
            windows: vec![],
            marks: vec![],
            dots: vec![],
            guides: vec![],
            labels: vec![],
            links: vec![],
        }
    }

    /// Over the record's time, ms.
    pub fn over_time(time: Axis, y: Axis) -> Self {
        Self { time: true, ..Self::new(time, y) }
    }

    /// Draws a line through the points.
    pub fn line(&mut self, entry: usize, points: Vec<[f64; 2]>) {
        self.curves.push(Curve { entry, points, marked: false });
    }

    /// Draws the points alone.
    pub fn points(&mut self, entry: usize, points: Vec<[f64; 2]>) {
        self.curves.push(Curve { entry, points, marked: true });
    }

    /// Fills the area between two edges given as `x`, lower, upper.
    pub fn band(&mut self, entry: usize, edges: &[[f64; 3]]) {
        let upper = edges.iter().map(|[x, _, high]| [*x, *high]);
        let lower = edges.iter().rev().map(|[x, low, _]| [*x, *low]);
        self.bands.push(Curve { entry, points: upper.chain(lower).collect(), marked: false });
    }

    /// Columns side by side between the edges, one more than there are heights, from zero up: a histogram.
    pub fn columns(&mut self, entry: usize, edges: &[f64], heights: &[f64]) {
        let tops = || edges.windows(2).zip(heights).flat_map(|(pair, height)| pair.iter().map(|x| [*x, *height]));
        let ends = [edges.first(), edges.last()].map(|edge| edge.map(|x| [*x, 0.0]));
        self.line(entry, ends[0].into_iter().chain(tops()).chain(ends[1]).collect());
        let band: Vec<[f64; 3]> = tops().map(|[x, height]| [x, 0.0, height]).collect();
        self.band(entry, &band);
    }

    /// The panel as it is drawn: both axes in the units of the reader.
    pub(super) fn shown(&self) -> Cow<'_, Self> {
        let [along, up] = [&self.x, &self.y].map(|axis| factor_shown(axis.unit));
        if [along, up] == [1.0, 1.0] {
            return Cow::Borrowed(self);
        }
        let mut panel = self.clone();
        let moved = |point: &mut [f64; 2]| *point = [along * point[0], up * point[1]];
        panel.curves.iter_mut().chain(&mut panel.bands).flat_map(|curve| &mut curve.points).for_each(moved);
        panel.dots.iter_mut().chain(panel.guides.iter_mut().flatten()).for_each(moved);
        panel.labels.iter_mut().for_each(|label| moved(&mut label.at));
        panel.links.iter_mut().for_each(|link| moved(&mut link.at));
        panel.windows.iter_mut().chain(&mut panel.x.view).flatten().for_each(|x| *x *= along);
        panel.y.view.iter_mut().flatten().for_each(|y| *y *= up);
        panel.marks.iter_mut().for_each(|mark| mark.at *= along);
        panel.follows = panel.follows.map(|per| up * per);
        Cow::Owned(panel)
    }

    /// Marks a place of `x`.
    pub fn mark(&mut self, at: f64, name: impl Into<String>, colour: Colour, dash: Dash) {
        self.marks.push(Mark { at, name: name.into(), colour, dash });
    }
}

impl Axis {
    /// A linear axis that shows all there is.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// Of a quantity whose points are in a unit of metric pages; it is drawn in that of the reader.
    pub fn of((name, unit): (&str, &'static str)) -> Self {
        Self { unit, ..Self::new(format!("{name}, {}", unit_shown(unit))) }
    }

    /// With these ends.
    #[must_use]
    pub fn from_to(self, view: [f64; 2]) -> Self {
        Self { view: Some(view), ..self }
    }
}

/// A curve of more samples than this is made of the extremes of stretches: a figure has some thousand columns, of which
/// the view may show a tenth.
const MOST_POINTS: usize = 1 << 18;

/// Samples over time in ms, times `factor`; of long series the first, lowest, highest and last of equal stretches.
pub fn over_time(signal: &Sampled, factor: f64) -> Vec<[f64; 2]> {
    let samples = signal.samples();
    let point = |k: usize| [1e3 * signal.time_s(k), factor * samples[k]];
    if samples.len() <= MOST_POINTS {
        return (0..samples.len()).map(point).collect();
    }
    let stretch = samples.len().div_ceil(MOST_POINTS / 4);
    let of_stretch =
        |(j, values): (usize, &[f64])| extremes(values).into_iter().map(|k| point(j * stretch + k)).collect::<Vec<_>>();
    samples.chunks(stretch).enumerate().flat_map(of_stretch).collect()
}

/// One list over another.
pub fn over(x: &[f64], y: &[f64]) -> Vec<[f64; 2]> {
    x.iter().zip(y).map(|(x, y)| [*x, *y]).collect()
}

/// Lowest and highest of the values; `None` without any.
pub fn span(values: &[f64]) -> Option<(f64, f64)> {
    let first = *values.first()?;
    Some(values.iter().fold((first, first), |(low, high), &y| (low.min(y), high.max(y))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_without_a_curve_and_empty_panels_are_left_out() {
        let mut figure = Figure::new("f", "F");
        let look = Look::line(Colour::Test, Dash::Solid);
        let (absent, there) = (figure.entry("absent", look, true), figure.entry("there", look, true));
        let mut panel = Panel::new(Axis::new("x"), Axis::new("y"));
        panel.line(absent, vec![[0.0, f64::NAN]]);
        panel.line(there, vec![[0.0, 1.0]]);
        figure.panels = vec![panel, Panel::new(Axis::new("x"), Axis::new("z"))];
        let tidy = figure.tidy();
        assert_eq!((tidy.legend.len(), tidy.legend[0].name.as_str()), (1, "there"));
        assert_eq!((tidy.panels.len(), tidy.panels[0].curves[0].entry), (1, 0));
    }

    #[test]
    fn a_long_curve_keeps_its_ends_and_a_peak_of_one_sample() {
        let mut samples: Vec<f64> = (0..1_000_003).map(|k| f64::from(k % 7)).collect();
        samples[123_456] = -50.0;
        let signal = Sampled::new(0.0, 1e-6, samples).unwrap();
        let points = over_time(&signal, 2.0);
        assert!(points.len() <= MOST_POINTS && points.windows(2).all(|pair| pair[1][0] > pair[0][0]));
        let peak = [1e3 * signal.time_s(123_456), -100.0];
        let end = [1e3 * signal.time_s(1_000_002), 2.0 * signal.samples()[1_000_002]];
        assert!(points.contains(&peak) && points.last() == Some(&end) && points[0] == [0.0, 0.0]);
    }

    #[test]
    fn columns_of_a_histogram_stand_on_zero() {
        let mut panel = Panel::new(Axis::new("x"), Axis::new("runs"));
        panel.columns(0, &[0.0, 1.0, 2.0], &[3.0, 1.0]);
        let line = [[0.0, 0.0], [0.0, 3.0], [1.0, 3.0], [1.0, 1.0], [2.0, 1.0], [2.0, 0.0]];
        assert_eq!(panel.curves[0].points, line);
        assert_eq!(panel.bands[0].points[4..], [[2.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 0.0]]);
    }
}
