//! Head injury criterion and its relatives on a resultant, and the pruned search for the worst window.

pub mod criterion;
mod search;
