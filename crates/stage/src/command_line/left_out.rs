//! Options and values that earlier versions of a stage had: one line with what to do instead.

use toml::{Table, Value};

use crate::error::Usage;

/// An option that a stage no longer has, or one value of an option.
#[derive(Debug, Clone, Copy)]
pub struct LeftOut {
    /// Its key in a pipeline file; the flag has hyphens.
    pub option: &'static str,
    /// The value; empty: the option as a whole.
    pub value: &'static str,
    /// What to do instead.
    pub instead: &'static str,
}

/// Refuses what was left out and stands in a table; `place` is where that is.
pub(crate) fn refuse(table: &Table, left_out: &[LeftOut], place: &str) -> Result<(), Usage> {
    let is_in = |value: &Value, name: &str| match value {
        Value::Array(all) => all.iter().any(|one| one.as_str() == Some(name)),
        one => one.as_str() == Some(name),
    };
    for LeftOut { option, value, instead } in left_out {
        if table.get(*option).is_some_and(|given| value.is_empty() || is_in(given, value)) {
            let what = if value.is_empty() { (*option).to_owned() } else { format!("{value} of {option}") };
            return Err(Usage::new(format!("{place}{what} is left out")).hint(*instead));
        }
    }
    Ok(())
}

/// The flags of a command line as a table of lists of words.
pub(crate) fn typed(words: impl Iterator<Item = String>) -> Table {
    let mut words = words.peekable();
    let mut table = Table::new();
    while let Some(word) = words.next() {
        let Some(flag) = word.strip_prefix("--") else { continue };
        let (name, value) = match flag.split_once('=') {
            Some((name, value)) => (name, value.to_owned()),
            None => (flag, words.next_if(|next| !next.starts_with('-')).unwrap_or_default()),
        };
        let values = value.split(',').map(Value::from).collect();
        table.insert(name.replace('-', "_"), Value::Array(values));
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_and_keys_that_were_left_out_are_answered_with_what_to_do_instead() {
        let left_out = [
            LeftOut { option: "taps", value: "", instead: "use okid" },
            LeftOut { option: "methods", value: "fir", instead: "use okid" },
        ];
        let of_words = |words: &str| refuse(&typed(words.split(' ').map(str::to_owned)), &left_out, "");
        for (words, told) in [
            ("in.mcap --taps=80", "taps is left out"),
            ("--taps 80 in.mcap", "taps is left out"),
            ("--methods era,fir", "fir of methods is left out"),
        ] {
            assert_eq!(of_words(words).unwrap_err().to_string(), told);
        }
        assert!(of_words("--methods era,okid --first fir").is_ok());
        let table: Table = "methods = ['fir']".parse().unwrap();
        let told = refuse(&table, &left_out, "p.toml: ").unwrap_err();
        assert_eq!(told.to_string(), "p.toml: fir of methods is left out");
        assert_eq!(refuse(&"methods = 'fir'".parse().unwrap(), &left_out, "p.toml: "), Err(told));
    }
}
