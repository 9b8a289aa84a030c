//! Takes plotly's script out of the plotly crate while building, so that the program carries that one script and
//! nothing else of the crate: no second script (MathJax, 2 MB), and no copying and searching of 7 MB at every start.

use std::path::PathBuf;
use std::{env, error, fs};

fn main() -> Result<(), Box<dyn error::Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    let scripts = plotly::Plot::offline_js_sources();
    let script =
        first_script(&scripts).ok_or("the plotly crate's scripts are not what they were: no first <script>")?;
    if !script.contains("plotly.js v") {
        return Err("the plotly crate's first script is not plotly.js any more".into());
    }
    let folder = env::var_os("OUT_DIR").ok_or("OUT_DIR is not set: not run by cargo")?;
    fs::write(PathBuf::from(folder).join("plotly.min.js"), script)?;
    Ok(())
}

/// What stands in the first `<script ...>` element.
fn first_script(html: &str) -> Option<&str> {
    let open = html.find("<script")?;
    let start = open + html[open..].find('>')? + 1;
    let end = start + html[start..].find("</script>")?;
    Some(&html[start..end])
}
