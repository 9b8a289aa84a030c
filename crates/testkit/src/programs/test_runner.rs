//! A test that is a program of its own (`harness = false`), so that its count is the last line it prints.

/// Whether a test runner asks for the tests of this program; it is told the one name then. A program that lists none
/// is never run.
pub fn asked_for_tests(name: &str) -> bool {
    let asked = |flag: &str| std::env::args().any(|argument| argument == flag);
    if asked("--list") && !asked("--ignored") {
        println!("{name}: test");
    }
    asked("--list")
}
