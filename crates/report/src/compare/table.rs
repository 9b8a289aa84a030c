//! A table of runs: a row a quantity, a column a run; as HTML and as Markdown.

use crate::drawing::escape::html;
use crate::findings::markdown;
use crumple_signal::display::sentence;

/// What a run says of the quantity of a row.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cell {
    /// The value.
    pub text: String,
    /// Beside it: an interval, how far it is from the first run.
    pub beside: String,
    /// Whether it differs from the first run beyond the tolerance.
    pub differs: bool,
}

/// A quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// A cell a run.
    pub cells: Vec<Cell>,
}

impl Row {
    /// Texts of files, settings and notes, that differ where they are not the same.
    pub fn of_texts(name: impl Into<String>, texts: &[String]) -> Self {
        let cell =
            |text: &String| Cell { text: sentence(text).into_owned(), differs: *text != texts[0], ..Cell::default() };
        Self { name: name.into(), cells: texts.iter().map(cell).collect() }
    }

    /// Whether a run differs from the first.
    pub fn differs(&self) -> bool {
        self.cells.iter().any(|cell| cell.differs)
    }
}

/// The mark of a value that differs: seen without colour too.
const MARK: &str = "≠";

/// As HTML; `of` heads the column of names.
pub fn to_html(of: &str, runs: &[String], rows: &[Row]) -> String {
    let heads: String = runs.iter().map(|run| format!("<th scope=\"col\">{}</th>", html(run))).collect();
    let cell = |cell: &Cell| {
        let beside =
            if cell.beside.is_empty() { String::new() } else { format!("<small>{}</small>", html(&cell.beside)) };
        match cell.differs {
            true => {
                let text = html(&cell.text);
                format!("<td class=\"differs\"><b aria-label=\"differs\">{MARK}</b> {text}{beside}</td>")
            }
            false => format!("<td>{}{beside}</td>", html(&cell.text)),
        }
    };
    let row = |row: &Row| {
        let cells: String = row.cells.iter().map(cell).collect();
        format!("<tr><th scope=\"row\">{}</th>{cells}</tr>\n", html(&row.name))
    };
    format!(
        "<div class=\"scroll\"><table class=\"runs\" style=\"min-width:{}em\">\n\
         <thead><tr><th scope=\"col\">{of}</th>{heads}</tr></thead>\n<tbody>\n{}</tbody>\n</table></div>\n",
        9 * (runs.len() + 1),
        rows.iter().map(row).collect::<String>()
    )
}

/// As aligned lines of a terminal, what differs marked; without the intervals that stand beside the values.
pub fn to_lines(runs: &[String], rows: &[&Row]) -> Vec<String> {
    let cell = |cell: &Cell| format!("{}{}", if cell.differs { "≠ " } else { "" }, plain(&cell.text));
    let mut lines: Vec<Vec<String>> = vec![[String::new()].into_iter().chain(runs.iter().cloned()).collect()];
    lines.extend(rows.iter().map(|row| [plain(&row.name)].into_iter().chain(row.cells.iter().map(cell)).collect()));
    let length = |text: &String| text.chars().count();
    let widths: Vec<usize> =
        (0..=runs.len()).map(|k| lines.iter().filter_map(|line| line.get(k)).map(length).max().unwrap_or(0)).collect();
    let padded = |line: &Vec<String>| {
        let cells = line.iter().zip(&widths).map(|(text, width)| format!("{text:<width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    if rows.is_empty() { Vec::new() } else { lines.iter().map(padded).collect() }
}

/// A name without soft hyphens.
pub fn plain(text: &str) -> String {
    text.replace('\u{ad}', "")
}

/// As Markdown.
pub fn to_markdown(of: &str, runs: &[String], rows: &[Row]) -> String {
    let cell = |cell: &Cell| {
        let mark = if cell.differs { format!("**{MARK}** ") } else { String::new() };
        let beside = if cell.beside.is_empty() { String::new() } else { format!(" ({})", cell.beside) };
        format!("{mark}{}{}", markdown(&cell.text), markdown(&beside))
    };
    let heads: Vec<String> = runs.iter().map(|run| markdown(run)).collect();
    let mut text = format!("| {of} | {} |\n|---|{}\n", heads.join(" | "), "---|".repeat(runs.len()));
    for row in rows {
        let cells: Vec<String> = row.cells.iter().map(cell).collect();
        text.push_str(&format!("| {} | {} |\n", markdown(&row.name), cells.join(" | ")));
    }
    text
}
