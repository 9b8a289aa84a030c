//! Each rule names a violation that is planted in a small workspace.
