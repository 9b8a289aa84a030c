//! The contents of a page: its sections as they are written, with a line each at the side.

use rayon::prelude::*;

/// What is written, and where its parts begin.
#[derive(Debug, Default)]
pub(super) struct Sections {
    pub(super) html: String,
    /// Id and name of the parts that have something in them.
    named: Vec<(&'static str, &'static str)>,
}

/// A part: the id of its section, its name, and what writes it.
pub(super) struct Part<'a> {
    id: &'static str,
    name: &'static str,
    write: Box<dyn Fn(&mut String) + Send + Sync + 'a>,
}

impl<'a> Part<'a> {
    pub(super) fn new(id: &'static str, name: &'static str, write: impl Fn(&mut String) + Send + Sync + 'a) -> Self {
        Self { id, name, write: Box::new(write) }
    }
}

impl Sections {
    /// Writes parts, several at a time, in this order; one that writes nothing has no line in the contents.
    pub(super) fn extend(&mut self, parts: Vec<Part>) {
        let written = parts.par_iter().map(|part| {
            let mut html = String::new();
            (part.write)(&mut html);
            html
        });
        for (part, html) in parts.iter().zip(written.collect::<Vec<_>>()) {
            if !html.is_empty() {
                self.html.push_str(&html);
                self.named.push((part.id, part.name));
            }
        }
    }

    /// The list for a reader: of one part there is nothing to choose.
    pub(super) fn contents(&self) -> String {
        let item = |(id, name): &(&str, &str)| format!("<li><a href=\"#{id}\">{name}</a></li>\n");
        let items: String = self.named.iter().map(item).collect();
        match self.named.len() {
            0 | 1 => String::new(),
            _ => format!("<nav class=\"contents\" aria-label=\"Contents\">\n<ol>\n{items}</ol>\n</nav>\n"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_without_content_has_no_line() {
        let mut sections = Sections::default();
        sections.extend(vec![Part::new("curves", "Curves", |out| out.push_str("<section id=\"curves\"></section>"))]);
        assert_eq!(sections.contents(), "");
        sections.extend(vec![
            Part::new("energy", "Energy", |_| {}),
            Part::new("notes", "Notes", |out| out.push_str("<section id=\"notes\"></section>")),
        ]);
        assert!(sections.html.find("curves") < sections.html.find("notes"));
        assert_eq!(sections.contents().matches("<li>").count(), 2);
        assert!(!sections.contents().contains("#energy"));
    }
}
