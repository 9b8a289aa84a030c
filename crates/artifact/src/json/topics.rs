//! Patterns of topics.

/// Whether a topic matches a pattern: `*` stands for any text, also across `/`; `?` for one character.
pub fn topic_matches(pattern: &str, topic: &str) -> bool {
    let (pattern, topic): (Vec<char>, Vec<char>) = (pattern.chars().collect(), topic.chars().collect());
    let (mut p, mut t) = (0, 0);
    // Where to go on when the text taken by the last star was too short.
    let mut star = None;
    while t < topic.len() {
        if pattern.get(p) == Some(&'*') {
            star = Some((p, t));
            p += 1;
        } else if pattern.get(p).is_some_and(|c| *c == '?' || *c == topic[t]) {
            p += 1;
            t += 1;
        } else if let Some((at, taken)) = star {
            star = Some((at, taken + 1));
            p = at + 1;
            t = taken + 1;
        } else {
            return false;
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_as_documented() {
        for (pattern, topic, matches) in [
            ("/wave/*", "/wave/93/velocity", true),
            ("/wave/*/velocity", "/wave/93/velocity", true),
            ("/wave/*/velocity", "/wave/93/velocity/x", false),
            ("/wave/9?", "/wave/93", true),
            ("/wave/9?", "/wave/9", false),
            ("*", "", true),
            ("**a*b", "xxaxxb", true),
            ("/test", "/tests", false),
        ] {
            assert_eq!(topic_matches(pattern, topic), matches, "{pattern} {topic}");
        }
    }
}
