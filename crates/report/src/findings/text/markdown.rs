//! Text of a test made safe for Markdown.

/// What such a file begins with, by which it is known.
pub const HEAD: &str = concat!("<!-- crumple-report ", env!("CARGO_PKG_VERSION"), " -->\n");

/// Text of one line: what Markdown or HTML could take for a mark gets a backslash.
pub fn markdown(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '#' | '|' | '~' | '&' | '!' => out.extend(['\\', c]),
            '\n' | '\r' => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_title_cannot_open_a_cell_a_link_or_a_tag() {
        assert_eq!(markdown("a|b [x](y)\n<b> *c* d_e"), "a\\|b \\[x\\](y) \\<b\\> \\*c\\* d\\_e");
    }
}
