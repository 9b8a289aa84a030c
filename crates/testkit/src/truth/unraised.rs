//! Why no made record raises some codes.

use crumple_stage::joints::invariants;

/// What joints check: made records go through programs that agree with each other.
const CONTRADICTION: &str = "a program from elsewhere that contradicts itself or another one";

/// The need of codes that runs may raise or not.
pub const BY_CHANCE: &str = "an edge of what is decided, or a computation that fails: more made cars may meet it";

/// What a run would need to raise a code, where the cases have none, and the numbers of such codes.
const NEEDS: &[(&str, &str)] = &[
    ("a file of another form, or with faults of its own", "001-007 009-010 012 014-016 018-046 048-049 051-064 066"),
    ("facts that are stated twice, without a unit, or wrongly", "101-104 108-111 114-116 122 138 140-141 144 348"),
    (
        "an option of a stage that no case sets",
        "013 017 050 065 112-113 125-126 137 210 221 223 326-327 329 336 347 350-351 354-355 358-359 405-406 418-419 \
         424 426-430 432-435 439 443-447 450 459 470-473 510 518 529 540-550 552 554-555 558-560 562 605-608 \
         707-708",
    ),
    (
        "a channel that no made record has: load cells, dummies, velocities, other rates or states",
        "117-118 120 124 129 131 157-158 160-162 164 169 212 218-219 222 225 330-335 342 344-346 353 356-357 360 \
         362 364-366 370 516 519-520 551",
    ),
    ("the output of a simulation", "170-185"),
    ("another motion, or a faulty sensor", "105 127-128 133 145-147 150 152 167-168 214-215 313-314 338 349 533"),
    ("a process or a model that is none of the made ones", "415-417 420-423 436 451 460 464 467 469 474 509"),
    ("several tests: each case is one", "504-506 564 804"),
    (BY_CHANCE, "139 316 319 407-408 411 431 453-456 462 513 515 528 530 532 536 539 609 709"),
];

/// Whether a row such as `003-005 008` has the number of a code.
fn has(row: &str, code: &str) -> bool {
    let mut ranges = row.split(' ').map(|range| range.split_once('-').unwrap_or((range, range)));
    ranges.any(|(first, last)| (first..=last).contains(&code.trim_start_matches("CR")))
}

/// What a run would need to raise a code, where the cases have none.
pub fn need(code: &str) -> Option<&'static str> {
    let row = || NEEDS.iter().find(|(_, row)| has(row, code)).map(|(need, _)| *need);
    if invariants().any(|row| row.kind.code == code) { Some(CONTRADICTION) } else { row() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_has_one_reason_and_nothing_is_compared_that_nothing_raises() {
        for code in (1..1000).map(|number| format!("CR{number:03}")) {
            let rows = NEEDS.iter().filter(|(_, row)| has(row, &code)).count();
            let others = [need(&code) == Some(CONTRADICTION), !crate::truth::codes::compared(&code).is_empty()];
            assert!(rows + others.into_iter().filter(|is| *is).count() <= 1, "{code}: {rows}");
        }
    }
}
