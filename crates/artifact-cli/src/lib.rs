//! Shows and checks artifacts.
