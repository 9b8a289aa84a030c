//! Text laid out for the width of the terminal.

use terminal_size::{Width, terminal_size_of};

/// Columns where nobody says how many there are.
const USUAL: usize = 100;
/// A longer line is read with difficulty.
const WIDEST: usize = 110;
/// Narrower is no terminal.
const NARROWEST: usize = 40;

/// Columns for text on stderr.
pub fn columns() -> usize {
    terminal_size_of(std::io::stderr())
        .map_or(USUAL, |(Width(columns), _)| usize::from(columns).clamp(NARROWEST, WIDEST))
}

/// Words in lines of at most `width` characters; a longer word has a line for itself. Blanks that do not break stay.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut length = 0;
    for word in text.split([' ', '\n']).filter(|word| !word.is_empty()) {
        let word_length = word.chars().count();
        match lines.last_mut() {
            Some(line) if length + 1 + word_length <= width => {
                line.push(' ');
                line.push_str(word);
                length += 1 + word_length;
            }
            _ => {
                lines.push(word.to_owned());
                length = word_length;
            }
        }
    }
    lines
}

/// A label in a column of its own, the text behind it wrapped.
pub fn labelled(label: &str, label_width: usize, text: &str, columns: usize) -> Vec<String> {
    let width = columns.saturating_sub(label_width).max(NARROWEST / 2);
    let lines = wrapped(text, width);
    let mut label = label;
    lines.iter().map(|line| format!("{:<label_width$}{line}", std::mem::take(&mut label))).collect()
}

/// Only the first line of that, with dots where there would be more.
pub fn labelled_and_cut(label: &str, label_width: usize, text: &str, columns: usize) -> String {
    const DOTS: &str = " ...";
    let mut lines = labelled(label, label_width, text, columns);
    if lines.len() > 1 {
        lines = labelled(label, label_width, text, columns.saturating_sub(DOTS.len()));
        lines[0].push_str(DOTS);
    }
    lines.into_iter().next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_full_and_never_too_long() {
        assert_eq!(wrapped("one two three four", 9), ["one two", "three", "four"]);
        assert_eq!(wrapped("a unbreakable\u{a0}unit b", 5), ["a", "unbreakable\u{a0}unit", "b"]);
        assert_eq!(labelled("peak", 6, "45.4 g at 63 ms", 28), ["peak  45.4 g at 63 ms"]);
        assert_eq!(
            labelled("peak", 6, "45.4 g at 63 ms, and more of it", 28),
            ["peak  45.4 g at 63 ms, and", "      more of it"]
        );
        assert_eq!(labelled_and_cut("peak", 6, "45.4 g at 63 ms", 28), "peak  45.4 g at 63 ms");
        assert_eq!(
            labelled_and_cut("peak", 6, "45.4 g at 63 ms, and more of it", 28),
            "peak  45.4 g at 63 ms, and ..."
        );
        assert_eq!(labelled_and_cut("peak", 6, "", 28), "");
    }
}
