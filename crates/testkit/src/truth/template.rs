//! Templates of sentences as matchers: the words are looked for in a text, what stands in the places is taken.

use std::collections::BTreeMap;

use crate::truth::run::{Shown, numbers, plain};

/// What may stand in a place of a template.
#[derive(Debug, Clone, Copy)]
pub enum Place {
    /// Words that nothing more is asked of: a name, a list of names.
    Words,
    /// Words, or nothing.
    Rest,
    /// A number with its unit.
    Number,
    /// A number with its unit, that of the summary at this JSON pointer.
    At(&'static str),
    /// What one of these templates says, or nothing.
    Said(&'static [&'static str]),
}

#[derive(Debug, Clone, PartialEq)]
enum Piece {
    Words(String),
    Place(String),
}

/// A text with `{places}`.
#[derive(Debug, Clone)]
pub struct Template {
    /// `subject.name`.
    pub name: String,
    pieces: Vec<Piece>,
}

impl Template {
    /// Of a text as it stands in `phrases`, tags of HTML left out.
    pub fn new(name: String, text: &str) -> Self {
        let text = without_tags(text);
        let mut pieces = Vec::new();
        let mut rest = text.as_str();
        while let Some((before, behind)) = rest.split_once('{') {
            let (place, behind) = behind.split_once('}').unwrap_or((behind, ""));
            pieces.push(Piece::Words(blanks(before)));
            pieces.push(Piece::Place(place.to_owned()));
            rest = behind;
        }
        pieces.push(Piece::Words(blanks(rest)));
        pieces.retain(|piece| *piece != Piece::Words(String::new()));
        Self { name, pieces }
    }

    /// Letters and digits of its words: what makes it more particular than another.
    pub fn length(&self) -> usize {
        let words = |piece: &Piece| match piece {
            Piece::Words(words) => words.chars().filter(|c| c.is_alphanumeric()).count(),
            Piece::Place(_) => 0,
        };
        self.pieces.iter().map(words).sum()
    }
}

/// What a text says by a template.
#[derive(Debug, Clone)]
pub struct Said {
    /// The template, `subject.name`.
    pub template: String,
    /// What stands in its places.
    pub places: BTreeMap<String, Filled>,
}

/// What stands in a place.
#[derive(Debug, Clone)]
pub struct Filled {
    /// The text.
    pub text: String,
    /// By which template it was made, where it was.
    pub said: Option<Said>,
}

impl Said {
    /// The text in a place; empty without one.
    pub fn text(&self, place: &str) -> &str {
        self.places.get(place).map_or("", |filled| filled.text.as_str())
    }

    /// The number in a place; a lower end without a unit has that of the upper end.
    pub fn number(&self, place: &str) -> Option<Shown> {
        let end = match place {
            "low" => self.text("high"),
            "lowest" => self.text("highest"),
            _ => "",
        };
        numbers(&format!("{} to {end}", self.text(place))).into_iter().next()
    }

    /// The numbers in these places as they are written; NaN without one.
    pub fn values<const N: usize>(&self, places: [&str; N]) -> [f64; N] {
        places.map(|place| self.number(place).map_or(f64::NAN, |shown| shown.value))
    }

    /// What is said in a place.
    pub fn inner(&self, place: &str) -> Option<&Self> {
        self.places.get(place)?.said.as_ref()
    }

    fn has_words_of_a_sentence(&self) -> bool {
        self.places.values().any(|filled| filled.said.is_none() && filled.text.contains(". "))
    }

    /// This and all that is said in its places.
    pub fn all(&self) -> Vec<&Self> {
        let inner = self.places.values().filter_map(|filled| filled.said.as_ref());
        std::iter::once(self).chain(inner.flat_map(Self::all)).collect()
    }
}

/// Templates, and what may stand in their places.
#[derive(Debug, Default)]
pub struct Grammar {
    templates: BTreeMap<String, Template>,
    places: BTreeMap<(String, String), Place>,
}

/// How often a search for the places of one text may turn back.
const MOST_STEPS: usize = 200_000;

impl Grammar {
    /// Takes a template with its places; a place that is not named takes words.
    pub fn add(&mut self, template: Template, places: &[(&str, Place)]) {
        for (place, kind) in places {
            self.places.insert((template.name.clone(), (*place).to_owned()), *kind);
        }
        self.templates.insert(template.name.clone(), template);
    }

    /// The text as sentences of these templates, one after the other; `None` where words are left.
    pub fn read(&self, text: &str, templates: &[&str]) -> Option<Vec<Said>> {
        let text = plain(text);
        let mut order: Vec<&Template> = templates.iter().filter_map(|name| self.templates.get(*name)).collect();
        order.sort_by_key(|template| std::cmp::Reverse(template.length()));
        let mut steps = MOST_STEPS;
        self.sentences(&text, &order, &mut steps)
    }

    fn sentences(&self, text: &str, order: &[&Template], steps: &mut usize) -> Option<Vec<Said>> {
        let text = text.trim_start();
        if text.is_empty() {
            return Some(Vec::new());
        }
        for template in order {
            let mut ends = self.matches(template, text, steps);
            // The whole text before a part of it; of those, short words in the first places.
            ends.retain(|(_, end)| *end > 0);
            // Where a template ends a sentence itself, words that end one belong to a place only if nothing else reads
            // the text.
            let ends_itself = matches!(template.pieces.last(), Some(Piece::Words(words)) if words.ends_with('.'));
            let sentences = |said: &Said| ends_itself && said.all().iter().any(|said| said.has_words_of_a_sentence());
            ends.sort_by_key(|(said, end)| (sentences(said), std::cmp::Reverse(*end)));
            for (said, end) in ends {
                if let Some(mut more) = self.sentences(&text[end..], order, steps) {
                    more.insert(0, said);
                    return Some(more);
                }
            }
        }
        None
    }

    /// The ways in which a template begins a text, each with its end.
    fn matches(&self, template: &Template, text: &str, steps: &mut usize) -> Vec<(Said, usize)> {
        let mut ways = Vec::new();
        let start = Said { template: template.name.clone(), places: BTreeMap::new() };
        self.pieces(&template.pieces, text, 0, start, &mut ways, steps);
        ways
    }

    fn pieces(
        &self,
        pieces: &[Piece],
        text: &str,
        at: usize,
        said: Said,
        ways: &mut Vec<(Said, usize)>,
        steps: &mut usize,
    ) {
        *steps = steps.saturating_sub(1);
        if *steps == 0 {
            return;
        }
        let rest = &text[at..];
        match pieces {
            [] => ways.push((said, at)),
            [Piece::Words(words), more @ ..] => {
                // Blanks at the start of a template that stands first are those between sentences.
                let words = if at == 0 { words.trim_start() } else { words };
                let words = if more.is_empty() && rest.len() < words.len() { words.trim_end() } else { words };
                if rest.starts_with(words) {
                    self.pieces(more, text, at + words.len(), said, ways, steps);
                }
            }
            [Piece::Place(place), more @ ..] => {
                let kind = self.places.get(&(said.template.clone(), place.clone())).copied().unwrap_or(Place::Rest);
                for (filled, length) in self.fillings(kind, rest, more, steps) {
                    // A sentence begins with a name, not with another sentence.
                    if at == 0 && said.places.is_empty() && filled.said.is_none() && filled.text.contains(". ") {
                        continue;
                    }
                    let mut said = said.clone();
                    said.places.insert(place.clone(), filled);
                    self.pieces(more, text, at + length, said, ways, steps);
                }
            }
        }
    }

    /// What may stand in a place at the start of a text, shortest first, each with its length.
    fn fillings(&self, kind: Place, rest: &str, more: &[Piece], steps: &mut usize) -> Vec<(Filled, usize)> {
        let plain = |length: usize| (Filled { text: rest[..length].to_owned(), said: None }, length);
        match kind {
            Place::Number | Place::At(_) => number_length(rest).into_iter().flatten().map(plain).collect(),
            Place::Words | Place::Rest => {
                let next = more.iter().find_map(|piece| match piece {
                    Piece::Words(words) => Some(words.trim_end()),
                    Piece::Place(_) => None,
                });
                let follows = matches!(more.first(), Some(Piece::Words(_)));
                let least = if matches!(kind, Place::Rest) { 0 } else { 1 };
                let ends = rest.char_indices().map(|(at, _)| at).chain([rest.len()]).filter(|end| *end >= least);
                let fits = |end: &usize| match next {
                    Some(words) if follows => rest[*end..].starts_with(words),
                    _ => true,
                };
                ends.filter(fits).map(plain).collect()
            }
            Place::Said(names) => {
                let mut ways: Vec<(Filled, usize)> = Vec::new();
                for template in names.iter().filter_map(|name| self.templates.get(*name)) {
                    // A text that goes on keeps its blank.
                    let mut own = Vec::new();
                    let start = Said { template: template.name.clone(), places: BTreeMap::new() };
                    self.inside(&template.pieces, rest, start, &mut own, steps);
                    let with_text =
                        |(said, end): (Said, usize)| (Filled { text: rest[..end].to_owned(), said: Some(said) }, end);
                    ways.extend(own.into_iter().map(with_text));
                }
                ways.push(plain(0));
                ways
            }
        }
    }

    /// As [`Self::pieces`] from the start of a text within a sentence, where blanks count.
    fn inside(&self, pieces: &[Piece], text: &str, said: Said, ways: &mut Vec<(Said, usize)>, steps: &mut usize) {
        match pieces {
            [Piece::Words(words), more @ ..] => {
                if text.starts_with(words.as_str()) {
                    self.pieces(more, text, words.len(), said, ways, steps);
                }
            }
            _ => self.pieces(pieces, text, 0, said, ways, steps),
        }
    }
}

/// Lengths of the number at the start of a text: with its unit, without it.
fn number_length(text: &str) -> Option<Vec<usize>> {
    let sign = text.starts_with(['-', '+']) as usize;
    let digits = text[sign..].find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len() - sign);
    let end = sign + text[sign..sign + digits].trim_end_matches('.').len();
    if end == sign {
        return None;
    }
    let unit =
        text[end..].strip_prefix(' ').map(|unit| unit.find([' ', ',', ';', ':', ')', '.']).unwrap_or(unit.len()));
    let units = ["mm", "ms", "km/h", "g", "kN·s/m", "kN/m", "kN", "kJ", "kg", "m/s²", "m/s^2", "m/s", "%", "Hz", "s"];
    let with_unit = unit.map(|length| end + 1 + length).filter(|all| units.contains(&&text[end + 1..*all]));
    Some(with_unit.into_iter().chain([end]).collect())
}

/// Blanks of one kind; those at both ends stay.
fn blanks(text: &str) -> String {
    let (start, end) = (text.starts_with(char::is_whitespace), text.ends_with(char::is_whitespace));
    let inner = plain(text);
    match inner.is_empty() {
        true if start => " ".to_owned(),
        true => inner,
        false => format!("{}{inner}{}", if start { " " } else { "" }, if end { " " } else { "" }),
    }
}

/// The text of HTML: no tags, characters for their names.
pub fn without_tags(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, behind)) = rest.split_once('<') {
        out.push_str(before);
        match behind.split_once('>') {
            Some((tag, behind)) if starts_a_tag(rest, before.len()) => {
                // A line ends there.
                if tag == "br" {
                    out.push(' ');
                }
                rest = behind;
            }
            _ => {
                out.push('<');
                rest = behind;
            }
        }
    }
    out.push_str(rest);
    let names = [("&nbsp;", " "), ("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&#39;", "'"), ("&amp;", "&")];
    names.iter().fold(out, |out, (name, character)| out.replace(name, character))
}

fn starts_a_tag(text: &str, at: usize) -> bool {
    text[at + 1..].starts_with(|c: char| c.is_ascii_alphabetic() || c == '/')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grammar() -> Grammar {
        let mut grammar = Grammar::default();
        let crushed = "It was crushed by {crush}{interval} at {speed}{more}.";
        let places = [
            ("crush", Place::Number),
            ("interval", Place::Said(&["t.interval"])),
            ("speed", Place::Number),
            ("more", Place::Said(&["t.more"])),
        ];
        grammar.add(Template::new("t.crushed".into(), crushed), &places);
        let ends = [("low", Place::Number), ("high", Place::Number)];
        grammar.add(Template::new("t.interval".into(), " ({low} to {high})"), &ends);
        grammar.add(Template::new("t.more".into(), " and {what} too"), &[]);
        grammar.add(Template::new("t.use".into(), "Use <b>{model}</b>: {why}."), &[]);
        grammar
    }

    #[test]
    fn a_text_is_read_by_the_templates_that_made_it() {
        let text =
            "It was crushed by 749.9\u{a0}mm (740 to 759\u{a0}mm) at 56 km/h and more too. Use Kelvin: it is. so.";
        let read = grammar().read(text, &["t.use", "t.crushed"]).unwrap();
        assert_eq!(read.len(), 2);
        assert_eq!(read[0].number("crush").unwrap().si(), 0.7499);
        assert_eq!(read[0].inner("interval").unwrap().text("high"), "759 mm");
        assert_eq!(read[0].inner("more").unwrap().text("what"), "more");
        assert_eq!((read[1].text("model"), read[1].text("why")), ("Kelvin", "it is. so"));
        assert_eq!(read[0].all().len(), 3);
    }

    #[test]
    fn what_no_template_says_is_not_read() {
        let all = ["t.use", "t.crushed"];
        for text in ["It was crushed by much at 56 km/h.", "Use Kelvin: it is so. And more"] {
            assert!(grammar().read(text, &all).is_none(), "{text}");
        }
    }
}
