//! `docs/metrics.md` names everything that is doubtful or written from memory.

use crumple_metrics::definitions::{CATALOGUE, Mark};

/// Rows of the table of marks beyond the catalogue, and the mark of each.
fn rows(page: &str) -> Vec<(&str, &str)> {
    let (_, table) = page.split_once("## Marks beyond the catalogue").unwrap();
    let (table, _) = table.split_once("\n## ").unwrap();
    let cells = table.lines().filter(|line| line.starts_with("| ")).skip(1).map(|line| {
        let mut cells = line.split('|').map(str::trim).skip(1);
        (cells.next().unwrap(), cells.next().unwrap())
    });
    cells.collect()
}

fn page() -> String {
    std::fs::read_to_string(crumple_testkit::workspace().join("docs/metrics.md")).unwrap()
}

#[test]
fn every_mark_of_the_specification_is_on_the_page() {
    let Some(path) = crumple_testkit::shared("reference/crash-metrics.md") else { return };
    let specification = std::fs::read_to_string(path).unwrap();
    // Behind the paragraph that explains the marks.
    let (_, body) = specification.split_once("## 0.").unwrap();
    let page = page();
    let rows = rows(&page);
    for (mark, letter) in [("[U", "U"), ("[M", "M")] {
        let stated = body.matches(mark).count();
        let found = rows.iter().filter(|(_, row)| *row == letter).count();
        assert_eq!(found, stated, "{mark}]: {found} rows, {stated} in the specification");
    }
}

#[test]
fn a_definition_that_is_an_option_is_named_among_the_marks() {
    let page = page();
    let uncertain: Vec<&str> = rows(&page).into_iter().filter(|(_, mark)| *mark == "U").map(|(row, _)| row).collect();
    for definition in CATALOGUE.iter().filter(|definition| definition.mark == Mark::Uncertain) {
        let family = definition.id.split('-').next().unwrap().to_uppercase();
        assert!(uncertain.iter().any(|row| row.starts_with(&family)), "{}", definition.id);
    }
}
