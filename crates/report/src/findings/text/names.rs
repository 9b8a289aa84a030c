//! Names as people write them: of models, candidates, inputs and outputs.

/// An input or output as identify names it (`acceleration of channel 93, m/s^2`): the words and the unit, if it has
/// one.
pub fn words_and_unit(text: &str) -> (&str, Option<String>) {
    let text = text.trim();
    let (words, unit) = match text.rsplit_once(", ") {
        Some((words, unit)) => (words, Some(unit)),
        None => (text, None),
    };
    let unit = unit.filter(|unit| !["", "1"].contains(unit)).map(|unit| unit.replace("^2", "²").replace('*', "·"));
    (words.strip_prefix("other ").unwrap_or(words), unit)
}

/// A model's name in words: `double-spring-mass-damper` is "Double spring-mass-damper".
pub fn model_name(name: &str) -> String {
    match name {
        "double-spring-mass-damper" => "Double spring-mass-damper".to_owned(),
        "triple-spring-mass-damper" => "Triple spring-mass-damper".to_owned(),
        other => {
            let words = other.replace('-', " ");
            let mut letters = words.chars();
            letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
        }
    }
}

/// A candidate id in words: `kelvin/closed-form/1` is "Kelvin, closed form 1".
pub fn candidate_name(id: &str) -> String {
    let mut parts = id.splitn(3, '/');
    match (parts.next(), parts.next(), parts.next()) {
        (Some(model), Some(method), Some(index)) => {
            format!("{}, {} {index}", model_name(model), method.replace('-', " "))
        }
        _ => id.to_owned(),
    }
}

/// A reason as a sentence.
pub(crate) fn as_sentence(reason: &str) -> String {
    let mut rest = reason.chars();
    let first = rest.next().map_or_else(String::new, |first| first.to_uppercase().to_string());
    format!("{first}{}.", rest.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantity_that_is_not_known_has_no_unit() {
        assert_eq!(words_and_unit("other column_2, 1"), ("column_2", None));
        let (words, unit) = words_and_unit("acceleration of channel 93, m/s^2");
        assert_eq!((words, unit.as_deref()), ("acceleration of channel 93", Some("m/s²")));
    }
}
