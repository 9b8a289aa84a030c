//! Why no made record raises some codes.

use crumple_stage::joints::invariants;

/// What joints check: made records go through programs that agree with each other.
const CONTRADICTION: &str = "a program from elsewhere that contradicts itself or another one";

/// What a run would need to raise a code, where the cases have none, and the numbers of such codes.
const NEEDS: &[(&str, &str)] = &[
    (
        "a file of another form, or with faults: made records are clean tables, and one test in EV5",
        "1-7 9-10 12 14-16 18-46 48-49 51-64 66",
    ),
    (
        "facts that are stated otherwise: made records state each once, in a row or by a flag, with its unit",
        "101-104 108-111 114-116 122 138 140-141 144 348",
    ),
    (
        "an option of a stage that no case sets",
        "13 17 50 65 112-113 125-126 137 210 221 223 326-327 329 336 347 350-351 354-355 358-359 405-406 418-419 \
         424 426-430 432-435 439 443-447 450 459 470-473 510 518 529 540-550 552 554-555 558-560 562 605-608 \
         707-708",
    ),
    (
        "a channel that no made record has: load cells, dummies, velocities, sensors of another rate or state",
        "117-118 120 124 129 131 157-158 160-162 164 169 212 218-219 222 225 330-335 342 344-346 353 356-357 360 \
         362 364-366 370 516 519-520 551",
    ),
    (
        "a motion, or a fault of a sensor or a recorder, that no made record has",
        "105 127-128 133 145-147 150 152 167-168 214-215 313-314 338 349 533",
    ),
    ("a process or a model that is none of the made ones", "415-417 420-423 436 451 460 464 467 469 474 509"),
    ("several tests: each case is one", "504-506 564 804"),
];

/// Edges of what is decided, and computations that fail: more made cars may meet them.
const BY_CHANCE: &str = "139 316 319 407-408 411 431 453-456 462 513 515 528 530 532 536 539 609 709";

/// Whether a row such as `3-5 8` has the number of a code.
fn has(row: &str, code: &str) -> bool {
    let number = |text: &str| text.parse::<u16>().ok();
    let holds = |range: &str| {
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        number(first).zip(number(last)).zip(number(&code[2..])).is_some_and(|((a, b), own)| (a..=b).contains(&own))
    };
    row.split(' ').any(holds)
}

/// What a run would need to raise a code, where no case has it: none of them raises the code.
pub fn need(code: &str) -> Option<&'static str> {
    if invariants().any(|row| row.kind.code == code) {
        return Some(CONTRADICTION);
    }
    NEEDS.iter().find(|(_, row)| has(row, code)).map(|(need, _)| *need)
}

/// Whether runs may raise a code or not.
pub fn is_by_chance(code: &str) -> bool {
    has(BY_CHANCE, code)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::codes;

    #[test]
    fn a_code_has_one_reason_and_is_not_compared_where_nothing_raises_it() {
        for code in (1..1000).map(|number| format!("CR{number:03}")) {
            let rows = NEEDS.iter().map(|(_, row)| *row).chain([BY_CHANCE]).filter(|row| has(row, &code)).count();
            let joint = usize::from(need(&code) == Some(CONTRADICTION));
            assert!(rows + joint <= 1, "{code}");
            assert!(need(&code).is_none() || codes::compared(&code).is_empty(), "{code}");
        }
    }
}
