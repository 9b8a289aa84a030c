//! A panel as vector graphics, 560 units wide: readable at that width, and with the larger type of a narrow window or
//! of paper at half of it.

use std::borrow::Cow;
use std::fmt::Write;

use crumple_numerics::thinning::{NEAR, thinned};

use super::figure::{Axis, Curve, Figure, Panel};
use super::look::{Look, Symbol};
use super::polyline::polyline;
use super::ticks::{self, Ticks};
use crate::drawing::numbers::{significant, superscript};
use crate::drawing::text::escape::{address, html};

/// Width of a panel.
pub const WIDTH: f64 = 560.0;
/// Room beside, above and below the axes, for type of up to [`TYPE`] units.
const LEFT: f64 = 66.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 26.0;
const ROW: f64 = 20.0;
const BOTTOM: f64 = 50.0;
/// Height of type in a narrow window and on paper, and the width of its characters, on average and with room.
const TYPE: f64 = 18.0;
const CHARACTER: f64 = 11.2;
/// The same of the bold type of systems with wide letters: what stands at an edge is cut where it is wider.
const WIDEST_CHARACTER: f64 = 1.15 * CHARACTER;

/// A panel with its scales.
pub struct Drawing<'a> {
    figure: &'a Figure,
    panel: Cow<'a, Panel>,
    x: Scale,
    y: Scale,
    /// Row of each mark's name, from the axes upward.
    rows: Vec<usize>,
    /// Rows of names that the panels of the figure have room for, so that their axes are level.
    room: usize,
}

impl<'a> Drawing<'a> {
    /// Lays a panel of the figure out.
    pub fn new(figure: &'a Figure, panel: &'a Panel) -> Self {
        let panel = panel.shown();
        let x = along(figure, &panel);
        let in_view = |p: &&[f64; 2]| (x.view[0]..=x.view[1]).contains(&p[0]);
        let y_view = panel.y.view.unwrap_or_else(|| {
            let dots = panel.dots.iter().map(|p| p[1]).chain(panel.links.iter().map(|link| link.at[1]));
            let points = shown(figure, &panel).flat_map(|c| &c.points).filter(in_view);
            reach(&panel.y, 0.06, points.map(|p| p[1]).chain(dots))
        });
        let y = Scale::new(&panel.y, y_view, [panel.height, 0.0]);
        let rows = rows_of_names(&panel, &x);
        let room = figure.panels.iter().flat_map(|panel| rows_of_names(panel, &along(figure, panel)));
        let room = room.max().map_or(0, |row| row + 1);
        Self { figure, panel, x, y, rows, room }
    }

    /// Height of the whole.
    pub fn height(&self) -> f64 {
        self.top() + self.panel.height + BOTTOM
    }

    fn top(&self) -> f64 {
        TOP + ROW * self.room as f64
    }

    /// The whole with its id, its name and a description, which a screen reader tells. `hidden` curves are drawn too,
    /// for a page that can show them.
    pub fn svg(&self, id: &str, hidden: bool) -> String {
        let (x, y) = (&self.panel.x.title, &self.panel.y.title);
        // Seven digits tell a hundredth of a pixel.
        let end = |value: f64| format!("{value:.6e}").parse().unwrap_or(value);
        let ends = |scale: &Scale| format!("{} {}", end(scale.view[0]), end(scale.view[1]));
        let kind = match (self.panel.time, self.panel.x.logarithmic, self.panel.y.logarithmic) {
            (true, ..) => " data-time=\"\"",
            (_, true, true) => " data-log=\"xy\"",
            (_, true, false) => " data-log=\"x\"",
            (_, false, true) => " data-log=\"y\"",
            _ => "",
        };
        let follows = self.panel.follows.map_or_else(String::new, |factor| format!(" data-follows=\"{factor}\""));
        format!(
            "<svg class=\"plot\" id=\"{id}\" viewBox=\"0 0 {WIDTH} {}\" role=\"{}\" aria-labelledby=\"{id}-t {id}-d\" \
             data-x=\"{}\" data-y=\"{}\"{kind}{follows}>\n<title id=\"{id}-t\">{}: {} over {}</title>\n\
             <desc id=\"{id}-d\">{}</desc>\n\
             {}</svg>\n",
            self.height(),
            // What an image holds is not reached by keys.
            if self.panel.links.is_empty() { "img" } else { "group" },
            ends(&self.x),
            ends(&self.y),
            html(&self.figure.title),
            html(y),
            html(x),
            html(&self.description()),
            self.content(hidden)
        )
    }

    /// Without the element around it.
    pub fn content(&self, hidden: bool) -> String {
        let mut out = String::new();
        self.axes(&mut out);
        let (top, width, height) = (self.top(), WIDTH - LEFT - RIGHT, self.panel.height);
        let _ = writeln!(
            out,
            "<svg class=\"in\" x=\"{LEFT}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" preserveAspectRatio=\"none\">"
        );
        self.inside(&mut out, hidden);
        let _ = writeln!(
            out,
            "</svg>\n<rect class=\"frame\" x=\"{LEFT}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"/>"
        );
        self.names(&mut out);
        self.labels(&mut out);
        out
    }

    /// Titles, numbers and lines of the grid.
    fn axes(&self, out: &mut String) {
        let (top, bottom) = (self.top(), self.top() + self.panel.height);
        let (along, up) = (
            self.x.ticks(8, self.panel.x.whole),
            self.y.ticks((self.panel.height / 42.0) as usize, self.panel.y.whole),
        );
        out.push_str("<g class=\"ys\">");
        for (y, number) in &up.at {
            let y = top + self.y.at(*y);
            let _ = write!(out, "<path class=\"g\" d=\"M{LEFT} {y:.1}H{}\"/>", WIDTH - RIGHT);
            if !number.is_empty() {
                let _ =
                    write!(out, "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{number}</text>", LEFT - 6.0, y + 4.5);
            }
        }
        out.push_str("</g>\n<g class=\"xs\">");
        for (x, number) in &along.at {
            let x = LEFT + self.x.at(*x);
            let _ = write!(out, "<path class=\"g\" d=\"M{x:.1} {top:.1}V{bottom:.1}\"/>");
            if !number.is_empty() {
                let _ =
                    write!(out, "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{number}</text>", bottom + 19.0);
            }
        }
        let _ = writeln!(
            out,
            "</g>\n<text class=\"t\" x=\"4\" y=\"16\">{}</text>\
             <text class=\"t\" x=\"{}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            html(&titled(&self.panel.y.title, &up)),
            (LEFT + WIDTH - RIGHT) / 2.0,
            bottom + 42.0,
            html(&titled(&self.panel.x.title, &along)),
        );
    }

    /// What lies between the axes.
    fn inside(&self, out: &mut String, hidden: bool) {
        let height = self.panel.height;
        for [from, to] in &self.panel.windows {
            let (from, to) = (self.x.at(*from), self.x.at(*to));
            let _ = writeln!(
                out,
                "<rect class=\"window\" x=\"{from:.1}\" y=\"0\" width=\"{:.1}\" height=\"{height}\"/>",
                (to - from).max(0.0)
            );
        }
        for guide in &self.panel.guides {
            let _ = writeln!(out, "<path class=\"l raw w1 d2\" d=\"{}\"/>", self.path(guide));
        }
        if let Some(zero) = Some(self.y.at(0.0)).filter(|y| !self.panel.y.logarithmic && *y > 0.5 && *y < height - 0.5)
        {
            let _ = writeln!(out, "<path class=\"l raw w1\" d=\"M-600 {zero:.1}H1800\"/>");
        }
        for (place, curve) in
            self.panel.bands.iter().map(|b| (true, b)).chain(self.panel.curves.iter().map(|c| (false, c)))
        {
            let entry = &self.figure.legend[curve.entry];
            if entry.shown || hidden {
                self.curve(out, curve, place, entry.look);
            }
        }
        for mark in &self.panel.marks {
            let look = Look::line(mark.colour, mark.dash).width(super::look::Width::Thin);
            let _ = writeln!(out, "<path class=\"{}\" d=\"M{:.1} 0V{height}\"/>", look.classes(), self.x.at(mark.at));
        }
    }

    fn curve(&self, out: &mut String, curve: &Curve, is_band: bool, look: Look) {
        let entry = curve.entry;
        if is_band {
            // One outline: what is far off is left out before it would be cut in two.
            let is_near = |point: &&[f64; 2]| self.is_near(&self.place(**point));
            let near: Vec<[f64; 2]> = curve.points.iter().filter(is_near).copied().collect();
            let _ = writeln!(out, "<path class=\"b {} e{entry}\" d=\"{}z\"/>", look.colour.name(), self.path(&near));
        } else if curve.marked {
            let symbol = look.symbol.unwrap_or(Symbol::Disc);
            let (kind, shape) = (symbol.class(), symbol.shape().1);
            let _ = write!(out, "<path class=\"{kind} {} e{entry} p\" d=\"", look.colour.name());
            for point in &curve.points {
                let [x, y] = self.place(*point);
                if x.is_finite() && y.is_finite() {
                    let _ = write!(out, "M{x:.1} {y:.1}{shape}");
                }
            }
            out.push_str("\"/>\n");
        } else {
            let _ = writeln!(out, "<path class=\"{} e{entry}\" d=\"{}\"/>", look.classes(), self.path(&curve.points));
        }
    }

    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.at(x), self.y.at(y)]
    }

    /// Whether a zoom can bring a place into view.
    fn is_near(&self, [x, y]: &[f64; 2]) -> bool {
        let (width, height) = (WIDTH - LEFT - RIGHT, self.panel.height);
        (-0.25 * width..=1.5 * width).contains(x) && (-3.0 * height..=4.0 * height).contains(y)
    }

    /// A line through points in hundredths of a unit: each stretch from its start in steps, gaps where a value is not
    /// finite. What lies far outside the view is left out.
    fn path(&self, points: &[[f64; 2]]) -> String {
        let placed: Vec<[f64; 2]> = points.iter().map(|point| self.place(*point)).collect();
        let near = |point: &[f64; 2]| self.is_near(point);
        let mut out = String::new();
        for stretch in placed.chunk_by(|a, b| near(a) && near(b)).filter(|stretch| near(&stretch[0])) {
            polyline(&mut out, &thinned(stretch, NEAR), 1);
        }
        out
    }

    /// Names of the marks, in rows above the axes, so that none lies on another or on a curve.
    fn names(&self, out: &mut String) {
        for (mark, row) in self.panel.marks.iter().zip(&self.rows).filter(|(mark, _)| !mark.name.is_empty()) {
            let x = LEFT + name_place(&mark.name, self.x.at(mark.at));
            let y = self.top() - 6.0 - ROW * *row as f64;
            let _ = writeln!(
                out,
                "<text class=\"n {}\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" data-at=\"{}\">{}</text>",
                mark.colour.name(),
                mark.at,
                html(&mark.name)
            );
        }
        for dot in &self.panel.dots {
            let [x, y] = self.place(*dot);
            let _ = writeln!(
                out,
                "<circle class=\"dot\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"4.5\" data-at=\"{}\"/>",
                LEFT + x,
                self.top() + y,
                dot[0]
            );
        }
        for link in &self.panel.links {
            let [x, y] = self.place(link.at);
            let _ = writeln!(
                out,
                "<a href=\"{}\"><circle class=\"link\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"5\">\
                 <title>{}</title></circle></a>",
                address(&link.address),
                LEFT + x,
                self.top() + y,
                html(&link.text)
            );
        }
    }

    /// Texts beside points, each where it covers no other text, point or curve; without such a place it is left out.
    fn labels(&self, out: &mut String) {
        let shown = self.panel.curves.iter().filter(|c| self.figure.legend[c.entry].shown);
        let drawn: Vec<[f64; 2]> = shown.flat_map(|c| &c.points).map(|point| self.place(*point)).collect();
        let mut taken: Vec<[f64; 4]> = Vec::new();
        let (width, height) = (WIDTH - LEFT - RIGHT, self.panel.height);
        for label in &self.panel.labels {
            let [x, y] = self.place(label.at);
            let (wide, high) = (CHARACTER * label.text.chars().count() as f64, TYPE);
            let beside =
                [(4.0, -0.5), (-wide - 4.0, -0.5), (-wide / 2.0, -1.2), (-wide / 2.0, 0.2), (4.0, -1.2), (4.0, 0.2)];
            let place = beside
                .iter()
                .map(|(dx, dy)| [x + dx, y + dy * high, x + dx + wide, y + (dy + 1.0) * high])
                .find(|[left, above, right, below]| {
                    let free = |p: &[f64; 2]| {
                        p[0] < left - 6.0 || p[0] > right + 6.0 || p[1] < above - 6.0 || p[1] > below + 6.0
                    };
                    let apart = |o: &[f64; 4]| o[2] < *left || o[0] > *right || o[3] < *above || o[1] > *below;
                    *left >= 0.0
                        && *right <= width
                        && *above >= 0.0
                        && *below <= height
                        && drawn.iter().all(free)
                        && taken.iter().all(apart)
                });
            let Some(place) = place else { continue };
            taken.push(place);
            let _ = writeln!(
                out,
                "<text class=\"t halo\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                LEFT + (place[0] + place[2]) / 2.0,
                self.top() + place[3] - 5.0,
                html(&label.text)
            );
        }
    }

    /// The curves in words: how far each reaches.
    fn description(&self) -> String {
        let number = |value: f64| significant(value, 4);
        let mut words = String::new();
        for curve in self.panel.curves.iter().filter(|c| self.figure.legend[c.entry].shown) {
            let inside = |p: &&[f64; 2]| p[1].is_finite() && (self.x.view[0]..=self.x.view[1]).contains(&p[0]);
            let by = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
            let points = || curve.points.iter().filter(inside);
            let (Some(low), Some(high)) = (points().min_by(by), points().max_by(by)) else { continue };
            let _ = write!(
                words,
                "{}: lowest {} at {}, highest {} at {}. ",
                self.figure.legend[curve.entry].name,
                number(low[1]),
                number(low[0]),
                number(high[1]),
                number(high[0])
            );
        }
        for mark in self.panel.marks.iter().filter(|mark| !mark.name.is_empty()) {
            let _ = write!(words, "Marked: {}. ", mark.name);
        }
        words.trim_end().to_owned()
    }
}

/// Curves and bands that are seen at first.
fn shown<'a>(figure: &'a Figure, panel: &'a Panel) -> impl Iterator<Item = &'a Curve> {
    panel.curves.iter().chain(&panel.bands).filter(|curve| figure.legend[curve.entry].shown)
}

/// The scale along a panel.
fn along(figure: &Figure, panel: &Panel) -> Scale {
    // Marks of points need room at the edges, lines none.
    let margin = if panel.curves.iter().any(|curve| curve.marked) { 0.03 } else { 0.0 };
    let points = || shown(figure, panel).flat_map(|c| &c.points).chain(panel.links.iter().map(|link| &link.at));
    let all = || reach(&panel.x, margin, points().map(|p| p[0]));
    Scale::new(&panel.x, panel.x.view.unwrap_or_else(all), [0.0, WIDTH - LEFT - RIGHT])
}

/// From values of an axis to units of the drawing.
struct Scale {
    logarithmic: bool,
    view: [f64; 2],
    ends: [f64; 2],
}

impl Scale {
    fn new(axis: &Axis, view: [f64; 2], ends: [f64; 2]) -> Self {
        Self { logarithmic: axis.logarithmic, view, ends }
    }

    fn at(&self, value: f64) -> f64 {
        let [low, high] = self.view;
        let share =
            if self.logarithmic { (value / low).ln() / (high / low).ln() } else { (value - low) / (high - low) };
        self.ends[0] + share * (self.ends[1] - self.ends[0])
    }

    fn ticks(&self, count: usize, whole: bool) -> Ticks {
        if self.logarithmic { ticks::logarithmic(self.view, count) } else { ticks::linear(self.view, count, whole) }
    }
}

/// What an axis has to reach over so that all values are seen, with a margin of that share. Never empty.
fn reach(axis: &Axis, margin: f64, values: impl Iterator<Item = f64>) -> [f64; 2] {
    let usable = values.filter(|x| x.is_finite() && (!axis.logarithmic || *x > 0.0));
    let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    if axis.logarithmic {
        let (low, high) = if low <= high { (low, high) } else { (0.1, 10.0) };
        let room = (high / low).powf(margin).max(if low < high { 1.0 } else { 2.0 });
        return [low / room, high * room];
    }
    let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
    // Values that differ by rounding alone are one: the numbers of an axis over them would have too many digits.
    let is_spread = high - low > 1e-6 * high.abs().max(low.abs());
    let room = if is_spread { margin * (high - low) } else { (0.1 * high.abs()).max(0.5) };
    [low - room, high + room]
}

/// The row of every mark's name: the lowest in which it lies on no other.
fn rows_of_names(panel: &Panel, x: &Scale) -> Vec<usize> {
    let mut taken: Vec<(usize, f64, f64)> = Vec::new();
    let mut rows = Vec::new();
    for mark in &panel.marks {
        let half = CHARACTER * mark.name.chars().count() as f64 / 2.0;
        let middle = name_place(&mark.name, x.at(mark.at));
        let is_free = |row: &usize| taken.iter().all(|(r, l, h)| r != row || middle + half < *l || middle - half > *h);
        let row = (0..).find(is_free).unwrap_or_default();
        if !mark.name.is_empty() {
            taken.push((row, middle - half - 4.0, middle + half + 4.0));
        }
        rows.push(row);
    }
    if taken.is_empty() { vec![] } else { rows }
}

/// The middle of a mark's name: at the mark, and not beyond the panel's edges.
fn name_place(name: &str, at: f64) -> f64 {
    let half = WIDEST_CHARACTER * name.chars().count() as f64 / 2.0;
    let (left, right) = (half - LEFT, WIDTH - LEFT - half);
    if left < right { at.clamp(left, right) } else { (left + right) / 2.0 }
}

/// The title of an axis with the power of ten of its numbers.
fn titled(title: &str, ticks: &Ticks) -> String {
    if ticks.exponent == 0 { title.to_owned() } else { format!("{title} × 10{}", superscript(ticks.exponent)) }
}

#[cfg(test)]
mod tests {
    use super::super::figure::Link;
    use super::super::look::{Colour, Dash};
    use super::*;

    #[test]
    fn values_that_differ_by_rounding_alone_are_one_value() {
        let axis = Axis::new("velocity, km/h");
        assert_eq!(reach(&axis, 0.0, [50.0, 50.0 - 1e-7].into_iter()), [45.0 - 1e-7, 55.0]);
        assert_eq!(reach(&axis, 0.0, [50.0, 49.0].into_iter()), [49.0, 50.0]);
        // Small numbers are no rounding of each other.
        assert_eq!(reach(&axis, 0.0, [0.0, 1e-9].into_iter()), [0.0, 1e-9]);
    }

    fn figure(points: Vec<[f64; 2]>) -> Figure {
        let mut figure = Figure::new("f", "F <1>");
        let entry = figure.entry("test & more", Look::line(Colour::Test, Dash::Solid), true);
        let mut panel = Panel::new(Axis::new("time, ms"), Axis::new("force, kN"));
        panel.line(entry, points);
        figure.panels.push(panel);
        figure
    }

    /// Points of a path as a script reads them: a start, then steps.
    fn points_of(svg: &str) -> Vec<[f64; 2]> {
        let path = svg.split("class=\"l test e0\" d=\"M").nth(1).unwrap().split('"').next().unwrap();
        let mut numbers = Vec::new();
        let mut number = String::new();
        for c in path.replace('l', " ").chars().chain([' ']) {
            let is_next = c == '-' || c == ' ' || (c == '.' && number.contains('.'));
            if is_next && !number.is_empty() {
                numbers.push(number.parse::<f64>().unwrap());
                number.clear();
            }
            if c != ' ' {
                number.push(c);
            }
        }
        let mut at = [0.0, 0.0];
        let steps = numbers.chunks(2);
        steps
            .map(|step| {
                at = [at[0] + step[0], at[1] + step[1]];
                at
            })
            .collect()
    }

    #[test]
    fn a_path_holds_the_curve_to_a_ten_thousandth_of_its_panel() {
        let figure = figure(vec![[0.0, 0.0], [50.0, -30.0], [80.0, 10.0], [100.0, 10.0]]);
        let drawing = Drawing::new(&figure, &figure.panels[0]);
        let svg = drawing.svg("f-0", false);
        let placed = points_of(&svg);
        assert_eq!(placed.len(), 4);
        // y from -30 to 10 with a margin of 6 % of 40 at both ends.
        let back = |[x, y]: [f64; 2]| [x / 480.0 * 100.0, 12.4 - y / 230.0 * 44.8];
        for (found, expected) in placed.iter().map(|p| back(*p)).zip(&figure.panels[0].curves[0].points) {
            assert!((found[0] - expected[0]).abs() < 2e-3 && (found[1] - expected[1]).abs() < 2e-3, "{found:?}");
        }
        assert!(svg.contains("role=\"img\"") && svg.contains("F &lt;1&gt;: force, kN over time, ms</title>"));
        assert!(svg.contains("test &amp; more: lowest −30.00 at 50.00, highest 10.00 at 100.0."), "{svg}");
    }

    #[test]
    fn names_of_near_marks_stand_in_rows_and_within_the_panel() {
        let mut figure = figure(vec![[0.0, 0.0], [100.0, 1.0]]);
        for (at, name) in
            [(0.0, "time zero"), (45.0, "tₘ = 45.0 ms"), (47.0, "rebound, 47.0 ms"), (100.0, "end of the event")]
        {
            figure.panels[0].mark(at, name, Colour::Event, Dash::Dashed);
        }
        let drawing = Drawing::new(&figure, &figure.panels[0]);
        assert_eq!(drawing.rows, [0, 0, 1, 0]);
        assert_eq!(drawing.height(), TOP + 2.0 * ROW + 230.0 + BOTTOM);
        let last = name_place("end of the event", 480.0);
        assert!(LEFT + last + WIDEST_CHARACTER * 8.0 <= WIDTH, "{last}");
    }

    #[test]
    fn a_label_without_a_free_place_is_left_out() {
        let mut figure = figure((0..=100).map(|k| [f64::from(k), 50.0]).collect());
        for y in [50.0, 40.0, 40.0] {
            figure.panels[0].labels.push(super::super::figure::Label { at: [50.0, y], text: "ζ 0.5".into() });
        }
        figure.panels[0].y.view = Some([0.0, 100.0]);
        let drawing = Drawing::new(&figure, &figure.panels[0]);
        let mut out = String::new();
        drawing.labels(&mut out);
        let places: Vec<&str> = out.lines().collect();
        assert!(places.len() >= 2, "{out}");
        assert!(places.iter().enumerate().all(|(k, place)| !places[..k].contains(place)), "{out}");
        // 4 to the right of the point and half a line above it would lie on the curve.
        assert!(!out.contains("y=\"154.5\""), "{out}");
    }

    #[test]
    fn a_band_that_reaches_beyond_the_zoom_has_one_outline() {
        let mut figure = figure(vec![[0.0, 0.0], [1.0, 1.0]]);
        let edges: Vec<[f64; 3]> = (-400..400).map(|k| [f64::from(k) * 0.01, 0.2, 0.8]).collect();
        figure.panels[0].band(0, &edges);
        figure.panels[0].x.view = Some([0.0, 1.0]);
        let svg = Drawing::new(&figure, &figure.panels[0]).content(false);
        let outline = svg.split("class=\"b test e0\" d=\"").nth(1).unwrap().split('"').next().unwrap();
        assert!(outline.ends_with('z') && outline.matches('M').count() == 1, "{outline}");
    }

    #[test]
    fn gaps_stay_gaps_and_one_value_has_an_axis() {
        let figure = figure(vec![[0.0, 2.0], [1.0, 2.0], [2.0, f64::NAN], [3.0, 2.0], [4.0, 2.0]]);
        let drawing = Drawing::new(&figure, &figure.panels[0]);
        let path = drawing.path(&figure.panels[0].curves[0].points);
        assert_eq!(path, "M0 115l120 0M360 115l120 0");
    }

    #[test]
    fn a_point_that_leads_to_a_page_is_reached_by_keys_and_its_text_is_safe() {
        let mut figure = figure(vec![[0.0, 0.0], [1.0, 1.0]]);
        let link = Link { at: [2.0, 3.0], address: "runs/a \"b/report.html".into(), text: "<b>".into() };
        figure.panels[0].links.push(link);
        let drawing = Drawing::new(&figure, &figure.panels[0]);
        let svg = drawing.svg("f-0", false);
        assert!(svg.contains("href=\"runs/a%20%22b/report.html\"") && svg.contains("<title>&lt;b&gt;</title>"));
        assert!(svg.contains("role=\"group\"") && drawing.x.view[1] >= 2.0 && drawing.y.view[1] >= 3.0);
    }
}
