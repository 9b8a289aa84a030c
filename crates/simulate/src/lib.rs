//! Simulates every candidate model and compares it with the test.
