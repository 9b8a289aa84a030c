//! The text of the first screen of a page.

/// Where the first screen of a page ends: the figures and sections below it.
const BELOW: [&str; 5] =
    ["id=\"curves\"", "id=\"what-if\"", "id=\"candidates\"", "id=\"identification\"", "id=\"notes\""];
/// Elements that end a line of text.
const LINES: [&str; 14] =
    ["p", "li", "dt", "dd", "h1", "h2", "h3", "h4", "div", "tr", "figcaption", "caption", "summary", "section"];

/// The text of the first screen of a page: a line a block, cells of tables between bars; drawings, whose ticks and
/// scales are no numbers of the run, and the title of the record are left out.
pub fn first_screen(html: &str) -> String {
    let body = html.split_once("<header>").map_or(html, |(_, rest)| rest);
    let end = BELOW.iter().filter_map(|mark| body.find(mark)).min().unwrap_or(body.len());
    let mut out = String::new();
    let mut rest = &body[..end];
    while let Some((before, behind)) = rest.split_once('<') {
        out.push_str(before);
        let Some((tag, inside)) = behind.split_once('>') else { break };
        let name = tag.trim_start_matches('/').split([' ', '\n', '/']).next().unwrap_or_default();
        rest = match name {
            "svg" | "script" | "style" | "h1" if !tag.starts_with('/') => {
                inside.split_once(&format!("</{name}>")).map_or("", |(_, behind)| behind)
            }
            _ => inside,
        };
        out.push_str(match name {
            "td" | "th" if !tag.starts_with('/') => "|",
            name if LINES.contains(&name) => "\n",
            "span" | "b" | "sub" | "sup" | "small" | "strong" => "",
            _ => " ",
        });
    }
    let names = [("&nbsp;", " "), ("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&#39;", "'"), ("&amp;", "&")];
    names.iter().fold(out, |out, (name, character)| out.replace(name, character))
}
