//! "Did you mean ...?"

/// The choice nearest to a mistyped name, if one is near enough to be meant.
pub fn nearest<'a>(name: &str, choices: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    choices
        .into_iter()
        .map(|choice| (strsim::jaro_winkler(&name.to_lowercase(), &choice.to_lowercase()), choice))
        .filter(|(likeness, _)| *likeness > 0.7)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, choice)| choice)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suggests_what_was_meant_and_nothing_far_fetched() {
        assert_eq!(nearest("cuttoff", ["cfc", "cutoff", "mode"]), Some("cutoff"));
        assert_eq!(nearest("zzz", ["cfc", "cutoff", "mode"]), None);
    }
}
