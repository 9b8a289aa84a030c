//! What runs say is true: every sentence is read by a template with a rule, and compared with the truth of its record.
//! `just truth` does it with all records and prints the table.

use crumple_testkit::pipeline::binary;
use crumple_testkit::truth::{Extent, Made, Net, Registry, cases, run};
use rayon::prelude::*;

#[test]
fn every_text_that_a_run_can_print_has_a_rule_or_a_reason_to_have_none() {
    assert_eq!(Registry::new().without_rule(), Vec::<String>::new());
}

#[test]
fn no_sentence_of_a_run_contradicts_the_truth() {
    let folder = tempfile::tempdir().unwrap();
    let bin = binary("crumple-run").parent().unwrap().to_owned();
    let cases = cases(Extent::Short, folder.path()).unwrap();
    let made: Vec<Made> = cases.par_iter().map(|case| run(case, &bin, folder.path()).unwrap()).collect();
    let (registry, mut net) = (Registry::new(), Net::default());
    made.iter().for_each(|made| net.read(&registry, made));
    assert!(net.contradictions.is_empty() && net.unread.is_empty(), "{}", net.table(&registry));
    assert_eq!(net.counts.too_low(), Vec::<String>::new());
}
