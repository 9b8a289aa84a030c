//! Patterns with `?` and `*`.

/// Whether `text` fits `pattern`: `?` is one character, `*` any number, all others themselves in any case.
pub fn wildcard(pattern: &str, text: &str) -> bool {
    let pattern: Vec<char> = pattern.to_lowercase().chars().collect();
    let text: Vec<char> = text.to_lowercase().chars().collect();
    let (mut p, mut t) = (0, 0);
    // Where the last star stands, and how far the text had got by then.
    let mut star: Option<(usize, usize)> = None;
    while t < text.len() {
        match pattern.get(p) {
            Some('*') => {
                star = Some((p, t));
                p += 1;
            }
            Some(c) if *c == '?' || *c == text[t] => {
                p += 1;
                t += 1;
            }
            _ => match star {
                Some((at, reached)) => {
                    star = Some((at, reached + 1));
                    p = at + 1;
                    t = reached + 1;
                }
                None => return false,
            },
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wildcards() {
        let code = "10VEHCCG0000ACXD";
        for (pattern, fits) in [
            ("1?VEHC*X?", true),
            ("1?VEHC????????X?", true),
            ("*ACXD", true),
            ("10vehc*", true),
            ("**", true),
            ("1?VEHC*Y?", false),
            ("VEHC*", false),
            ("10VEHCCG0000ACX", false),
        ] {
            assert_eq!(wildcard(pattern, code), fits, "{pattern}");
        }
        assert!(wildcard("", "") && wildcard("*", "") && !wildcard("?", ""));
    }
}
