//! What is around every page: head, style, script, and what the browser may load.

use crumple_drawing::escape::{html, json_in_script};
use crumple_drawing::{page_rules, palette};
use serde::Serialize;

use crate::text::language::Language;

const STYLE: &str = include_str!("../page/style.css");
/// Cursor, zoom and downloads of figures.
pub(crate) const FIGURES: &str = include_str!("../page/figures.js");

/// What the browser may load: what is in the file. It keeps the promise of a report without a network, whatever the
/// text of a test may ask for.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
                      font-src data:; base-uri 'none'; form-action 'none'";

/// A page of this title. `style` is put after the style of all pages, `script` at the end.
pub(crate) fn framed(language: Language, title: &str, style: &str, body: &str, script: &str) -> String {
    let mut page = String::with_capacity(body.len() + 100_000);
    page.push_str(&format!(
        "<!DOCTYPE html>\n<html lang=\"{}\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"generator\" content=\"crumple-report {}\">\n<title>{} – Crumple</title>\n\
         <style>\n{}</style>\n<style id=\"figure-style\">\n{}</style>\n</head>\n<body>\n",
        language.code(),
        env!("CARGO_PKG_VERSION"),
        html(title),
        compact(&[palette().as_str(), STYLE, style].concat()),
        page_rules()
    ));
    page.push_str(&reachable(body));
    page.push_str(&format!("<script>\n{}</script>\n</body>\n</html>\n", compact(script)));
    page
}

/// The texts of the script of figures, as it reads them.
pub(crate) fn words_of_figures(language: Language) -> String {
    json_element("figure-words", &language.phrases().cursor)
}

/// Data for a script of the page.
pub(crate) fn json_element(id: &str, data: &impl Serialize) -> String {
    // Texts and numbers become JSON, whatever is in them.
    let json = serde_json::to_string(data).unwrap_or_default();
    format!("<script type=\"application/json\" id=\"{id}\">{}</script>\n", json_in_script(&json))
}

/// A script or a style without the indentation of its lines and the lines that are comments: a fleet has hundreds of
/// pages.
pub(crate) fn compact(text: &str) -> String {
    let is_comment = |line: &str| line.starts_with("//") || (line.starts_with("/*") && line.ends_with("*/"));
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !is_comment(line));
    lines.flat_map(|line| [line, "\n"]).collect()
}

/// Definitions that stand in `title` come by tap and key too: what has one can be focused, and the style shows it.
fn reachable(body: &str) -> String {
    // In texts a quotation mark is an entity, so that this is an attribute wherever it stands.
    body.replace(" title=\"", " tabindex=\"0\" title=\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_script_is_small_and_cannot_end_its_element() {
        assert!(!FIGURES.contains("</script") && !FIGURES.contains("<!--"));
        assert!(FIGURES.len() < 20_000, "{}", FIGURES.len());
    }

    #[test]
    fn a_script_and_a_style_lose_indentation_and_lines_of_comments_alone() {
        assert_eq!(compact("/* All. */\na {\n  b: c; /* kept */\n}\n"), "a {\nb: c; /* kept */\n}\n");
        let script = "// Sorts.\nif (a) {\n  // Not this.\n  b('// kept');\n\n}\n";
        assert_eq!(compact(script), "if (a) {\nb('// kept');\n}\n");
    }
}
