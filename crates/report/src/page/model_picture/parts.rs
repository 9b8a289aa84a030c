//! The masses and elements of a candidate with the words that stand at them.

use crate::words;
use std::collections::BTreeMap;

use crate::drawing::numbers::{KILO, NBSP};
use crate::findings::{CandidateResult, ShownParameter};
use crumple_artifact::records::{CandidateV1, Certainty};
use crumple_lumped::{Chain, Element, Model, Node, ParameterKind, Place, Structure, parameter_kind, structure_of};
use crumple_signal::display::{factor_shown, unit_shown};

/// What a drawing of a model needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Parts {
    /// Masses from the barrier on.
    pub masses: Vec<MassPart>,
    /// What joins them.
    pub elements: Vec<ElementPart>,
}

/// One mass.
#[derive(Debug, Clone, PartialEq)]
pub struct MassPart {
    /// `m1`, or `m` of a single mass.
    pub symbol: String,
    /// Value, then its interval if it was asked of the record.
    pub lines: Vec<String>,
    /// Whether this record does not determine it.
    pub open: bool,
}

/// One element between two nodes; `None`: the barrier.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementPart {
    /// The side nearer to the barrier.
    pub front: Option<usize>,
    /// The other side.
    pub rear: Option<usize>,
    /// How it is drawn.
    pub glyph: Glyph,
    /// `k1`, `c1`, `F1`.
    pub symbol: String,
    /// Value with unit first, then intervals.
    pub lines: Vec<String>,
    /// Whether this record leaves it, or most of its numbers, undetermined.
    pub open: bool,
}

/// How an element is drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Glyph {
    /// A zigzag.
    Spring,
    /// A cylinder with a piston.
    Damper,
    /// Both, one behind the other.
    SpringAndDamper,
    /// A small curve, loading and unloading, in shares of its box.
    Curve(Vec<(f64, f64)>),
}

/// The parts of a candidate; `None` where its model or parameters are none that this program knows.
pub fn parts(candidate: &CandidateResult) -> Option<Parts> {
    let record = &candidate.record;
    let structure = structure_of(&record.model, record.law.as_deref(), &record.parameters).ok()?;
    let owners = owners(record)?;
    let alone = structure.masses_kg().len() == 1;
    let masses = structure.masses_kg().iter().enumerate();
    let masses = masses
        .map(|(i, kg)| {
            let name = owners.iter().find(|(_, place)| **place == Place::Mass(i)).map(|(name, _)| name.as_str());
            let known = name.map(|name| Known::of(candidate, name)).unwrap_or_default();
            let value = known.value.unwrap_or_else(|| words::significant(factor_shown("kg") * kg, 4));
            let mut lines = vec![format!("{value} {}{}", unit_shown("kg"), if known.open { " ?" } else { "" })];
            // The mark says that it is in doubt; there is no room for more.
            lines.extend(known.interval.filter(|_| !known.open));
            MassPart { symbol: numbered("m", i, alone), lines, open: known.open }
        })
        .collect();
    let elements = (0..structure.connections().len()).map(|at| element(candidate, &structure, &owners, at)).collect();
    Some(Parts { masses, elements })
}

/// Where each parameter of a candidate stands in its structure.
fn owners(record: &CandidateV1) -> Option<BTreeMap<String, Place>> {
    let (model, parameters) = (record.model.as_str(), &record.parameters);
    if model == "chain" {
        let place = |name: &String| {
            let kind = Chain::parameter_kind(name)?;
            let digits: String = name[1..].chars().take_while(char::is_ascii_digit).collect();
            let mass = digits.parse::<usize>().ok()?.checked_sub(1)?;
            let side = usize::from(name.starts_with('c'));
            Some(match kind {
                ParameterKind::Mass => Place::Mass(mass),
                _ => Place::Element { connection: 2 * mass + side, parameter: 0 },
            })
        };
        return Some(parameters.keys().filter_map(|name| Some((name.clone(), place(name)?))).collect());
    }
    let model = Model::read(model, record.law.as_deref(), parameters).ok()?;
    let named = model.names().into_iter().zip(model.places());
    let given = named.filter(|(name, _)| parameters.contains_key(name.as_ref()));
    Some(given.map(|(name, place)| (name.into_owned(), place)).collect())
}

/// What is known of one parameter.
#[derive(Debug, Clone, Default)]
struct Known {
    /// Its value in the unit of the page.
    value: Option<String>,
    open: bool,
    interval: Option<String>,
}

impl Known {
    fn of(candidate: &CandidateResult, name: &str) -> Self {
        let record = &candidate.record;
        let shown = ShownParameter::of(record, name);
        let value = Some(shown.value);
        if let Some(doubt) = candidate.doubt(name) {
            return Self { value, open: true, interval: Some(doubt.to_owned()) };
        }
        let open = record.certainty(name) == Some(Certainty::OrderOfMagnitude);
        let is_zero = record.parameters.get(name) == Some(&0.0);
        let on_bound = record.fit.as_ref().is_some_and(|fit| fit.active_bounds.iter().any(|bound| bound == name));
        if on_bound && !open {
            return Self { value, open, interval: Some("physical limit".to_owned()) };
        }
        let interval = shown.ends.map(|ends| match ends {
            [_, Some(high)] if is_zero => format!("at most {high}"),
            [Some(low), Some(high)] => words::between(&low, &high),
            [Some(low), None] => format!("above {low}"),
            [None, Some(high)] => format!("below {high}"),
            [None, None] => "open".to_owned(),
        });
        Self { value, open, interval }
    }
}

/// `k2`; `k` where there is one mass.
fn numbered(symbol: &str, index: usize, alone: bool) -> String {
    if alone { symbol.to_owned() } else { format!("{symbol}{}", index + 1) }
}

fn element(
    candidate: &CandidateResult,
    structure: &Structure,
    owners: &BTreeMap<String, Place>,
    at: usize,
) -> ElementPart {
    let record = &candidate.record;
    let connection = &structure.connections()[at];
    let node = |node: Node| match node {
        Node::Wall => None,
        Node::Mass(i) => Some(i),
    };
    let (front, rear) = (node(connection.front), node(connection.rear));
    let is_own = |place: &Place| matches!(place, Place::Element { connection, .. } if *connection == at);
    let is_in = |place: &Place| match (place, &connection.element) {
        // A parameter of an own model stands wherever its law names it.
        (Place::Law(parameter), Element::OwnForce(own)) => own.has_parameter(*parameter),
        (place, _) => is_own(place),
    };
    let own: Vec<&str> = owners.iter().filter(|(_, place)| is_in(place)).map(|(name, _)| name.as_str()).collect();
    let asked: Vec<&str> = record.asked().filter(|name| own.contains(name)).collect();
    let known: BTreeMap<&str, Known> = own.iter().map(|name| (*name, Known::of(candidate, name))).collect();
    let open = asked.iter().filter(|name| known[*name].open).count();
    let of_kind = |kind: ParameterKind| -> Vec<&str> {
        own.iter().copied().filter(|name| parameter_kind(&record.model, name) == Some(kind)).collect()
    };
    let alone = structure.masses_kg().len() == 1;
    let symbol = |letter: &str| match (front, rear) {
        // The path past the masses in front is none of theirs.
        (None, Some(rear)) if rear > 0 => format!("{letter}{}", "∥"),
        (_, rear) => numbered(letter, rear.unwrap_or_default(), alone),
    };
    let mut lines = Vec::new();
    let mut value = |symbol: &str, name: &str, may_be_open: bool| {
        let ShownParameter { value, unit, .. } = ShownParameter::of(record, name);
        let doubt = if may_be_open && known[name].open { " ?" } else { "" };
        lines.push(format!("{symbol} {value} {unit}{doubt}"));
        lines.extend(known[name].interval.clone());
    };
    let (glyph, letter) = match &connection.element {
        Element::Spring(law) => {
            let knots: Vec<(f64, f64)> = law.0.points().collect();
            match of_kind(ParameterKind::Stiffness)[..] {
                [name] => {
                    value(&symbol("k"), name, true);
                    (Glyph::Spring, "k")
                }
                _ => {
                    lines.extend(range_of_knots(&symbol("k"), &knots, "kN/m", (open, asked.len())));
                    (Glyph::Curve(secant_curve(&knots)), "k")
                }
            }
        }
        Element::Damper(law) => match of_kind(ParameterKind::Damping)[..] {
            [name] => {
                value(&symbol("c"), name, true);
                (Glyph::Damper, "c")
            }
            _ => {
                let knots: Vec<(f64, f64)> = law.0.points().collect();
                lines.extend(range_of_knots(&symbol("c"), &knots, "kN·s/m", (open, asked.len())));
                (Glyph::Damper, "c")
            }
        },
        Element::SeriesSpringDamper(_) => {
            of_kind(ParameterKind::Stiffness).iter().for_each(|name| value("k", name, true));
            of_kind(ParameterKind::Damping).iter().for_each(|name| value("c", name, true));
            (Glyph::SpringAndDamper, "k, c")
        }
        Element::PlasticSpring(spring) => {
            for (words, name) in
                [("loading", "loading_stiffness_n_per_m"), ("unloading", "unloading_stiffness_n_per_m")]
            {
                if known.contains_key(name) {
                    value(words, name, true);
                }
            }
            let back = spring.loading_stiffness_n_per_m / spring.unloading_stiffness_n_per_m;
            (Glyph::Curve(vec![(0.0, 0.0), (1.0, 1.0), ((1.0 - back).clamp(0.0, 1.0), 0.0)]), "k")
        }
        Element::OwnForce(force) => {
            own.iter().for_each(|name| value(&ShownParameter::of(record, name).symbol, name, true));
            let curve = match force.unloading_n_per_m(1.0) {
                Some(_) => vec![(0.0, 0.0), (1.0, 1.0), (0.9, 0.0)],
                None => vec![(0.0, 0.0), (1.0, 1.0)],
            };
            (Glyph::Curve(curve), "F")
        }
        Element::ForceDeflection(curve) => {
            lines.extend(words_of_curve(&symbol("F"), curve.knots(), &known, (open, asked.len())));
            (Glyph::Curve(crushed_curve(curve.knots(), curve.unloading_n_per_m())), "F")
        }
    };
    // Of several numbers most.
    ElementPart { front, rear, glyph, symbol: symbol(letter), lines, open: 2 * open > asked.len() }
}

/// `F up to 656 kN at 750 mm`, the interval of that force, how many of the knots are open.
fn words_of_curve(
    symbol: &str,
    knots: &[(f64, f64)],
    known: &BTreeMap<&str, Known>,
    (open, asked): (usize, usize),
) -> Vec<String> {
    let mut lines = Vec::new();
    let largest = knots.iter().enumerate().max_by(|a, b| a.1.1.total_cmp(&b.1.1));
    if let Some((index, (deflection, force))) = largest {
        let at_knot = format!("knot{index}_n");
        let known = known.iter().find(|(name, _)| name.ends_with(at_knot.as_str())).map(|(_, known)| known);
        let doubt = if known.is_some_and(|known| known.open) { " ?" } else { "" };
        let force = known
            .and_then(|known| known.value.clone())
            .unwrap_or_else(|| words::significant(factor_shown("kN") * KILO * force, 3));
        let deflection = words::significant_quantity(1e3 * deflection, 3, "mm").replace(NBSP, " ");
        lines.push(format!("{symbol} up to {force} {} at {deflection}{doubt}", unit_shown("kN")));
        lines.extend(known.and_then(|known| known.interval.clone()));
    }
    let count = knots.len().saturating_sub(1);
    lines.push(match asked {
        0 => format!("{count} knots"),
        asked => knots_determined(count, (open, asked)),
    });
    lines
}

fn knots_determined(count: usize, (open, asked): (usize, usize)) -> String {
    format!("{count} knots, {} of {asked} determined", asked - open)
}

/// `k 0 to 643 kN/m`, and how many of its numbers are open.
fn range_of_knots(symbol: &str, knots: &[(f64, f64)], unit: &str, (open, asked): (usize, usize)) -> Vec<String> {
    let values = knots.iter().map(|(_, value)| factor_shown(unit) * KILO * value);
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    let doubt = if open > 0 { " ?" } else { "" };
    let [low, high] = [low, high].map(|end| words::significant(end, 3));
    let mut lines = vec![format!("{symbol} {} {}{doubt}", words::between(&low, &high), unit_shown(unit))];
    if asked > 0 {
        lines.push(knots_determined(knots.len(), (open, asked)));
    }
    lines
}

/// Force over compression of a secant spring, in shares of its largest.
fn secant_curve(knots: &[(f64, f64)]) -> Vec<(f64, f64)> {
    const POINTS: u32 = 24;
    let last = knots.last().map_or(0.0, |knot| knot.0);
    let stiffness = |u: f64| {
        let above = knots.iter().position(|knot| knot.0 >= u).unwrap_or(knots.len() - 1);
        match above.checked_sub(1).map(|below| (knots[below], knots[above])) {
            Some(((a, ka), (b, kb))) if b > a => ka + (kb - ka) * (u - a) / (b - a),
            _ => knots[above].1,
        }
    };
    let points = (0..=POINTS).map(|k| last * f64::from(k) / f64::from(POINTS)).map(|u| (u, stiffness(u) * u));
    in_shares(points.collect())
}

/// Loading to the last knot, then back along the unloading stiffness.
fn crushed_curve(knots: &[(f64, f64)], unloading_n_per_m: f64) -> Vec<(f64, f64)> {
    let mut points = knots.to_vec();
    points.extend(knots.last().map(|(deflection, force)| ((deflection - force / unloading_n_per_m).max(0.0), 0.0)));
    in_shares(points)
}

fn in_shares(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let (right, top) = points.iter().fold((0.0, 0.0), |(x, y), point| (f64::max(x, point.0), f64::max(y, point.1)));
    let share = |value: f64, of: f64| if of > 0.0 { (value / of).clamp(0.0, 1.0) } else { 0.0 };
    points.into_iter().map(|(x, y)| (share(x, right), share(y, top))).collect()
}
