//! The contents of a page: its sections as they are written, with a line each at the side.

/// What is written, and where its parts begin.
#[derive(Debug, Default)]
pub(super) struct Sections {
    pub(super) html: String,
    /// Id and name of the parts that have something in them.
    named: Vec<(&'static str, &'static str)>,
}

impl Sections {
    /// Writes a part whose section has this id; one that writes nothing has no line in the contents.
    pub(super) fn part(&mut self, (id, name): (&'static str, &'static str), write: impl FnOnce(&mut String)) {
        let before = self.html.len();
        write(&mut self.html);
        if self.html.len() > before {
            self.named.push((id, name));
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
        sections.part(("curves", "Curves"), |out| out.push_str("<section id=\"curves\"></section>"));
        assert_eq!(sections.contents(), "");
        sections.part(("energy", "Energy"), |_| {});
        sections.part(("notes", "Notes"), |out| out.push_str("<section id=\"notes\"></section>"));
        assert_eq!(sections.contents().matches("<li>").count(), 2);
        assert!(!sections.contents().contains("#energy"));
    }
}
