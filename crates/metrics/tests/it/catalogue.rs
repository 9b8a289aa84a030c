//! `docs/metrics.md` lists the catalogue, word by word.

use crumple_metrics::definitions::CATALOGUE;

const BEGIN: &str = "<!-- catalogue: generated, see crates/metrics/tests/it/catalogue.rs -->\n";
const END: &str = "<!-- end of catalogue -->\n";

fn table() -> String {
    let mut table =
        String::from("| name | definition id | unit | what is computed | source | mark |\n|---|---|---|---|---|---|\n");
    for d in CATALOGUE {
        let text = d.text.replace('|', "\\|");
        table += &format!(
            "| `{}` | `{}` | {} | {text} | {} | {} |\n",
            d.name,
            d.id,
            d.unit,
            d.source.replace('|', "\\|"),
            d.mark.letter()
        );
    }
    table
}

/// `CRUMPLE_WRITE_DOCS=1 cargo test -p crumple-metrics --test it catalogue` writes the table.
#[test]
fn the_page_lists_every_definition() {
    let path = crumple_testkit::workspace().join("docs/metrics.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once(BEGIN).unwrap();
    let (found, after) = rest.split_once(END).unwrap();
    if std::env::var_os("CRUMPLE_WRITE_DOCS").is_some() {
        std::fs::write(&path, format!("{before}{BEGIN}{}{END}{after}", table())).unwrap();
        return;
    }
    assert_eq!(found, table(), "docs/metrics.md and the catalogue differ: run with CRUMPLE_WRITE_DOCS=1");
}
