//! Names as people write them, and text made safe for Markdown.

use crumple_artifact::records::CandidateV1;
use crumple_lumped::{ParameterKind, parameter_kind, parameter_kind_of_unit};
use crumple_signal::display;

use crate::drawing::numbers::{KILO, MILLI};
use crate::words;

// Text of a test made safe for Markdown.

/// What such a file begins with, by which it is known.
pub const HEAD: &str = concat!("<!-- crumple-report ", env!("CARGO_PKG_VERSION"), " -->\n");

/// Text of one line: what Markdown or HTML could take for a mark gets a backslash.
pub fn markdown(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '#' | '|' | '~' | '&' | '!' => out.extend(['\\', c]),
            // A mention is found in what is shown, where the backslash is gone: only what stands behind it ends it.
            '@' => out.push_str("\\@\u{200b}"),
            '\n' | '\r' => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

// Names as people write them: of inputs and outputs.

/// An input or output as identify names it (`acceleration of channel 93, m/s^2`): the words and the unit, if it has
/// one.
pub fn words_and_unit(text: &str) -> (&str, Option<String>) {
    let text = text.trim();
    let (words, unit) = match text.rsplit_once(", ") {
        Some((words, unit)) => (words, Some(unit)),
        None => (text, None),
    };
    let unit = unit.filter(|unit| !["", "1"].contains(unit)).map(|unit| unit.replace("^2", "²").replace('*', "·"));
    (words.strip_prefix("other ").unwrap_or(words), unit)
}

/// A name or a reason at the start of a sentence, a line or a cell.
pub fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// A reason as a sentence.
pub(crate) fn as_sentence(reason: &str) -> String {
    format!("{}.", capitalised(reason))
}

// Parameters of candidates as people read them: order, symbol, unit.

/// How the deflection of a knot is shown: factor, digits after the point, unit.
pub const DEFLECTION: (f64, usize, &str) = (MILLI, 0, "mm");

/// Masses, then stiffnesses, then dampings, then the rest, each by name: the order people write them in.
pub fn parameter_order<'a>(model: &str, name: &'a str) -> (usize, &'a str) {
    let place = match parameter_kind(model, name) {
        Some(ParameterKind::Mass) => 0,
        Some(ParameterKind::Stiffness) => 1,
        Some(ParameterKind::Damping) => 2,
        Some(
            ParameterKind::Length
            | ParameterKind::Rate
            | ParameterKind::Force
            | ParameterKind::RateFactor
            | ParameterKind::Other,
        )
        | None => 3,
    };
    (place, name)
}

/// Symbol of a parameter of a model, its value in the unit of the page, and that unit.
///
/// `stiffness_n_per_m` gives `("k", value/1000, "kN/m")`. A number that is no parameter of the model, such as the crush
/// of a repetition, has the unit that docs/format.md asks every name to end with; a name without one stays as it is.
pub fn parameter(model: &str, name: &str, value: f64) -> (String, f64, &'static str) {
    let kind = parameter_kind(model, name).map(|kind| (kind.symbol_of(name), of_kind(kind)));
    match kind.or_else(|| of_unit(name)) {
        Some((symbol, (factor, unit))) => {
            let (factor, _, unit) = display::shown((factor, 0, unit));
            (in_words(symbol), value * factor, unit)
        }
        None => (name.replace('_', " "), value, ""),
    }
}

/// Factor to the unit of the page, and that unit.
fn of_kind(kind: ParameterKind) -> (f64, &'static str) {
    match kind {
        ParameterKind::Mass => (1.0, "kg"),
        ParameterKind::Stiffness => (KILO, "kN/m"),
        ParameterKind::Damping => (KILO, "kN·s/m"),
        ParameterKind::Length => (MILLI, "mm"),
        ParameterKind::Rate => (1.0, "m/s"),
        ParameterKind::Force => (KILO, "kN"),
        ParameterKind::RateFactor => (1.0, "s/m"),
        ParameterKind::Other => (1.0, ""),
    }
}

/// A name without the unit it ends with, the factor to the unit of the page, and that unit.
fn of_unit(name: &str) -> Option<(&str, (f64, &'static str))> {
    const UNITS: [(&str, f64, &str); 4] =
        [("_rad_per_s", 1.0, "rad/s"), ("_hz", 1.0, "Hz"), ("_n", KILO, "kN"), ("_s", MILLI, "ms")];
    let known = parameter_kind_of_unit(name).map(|kind| (kind.symbol_of(name), of_kind(kind)));
    known.or_else(|| UNITS.iter().find_map(|(end, factor, unit)| Some((name.strip_suffix(end)?, (*factor, *unit)))))
}

/// `k` for a stiffness, else the symbol with blanks.
fn in_words(symbol: &str) -> String {
    match symbol {
        "mass" => "m".to_owned(),
        "stiffness" => "k".to_owned(),
        "damping" => "c".to_owned(),
        "loading_stiffness" => "k loading".to_owned(),
        "unloading_stiffness" => "k unloading".to_owned(),
        other => other.replace('_', " "),
    }
}

/// Name and value, m, of the deflection of the knot of a force-deflection curve that has this force; `None` where the
/// model has several curves, whose knots do not say of which they are.
pub fn deflection_of_knot(candidate: &CandidateV1, force: &str) -> Option<(String, f64)> {
    let is_knot = force.starts_with("knot") && parameter_kind(&candidate.model, force) == Some(ParameterKind::Force);
    let name = format!("{}_m", force.strip_suffix("_n").filter(|_| is_knot)?);
    candidate.parameters.get(&name).map(|deflection_m| (name.clone(), *deflection_m))
}

/// `k and c` of a candidate; of knots of a force-deflection curve `the forces at 97 mm and 283 mm`.
pub fn symbols(candidate: &CandidateV1, names: &[&str]) -> String {
    let (mut deflections, mut symbols) = (Vec::new(), Vec::new());
    for name in names {
        let (texts, text) = match deflection_of_knot(candidate, name) {
            Some((_, deflection_m)) => {
                let (factor, places, unit) = DEFLECTION;
                (&mut deflections, words::quantity(factor * deflection_m, places, unit))
            }
            None => (&mut symbols, parameter(&candidate.model, name, 0.0).0),
        };
        if !texts.contains(&text) {
            texts.push(text);
        }
    }
    if !deflections.is_empty() {
        let forces = if deflections.len() > 1 { "the forces" } else { "the force" };
        symbols.insert(0, format!("{forces} at {}", listed(&deflections)));
    }
    listed(&symbols)
}

/// `a, b and c`.
pub(crate) fn listed(texts: &[String]) -> String {
    match texts.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, before)) => format!("{} and {last}", before.join(", ")),
        None => String::new(),
    }
}

/// Characters of a digest that are shown.
const DIGEST_SHOWN: usize = 12;

/// The first characters of a digest without its algorithm.
pub fn short(digest: &str) -> &str {
    let hex = digest.split_once(':').map_or(digest, |(_, hex)| hex);
    hex.get(..DIGEST_SHOWN).unwrap_or(hex)
}

/// A record by its file, with the start of its digest.
pub fn record_name(file: &str, digest: &str) -> String {
    match short(digest) {
        "" => file.to_owned(),
        digest => format!("{file} ({digest})"),
    }
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn a_title_cannot_open_a_cell_a_link_or_a_tag() {
        assert_eq!(markdown("@team"), "\\@\u{200b}team");
        assert_eq!(markdown("a|b [x](y)\n<b> *c* d_e"), "a\\|b \\[x\\](y) \\<b\\> \\*c\\* d\\_e");
    }

    #[test]
    fn a_name_starts_with_a_capital_where_a_line_starts() {
        assert_eq!(capitalised("elastoplastic spring"), "Elastoplastic spring");
        assert_eq!(capitalised(""), "");
        assert_eq!(as_sentence("no mass is stated"), "No mass is stated.");
    }

    #[test]
    fn a_quantity_that_is_not_known_has_no_unit() {
        assert_eq!(words_and_unit("other column_2, 1"), ("column_2", None));
        let (words, unit) = words_and_unit("acceleration of channel 93, m/s^2");
        assert_eq!((words, unit.as_deref()), ("acceleration of channel 93", Some("m/s²")));
    }

    #[test]
    fn parameters_are_in_the_units_of_the_trade() {
        assert_eq!(parameter("kelvin", "stiffness_n_per_m", 322_000.0), ("k".to_owned(), 322.0, "kN/m"));
        assert_eq!(parameter("nonlinear-1", "c2_n_s_per_m", 20_000.0), ("c2".to_owned(), 20.0, "kN·s/m"));
        assert_eq!(parameter("nonlinear-1", "v_thresh_m_per_s", 2.0), ("v thresh".to_owned(), 2.0, "m/s"));
        assert_eq!(parameter("nonlinear-2", "x1_m", 0.25), ("x1".to_owned(), 250.0, "mm"));
        assert_eq!(parameter("kelvin", "dynamic_crush_m", 0.25), ("dynamic crush".to_owned(), 250.0, "mm"));
        assert_eq!(parameter("of another program", "turn_rad_per_s", 2.0), ("turn".to_owned(), 2.0, "rad/s"));
        assert_eq!(parameter("kelvin", "seed", 7.0), ("seed".to_owned(), 7.0, ""));
        let mut names = ["c1_n_s_per_m", "k1_n_per_m", "m2_kg", "x1_m", "m1_kg"];
        names.sort_by_key(|name| parameter_order("double-spring-mass-damper", name));
        assert_eq!(names, ["m1_kg", "m2_kg", "k1_n_per_m", "c1_n_s_per_m", "x1_m"]);
    }
}
