//! What is around every page: head, style, script, and what the browser may load.

use crate::drawing::escape::{address, html, json_in_script};
use crate::drawing::page_rules;
use crate::phrases::PHRASES;
use crate::phrases::words::fill;
use serde::Serialize;

use crate::frame::page_files::{PageFiles, Script, compact, style_of_all};

/// Cursor, zoom and downloads of figures.
pub(crate) const FIGURES: &str = include_str!("../page/figures.js");

/// What the browser may load: what is in the file. It keeps the promise of a report without a network, whatever the
/// text of a test may ask for.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
                      font-src data:; base-uri 'none'; form-action 'none'";

/// The same for a page whose style and scripts lie beside it.
const POLICY_BESIDE: &str = "default-src 'none'; script-src 'unsafe-inline' 'self' file:; \
                             style-src 'unsafe-inline' 'self' file:; img-src data: blob:; font-src data:; \
                             base-uri 'none'; form-action 'none'";

/// A page of this title. `style` is put after the style of all pages, `script` at the end.
pub(crate) fn framed(title: &str, style: &str, body: &str, script: &str) -> String {
    let style = format!("<style>\n{}</style>\n", compact(&[&style_of_all(), style].concat()));
    let script = format!("<script>\n{}</script>\n", compact(script));
    head_and_body(title, (POLICY, &style), body, &script)
}

/// A page with what stands in its own style alone, `more`, and style and scripts of [`PageFiles`].
pub(crate) fn framed_with(files: &PageFiles, title: &str, more: &str, body: &str, script: Script) -> String {
    match files.folder() {
        None => framed(title, &[files.style, more].concat(), body, script.text),
        Some(folder) => {
            let own = files.style_file();
            let style = format!(
                "<link rel=\"stylesheet\" href=\"{}\">\n<style>\n{}</style>\n",
                address(&format!("{folder}/{}", own.name)),
                compact(more)
            );
            let missing = fill(PHRASES.fleet.without_files, &[("folder", html(folder))]);
            let body = format!("<p class=\"beside\">{missing}</p>\n{body}");
            head_and_body(title, (POLICY_BESIDE, &style), &body, &files.script(script))
        }
    }
}

fn head_and_body(title: &str, head: (&str, &str), body: &str, script: &str) -> String {
    let (policy, style) = head;
    let mut page = String::with_capacity(body.len() + 100_000);
    page.push_str(&format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"generator\" content=\"crumple-report {}\">\n<title>{} – Crumple</title>\n\
         {style}<style id=\"figure-style\">\n{}</style>\n</head>\n<body>\n",
        env!("CARGO_PKG_VERSION"),
        html(title),
        page_rules()
    ));
    page.push_str(&reachable(body));
    page.push_str(script);
    page.push_str("</body>\n</html>\n");
    page
}

/// The texts of the script of figures, as it reads them.
pub(crate) fn words_of_figures() -> String {
    json_element("figure-words", &PHRASES.cursor)
}

/// Data for a script of the page.
pub(crate) fn json_element(id: &str, data: &impl Serialize) -> String {
    // Texts and numbers become JSON, whatever is in them.
    let json = serde_json::to_string(data).unwrap_or_default();
    format!("<script type=\"application/json\" id=\"{id}\">{}</script>\n", json_in_script(&json))
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
}
