//! What a stage wrote into an artifact, word for word. Stages write English: on a page of another language their words
//! are quoted and marked as English, so that a reader and a screen reader know whose they are.

use crumple_drawing::escape::html;
use crumple_phrases::language::Language;

/// Words of a stage, as HTML.
pub(crate) fn words_of_stage(language: Language, text: &str) -> String {
    match language {
        Language::English => html(text),
        Language::German => format!("<q lang=\"{}\">{}</q>", Language::English.code(), html(text)),
    }
}

/// A sentence of the page in which words of stages stand, as HTML.
pub(crate) fn sentence_with_words_of_stages(language: Language, sentence: &str, words: &[&str]) -> String {
    let mut text = html(sentence);
    for words in words.iter().filter(|words| !words.is_empty()) {
        text = text.replacen(&html(words), &words_of_stage(language, words), 1);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_a_stage_are_quoted_where_the_page_speaks_another_language() {
        let sentence = "Es gibt kein Modell: v < 0.";
        let german = sentence_with_words_of_stages(Language::German, sentence, &["", "v < 0"]);
        assert_eq!(german, "Es gibt kein Modell: <q lang=\"en\">v &lt; 0</q>.");
        assert_eq!(sentence_with_words_of_stages(Language::English, sentence, &["v < 0"]), html(sentence));
    }
}
