//! Heads of the columns of a table.

/// Head of a column.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Column<'a> {
    text: &'a str,
    class: &'static str,
    definition: &'a str,
}

impl<'a> Column<'a> {
    /// Over texts.
    pub(crate) const fn text(text: &'a str) -> Self {
        Self { text, class: "", definition: "" }
    }

    /// Over numbers, at the right.
    pub(crate) const fn number(text: &'a str) -> Self {
        Self { text, class: " class=\"n\"", definition: "" }
    }

    /// With what it means.
    pub(crate) const fn means(self, definition: &'a str) -> Self {
        Self { definition, ..self }
    }
}

/// Cells of a head. Texts are HTML.
pub(crate) fn heads(columns: &[Column]) -> String {
    let cell = |column: &Column| {
        let Column { text, class, definition } = column;
        match definition.is_empty() {
            true => format!("<th scope=\"col\"{class}>{text}</th>"),
            false => format!("<th scope=\"col\"{class}><abbr title=\"{definition}\">{text}</abbr></th>"),
        }
    };
    columns.iter().map(cell).collect()
}

/// The opening of a table with these columns.
pub(crate) fn table(class: &str, columns: &[Column]) -> String {
    let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
    format!("<div class=\"scroll\"><table{class}>\n<thead><tr>{}</tr></thead>\n<tbody>\n", heads(columns))
}
