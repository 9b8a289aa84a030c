//! Words as a person types them for a shell.

use std::ops::Deref;
use std::str::FromStr;

/// Flags, as one would type them: quotes hold a word together, nothing is put in place of anything.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Words(pub(crate) Vec<String>);

impl FromStr for Words {
    type Err = shell_words::ParseError;

    fn from_str(typed: &str) -> Result<Self, Self::Err> {
        shell_words::split(typed).map(Self)
    }
}

impl Words {
    /// Whether they keep a stage quiet.
    pub(crate) fn is_quiet(&self) -> bool {
        self.iter().any(|word| matches!(word.as_str(), "-q" | "--quiet"))
    }
}

impl std::fmt::Display for Words {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&shell_words::join(&self.0))
    }
}

impl Deref for Words {
    type Target = [String];

    fn deref(&self) -> &[String] {
        &self.0
    }
}

/// The first of the arguments that makes a program of the project print something instead of computing.
pub(crate) fn request_for_information<T: AsRef<str>>(arguments: impl Iterator<Item = T>) -> Option<T> {
    arguments.take_while(|word| word.as_ref() != "--").find(|word| match word.as_ref() {
        "--help" | "--version" | "--list" | "--generate" => true,
        long if long.starts_with("--") => long.starts_with("--generate="),
        // `-qh` is `-q -h`; behind any other letter stands its value.
        word => word.strip_prefix('-').is_some_and(|short| short.trim_start_matches('q').starts_with(['h', 'V'])),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_split_at_blanks_outside_of_quotes_and_joined_again() {
        let words: Words = r#"-q 'a b' "c 'd'" e\ f $x"#.parse().unwrap();
        assert_eq!(*words, ["-q", "a b", "c 'd'", "e f", "$x"]);
        assert_eq!(words.to_string().parse::<Words>().unwrap(), words);
        assert!("'open".parse::<Words>().is_err());
    }

    #[test]
    fn flags_that_print_are_known_in_any_form() {
        let request = |text: &str| request_for_information(text.split(' ').map(str::to_owned));
        for flag in ["-h", "--help", "-V", "--version", "--generate", "--generate=man", "--list", "-qV"] {
            assert_eq!(request(&format!("-q --cfc 180 {flag} x")).as_deref(), Some(flag));
        }
        for text in ["-q --force", "-p.hV", "--cfc=-h", "-- --help", "help", ""] {
            assert_eq!(request(text), None, "{text}");
        }
    }
}
