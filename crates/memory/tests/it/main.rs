//! The budget as a process keeps it: this test starts itself again, with work that needs a known amount of memory.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

use std::hint::black_box;
use std::process::{Command, Output};

use crumple_memory::{Budgeted, left, peak, set_budget, used};

#[global_allocator]
static ALLOCATOR: Budgeted<std::alloc::System> = Budgeted(std::alloc::System);

const MIB: u64 = 1 << 20;

/// Runs the ignored test `name` in a process of its own.
fn run(name: &str) -> Output {
    let exe = std::env::current_exe().expect("this test is a file");
    let arguments = [name, "--exact", "--ignored", "--nocapture"];
    Command::new(exe).args(arguments).output().expect("it starts")
}

#[test]
fn what_is_allocated_is_counted_and_what_is_freed_no_more() {
    let before = used();
    let block = black_box(vec![1_u8; 8 << 20]);
    assert!(used() >= before + 7 * MIB, "{} after {before}", used());
    drop(block);
    assert!(used() < before + 4 * MIB, "{} after {before}", used());
    assert!(peak() >= before + 7 * MIB);
}

#[test]
fn an_allocation_beyond_the_budget_ends_with_the_refusal_and_exit_code_3() {
    for name in ["a_large_vector", "many_small_boxes", "a_vector_that_grows", "in_another_thread"] {
        let output = run(name);
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{name}: {text}");
        assert!(text.contains("error: x.mcap needs more"), "{name}: {text}");
    }
}

#[test]
fn work_within_the_budget_is_left_alone() {
    let output = run("work_within_the_budget");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

fn budget_of_64_mib() {
    set_budget(64 * MIB, "error: x.mcap needs more".to_owned(), 3);
}

#[test]
#[ignore = "run by the tests above"]
fn a_large_vector() {
    budget_of_64_mib();
    black_box(Vec::<u8>::with_capacity(1 << 40));
}

#[test]
#[ignore = "run by the tests above"]
fn many_small_boxes() {
    budget_of_64_mib();
    black_box((0..1 << 21).map(|_| Box::new([0_u8; 64])).collect::<Vec<_>>());
}

#[test]
#[ignore = "run by the tests above"]
fn a_vector_that_grows() {
    budget_of_64_mib();
    black_box(std::iter::repeat_n(1_u8, 1 << 30).fold(Vec::new(), |mut bytes, byte| {
        bytes.push(byte);
        bytes
    }));
}

#[test]
#[ignore = "run by the tests above"]
fn in_another_thread() {
    budget_of_64_mib();
    let worker = std::thread::spawn(|| black_box(vec![0_u8; 80 << 20]).len());
    let _ = worker.join();
}

#[test]
#[ignore = "run by the tests above"]
fn work_within_the_budget() {
    budget_of_64_mib();
    for _ in 0..1000 {
        black_box(vec![0_u8; 1 << 20]);
    }
    assert!(left() > 32 * MIB);
}
