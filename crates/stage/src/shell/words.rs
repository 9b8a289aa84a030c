//! Words of a shell command.

use std::str::Chars;

/// The program of a command that starts only one, without its quotes; `None` where a shell would put something else in
/// its place or where there are several.
pub fn only_program(command: &str) -> Option<String> {
    let text = Text::of(command);
    let Some(first) = text.words.into_iter().next() else { return Some(String::new()) };
    Some(first.text).filter(|_| first.is_plain && !text.is_composite)
}

/// The words of a command that a shell would hand on as they are: nothing is put in place of any, and it is one command
/// alone. `None` otherwise.
pub(crate) fn plain_words(command: &str) -> Option<Vec<String>> {
    let text = Text::of(command);
    (!text.is_composite && text.words.iter().all(|word| word.is_plain))
        .then(|| text.words.into_iter().map(|word| word.text).collect())
}

/// The words as a program gets them, as far as that can be told without a shell.
pub fn shell_words(command: &str) -> impl Iterator<Item = String> {
    Text::of(command).words.into_iter().map(|word| word.text)
}

/// The first of the arguments that makes a program of the project print something instead of computing.
pub fn request_for_information<T: AsRef<str>>(arguments: impl Iterator<Item = T>) -> Option<T> {
    arguments.take_while(|word| word.as_ref() != "--").find(|word| match word.as_ref() {
        "--help" | "--version" | "--list" | "--generate" => true,
        long if long.starts_with("--") => long.starts_with("--generate="),
        // `-qh` is `-q -h`; behind any other letter stands its value.
        word => word.strip_prefix('-').is_some_and(|short| short.trim_start_matches('q').starts_with(['h', 'V'])),
    })
}

#[derive(Debug)]
struct Word {
    text: String,
    /// A shell puts nothing else in place of any of it.
    is_plain: bool,
}

impl Word {
    /// Takes what stands in quotes. Whether a shell hands it on as it is: the quotes are closed, and in double ones it
    /// finds nothing to put something else in place of.
    fn take_until(&mut self, chars: &mut Chars<'_>, quote: char) -> bool {
        let mut is_plain = true;
        while let Some(c) = chars.next() {
            match c {
                c if c == quote => return is_plain,
                '\\' if quote == '"' => {
                    let next = chars.next();
                    // Before any other letter the stroke stays in the text.
                    is_plain &= matches!(next, Some('"' | '\\' | '$' | '`'));
                    self.text.extend(next);
                }
                c => {
                    is_plain &= quote == '\'' || !matches!(c, '$' | '`');
                    self.text.push(c);
                }
            }
        }
        false
    }
}

/// A command in words.
#[derive(Debug, Default)]
struct Text {
    words: Vec<Word>,
    /// Something outside quotes makes several commands of it.
    is_composite: bool,
}

impl Text {
    fn of(command: &str) -> Self {
        let mut text = Self::default();
        let mut word: Option<Word> = None;
        let mut before = ' ';
        let mut chars = command.trim().chars();
        while let Some(c) = chars.next() {
            if matches!(c, ' ' | '\t') {
                text.words.extend(word.take());
                before = c;
                continue;
            }
            // `2>&1` and `$(...)` begin no other command of their own rank.
            let is_of_one = (c == '&' && before == '>') || (c == '(' && before == '$');
            text.is_composite |= matches!(c, ';' | '&' | '|' | '(' | '\n') && !is_of_one;
            before = c;
            let word = word.get_or_insert_with(|| Word { text: String::new(), is_plain: true });
            match c {
                '\'' | '"' => word.is_plain &= word.take_until(&mut chars, c),
                '\\' => match chars.next() {
                    // A line that goes on is one line to a shell.
                    None | Some('\n') => word.is_plain = false,
                    Some(c) => word.text.push(c),
                },
                c => {
                    word.is_plain &= !"$`(){}<>|&;*?[]~#=".contains(c);
                    word.text.push(c);
                }
            }
        }
        text.words.extend(word);
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_is_read_as_a_shell_reads_it() {
        for (command, word) in [
            ("cat -n", Some("cat")),
            ("  'a b/c'\"'\"'d' --x", Some("a b/c'd")),
            (r#""a \"b\"" c"#, Some("a \"b\"")),
            (r"a\ b c", Some("a b")),
            ("$HOME/x y", None),
            ("\"$HOME\"/x y", None),
            ("A=1 x", None),
            ("(x)", None),
            ("a; b", None),
            ("a && b", None),
            ("a | b", None),
            ("a '; b' \"& c\" 2>&1", Some("a")),
            ("a --key=value", Some("a")),
            ("", Some("")),
            ("''", Some("")),
        ] {
            assert_eq!(only_program(command).as_deref(), word, "{command}");
        }
    }

    #[test]
    fn words_are_plain_where_a_shell_hands_them_on() {
        let plain = |text: &str| plain_words(text).map(|words| words.join("|"));
        assert_eq!(plain("'/a b/c' --x \"d e\" f\\ g").as_deref(), Some("/a b/c|--x|d e|f g"));
        assert_eq!(plain(r"''\''/a b'\'' RECORD -o 1.mcap'").as_deref(), Some("'/a b' RECORD -o 1.mcap"));
        assert_eq!(plain("").as_deref(), Some(""));
        for text in [
            "a; b",
            "a $B",
            "a *.csv",
            "a > b",
            "a 2>&1",
            "~/a",
            "a 'b",
            "a \"b\\c\"",
            "a \"b\\$c",
            "a \\",
            "# a",
            "a=1",
        ] {
            assert_eq!(plain(text), None, "{text}");
        }
    }

    #[test]
    fn flags_that_print_are_known_in_any_form() {
        let request = |text: &str| request_for_information(shell_words(text));
        for flag in ["-h", "--help", "-V", "--version", "--generate", "--generate=man", "--list", "-qV"] {
            assert_eq!(request(&format!("-q --cfc 180 '{flag}' x")).as_deref(), Some(flag));
        }
        for text in ["-q --force", "-p.hV", "--cfc=-h", "-- --help", "help", ""] {
            assert_eq!(request(text), None, "{text}");
        }
    }
}
