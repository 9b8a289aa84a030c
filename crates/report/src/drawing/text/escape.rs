//! Text of a test made safe for the places it stands in.

/// Text for an element or a quoted attribute: `& < > " '` become entities. What is not seen and changes how the rest is
/// read, control characters and those that turn the direction of writing, becomes the sign for what cannot be shown.
pub fn html(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if is_unseen(c) => out.push(char::REPLACEMENT_CHARACTER),
            c => out.push(c),
        }
    }
    out
}

/// Control characters but ends of lines and tabs, and Unicode's overrides, embeddings and isolates of direction.
fn is_unseen(c: char) -> bool {
    let is_space = matches!(c, '\n' | '\r' | '\t');
    (c.is_control() && !is_space) || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A path from the folder of the page as the address of a link.
pub fn address(path: &str) -> String {
    let mut out = String::with_capacity(path.len());
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'_' | b'.' | b'~' | b',' | b'=' => {
                out.push(char::from(byte));
            }
            byte => out.push_str(&format!("%{byte:02X}")),
        }
    }
    out
}

/// JSON for a `<script type="application/json">`: no `<` is left, so neither `</script>` nor `<!--` can end it.
///
/// In JSON a `<` occurs inside strings only, where its escape means the same.
pub fn json_in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_title_cannot_turn_the_direction_of_what_follows() {
        assert_eq!(html("a\u{202e}b\u{1b}[2J\n\u{ad}ü"), "a\u{fffd}b\u{fffd}[2J\n\u{ad}ü");
    }

    #[test]
    fn a_title_cannot_open_a_tag_or_leave_an_attribute() {
        assert_eq!(html("<b title=\"x\">R&D's</b>"), "&lt;b title=&quot;x&quot;&gt;R&amp;D&#39;s&lt;/b&gt;");
    }

    #[test]
    fn nothing_in_a_path_leaves_a_link() {
        assert_eq!(address("runs/a b#1/default,filter.cfc=60"), "runs/a%20b%231/default,filter.cfc=60");
    }

    #[test]
    fn json_cannot_end_its_script_and_means_the_same() {
        let value = serde_json::json!({"title": "</script><!-- <script>"});
        let safe = json_in_script(&value.to_string());
        assert!(!safe.contains('<'), "{safe}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&safe).unwrap(), value);
    }
}
