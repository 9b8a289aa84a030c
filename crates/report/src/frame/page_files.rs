//! Style and scripts of pages: in each page, or in files that many pages share.

use crate::drawing::escape::address;
use crate::drawing::palette;

const STYLE: &str = include_str!("../page/style.css");

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
    fn a_script_and_a_style_lose_indentation_and_lines_of_comments_alone() {
        assert_eq!(compact("/* All. */\na {\n  b: c; /* kept */\n}\n"), "a {\nb: c; /* kept */\n}\n");
        let script = "// Sorts.\nif (a) {\n  // Not this.\n  b('// kept');\n\n}\n";
        assert_eq!(compact(script), "if (a) {\nb('// kept');\n}\n");
    }
}
