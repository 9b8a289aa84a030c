//! The texts of the first screen of a report, from its HTML.

use super::shown::plain;
use super::template::without_tags;

/// A piece of text of a page.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// The section it stands in: `verdict`, `before-use`, `model`, `numbers`, `header`, ...
    pub section: String,
    /// Its element: `p`, `li`, `dt`, ...
    pub element: String,
    /// The key of the card, or the class of the element.
    pub key: String,
    /// The text.
    pub text: String,
}

/// Elements whose text is a piece by itself.
const PIECES: [&str; 14] =
    ["h1", "h2", "h3", "h4", "p", "li", "dt", "dd", "figcaption", "caption", "th", "td", "strong-status", "summary"];

/// From the header to what lies below the answer: the figures.
pub fn first_screen(html: &str) -> Vec<Block> {
    let body = html.split_once("<header>").map_or(html, |(_, rest)| rest);
    let end = [
        "<section id=\"figures\"",
        "<figure class=\"figure",
        "id=\"crash\"",
        "class=\"figure",
        "id=\"models\"",
        "id=\"identification\"",
    ];
    let end = end.iter().filter_map(|mark| body.find(mark)).min().unwrap_or(body.len());
    pieces(&body[..end])
}

/// The captions of all figures.
pub fn captions(html: &str) -> String {
    let all = pieces(html).into_iter().filter(|block| block.element == "figcaption" || block.key.contains("caption"));
    all.map(|block| block.text).collect::<Vec<_>>().join(" ")
}

fn pieces(html: &str) -> Vec<Block> {
    let (mut section, mut card) = ("header".to_owned(), String::new());
    let mut blocks = Vec::new();
    let mut rest = html;
    while let Some((_, behind)) = rest.split_once('<') {
        let Some((tag, inside)) = behind.split_once('>') else { break };
        rest = inside;
        let name = tag.split([' ', '\n']).next().unwrap_or_default();
        match name {
            "svg" | "script" | "style" => {
                rest = inside.split_once(&format!("</{name}>")).map_or("", |(_, behind)| behind);
            }
            "section" => section = attribute(tag, "id").or(attribute(tag, "class")).unwrap_or_default(),
            "div" if tag.contains("data-key") => card = attribute(tag, "data-key").unwrap_or_default(),
            _ if PIECES.contains(&name) => {
                let (text, behind) = inside.split_once(&format!("</{name}>")).unwrap_or((inside, ""));
                rest = behind;
                let key = if section == "numbers" { card.clone() } else { attribute(tag, "class").unwrap_or_default() };
                let text = plain(&without_tags(text));
                if !text.is_empty() {
                    blocks.push(Block { section: section.clone(), element: name.to_owned(), key, text });
                }
            }
            _ => {}
        }
    }
    blocks
}

fn attribute(tag: &str, name: &str) -> Option<String> {
    let (_, value) = tag.split_once(&format!("{name}=\""))?;
    value.split_once('"').map(|(value, _)| value.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_stand_in_their_sections() {
        let html = "<header>\n<h1>A &amp; B</h1><section class=\"verdict none\"><p>It was <b>so</b>.</p></section>\
                    <section id=\"numbers\"><div class=\"card\" data-key=\"olc\"><dt>OLC</dt><dd>29.3 <small>g\
                    </small></dd></div></section><svg><text>no</text></svg><figure class=\"figure\"><p>below</p>";
        let texts: Vec<(String, String, String)> =
            first_screen(html).into_iter().map(|b| (b.section, b.key, b.text)).collect();
        let expected = [
            ("header", "", "A & B"),
            ("verdict none", "", "It was so."),
            ("numbers", "olc", "OLC"),
            ("numbers", "olc", "29.3 g"),
        ];
        assert_eq!(texts, expected.map(|(a, b, c)| (a.to_owned(), b.to_owned(), c.to_owned())));
    }
}
