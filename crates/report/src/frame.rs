//! What is around every page and every table: head, style, script, what the browser may load, heads of columns.

use crumple_signal::display::unit_shown;
use serde::Serialize;

use crate::drawing::escape::{address, html, json_in_script};
use crate::drawing::{page_rules, palette};

// What is around every page: head, style, script, and what the browser may load.

/// Cursor, zoom and downloads of figures.
pub(crate) const FIGURES: &str = include_str!("page/figures.js");

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
            let body = format!(
                "<p class=\"beside\">The style and the scripts of this page lie in {}, with those of all runs of the \
                 fleet, and were not found there. A page that needs no other file: crumple-report *.mcap -o \
                 report.html in the folder of the run.</p>\n{body}",
                html(folder)
            );
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
    page.push_str(body);
    page.push_str(script);
    page.push_str("</body>\n</html>\n");
    page
}

/// Data for a script of the page.
pub(crate) fn json_element(id: &str, data: &impl Serialize) -> String {
    // Texts and numbers become JSON, whatever is in them.
    let json = serde_json::to_string(data).unwrap_or_default();
    format!("<script type=\"application/json\" id=\"{id}\">{}</script>\n", json_in_script(&json))
}

// Heads of the columns of a table.

/// Head of a column.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Column<'a> {
    text: &'a str,
    unit: &'static str,
    class: &'static str,
    definition: &'a str,
}

impl<'a> Column<'a> {
    /// Over texts.
    pub(crate) const fn text(text: &'a str) -> Self {
        Self { text, unit: "", class: "", definition: "" }
    }

    /// Over numbers, at the right.
    pub(crate) const fn number(text: &'a str) -> Self {
        Self { text, unit: "", class: " class=\"n\"", definition: "" }
    }

    /// With the unit that metric pages have; [`words::cell`](crate::words::cell) shows a number below it.
    pub(crate) const fn of(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// With what it means.
    pub(crate) const fn means(self, definition: &'a str) -> Self {
        Self { definition, ..self }
    }
}

/// Cells of a head. Texts are HTML.
pub(crate) fn heads(columns: &[Column]) -> String {
    let cell = |column: &Column| {
        let Column { text, unit, class, definition } = column;
        let unit = unit_shown(unit);
        let text = match (text.is_empty(), unit.is_empty()) {
            (true, _) => unit.to_owned(),
            (_, true) => (*text).to_owned(),
            _ => format!("{text}, {unit}"),
        };
        match definition.is_empty() {
            true => format!("<th scope=\"col\"{class}>{text}</th>"),
            false => format!("<th scope=\"col\"{class}><abbr tabindex=\"0\" title=\"{definition}\">{text}</abbr></th>"),
        }
    };
    columns.iter().map(cell).collect()
}

/// Words of a caption that stand open: one line of a window.
const OPEN_WORDS: usize = 20;

/// A caption; a long one is folded behind one line, for who asks how to read what stands above.
pub(crate) fn caption(html: &str) -> String {
    if html.split_whitespace().count() <= OPEN_WORDS {
        return format!("<p class=\"caption\">{html}</p>\n");
    }
    format!("<details class=\"caption\"><summary>How to read this</summary>\n<p>{html}</p>\n</details>\n")
}

/// The opening of a table with these columns.
pub(crate) fn table(class: &str, columns: &[Column]) -> String {
    let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
    format!("<div class=\"scroll\"><table{class}>\n<thead><tr>{}</tr></thead>\n<tbody>\n", heads(columns))
}

// Style and scripts of pages: in each page, or in files that many pages share.

const STYLE: &str = include_str!("page/style.css");

/// A script of a page, by the name that a file of it has.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Script {
    pub(crate) name: &'static str,
    pub(crate) text: &'static str,
}

/// A file that pages share. Its name has a digest of its content, so that pages of two versions have each their own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct SharedFile {
    /// Its name in the folder.
    pub(crate) name: String,
    /// What is in it.
    pub(crate) content: String,
}

impl SharedFile {
    fn new(stem: &str, ending: &str, text: &str) -> Self {
        let content = format!("/* crumple-report {} */\n{}", env!("CARGO_PKG_VERSION"), compact(text));
        let digest = blake3::hash(content.as_bytes()).to_hex();
        Self { name: format!("{stem}-{}.{ending}", &digest[..8]), content }
    }
}

/// Where pages of one kind have their style and scripts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PageFiles<'a> {
    /// Style beside that of all pages.
    pub(crate) style: &'a str,
    /// Folder of the files as the page sees it; `None`: they stand in the page, which can be sent to anybody alone.
    pub(crate) folder: Option<&'a str>,
}

impl PageFiles<'_> {
    /// The folder, without a stroke at its end.
    pub(crate) fn folder(&self) -> Option<&str> {
        self.folder.map(|folder| folder.trim_end_matches('/'))
    }

    /// The file of the style. Where it is found, the line on its absence is hidden.
    pub(crate) fn style_file(&self) -> SharedFile {
        SharedFile::new("report", "css", &[&style_of_all(), self.style, ".beside { display: none; }\n"].concat())
    }

    /// The element of a script.
    pub(crate) fn script(&self, script: Script) -> String {
        match self.folder() {
            None => format!("<script>\n{}</script>\n", compact(script.text)),
            Some(folder) => {
                let file = script_file(script);
                format!("<script src=\"{}\"></script>\n", address(&format!("{folder}/{}", file.name)))
            }
        }
    }
}

/// The file of a script.
pub(crate) fn script_file(script: Script) -> SharedFile {
    SharedFile::new(script.name, "js", script.text)
}

/// Style that every page has.
pub(crate) fn style_of_all() -> String {
    [palette().as_str(), STYLE].concat()
}

/// A script or a style without the indentation of its lines and the lines that are comments: a fleet has hundreds of
/// pages.
pub(crate) fn compact(text: &str) -> String {
    let is_comment = |line: &str| line.starts_with("//") || (line.starts_with("/*") && line.ends_with("*/"));
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !is_comment(line));
    lines.flat_map(|line| [line, "\n"]).collect()
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
