//! Work on one model among several: what it costs is counted and bounded, and what goes wrong in it costs that model.
//!
//! Work is counted, not timed, so that the same input ends the same way on every machine and for any number of threads.

use std::any::Any;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The work that is left for one model; copies share it. Without a limit where none is set.
///
/// Whether it is enough does not depend on the order in which threads spend it: it ends all of the work or none.
#[derive(Debug, Clone, Default)]
pub struct Work(Option<Arc<AtomicU64>>);

/// What ends work beyond its limit.
struct Spent;

impl Work {
    /// At most so many units.
    pub fn limited(units: u64) -> Self {
        Self(Some(Arc::new(AtomicU64::new(units))))
    }

    /// Counts units that were worked. Beyond the limit the work ends where [`determined`] began it; it never does where
    /// a program cannot unwind.
    pub fn spend(&self, units: u64) {
        let Some(left) = &self.0 else { return };
        let take = |left: u64| left.checked_sub(units);
        if left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take).is_err() && cfg!(panic = "unwind") {
            // Others that still work on it end too.
            left.store(0, Ordering::Relaxed);
            resume_unwind(Box::new(Spent));
        }
    }
}

impl PartialEq for Work {
    /// No part of a result.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// Why there is no result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NotDetermined {
    /// It takes more work than its limit.
    TooMuchWork,
    /// The computation panicked, with this message.
    Failed(String),
}

impl fmt::Display for NotDetermined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooMuchWork => f.write_str("not determined: the search reached its limit of evaluations"),
            Self::Failed(message) => write!(f, "not determined: the computation failed ({message})"),
        }
    }
}

/// The result of work on one model. Errors: the work panicked or came to its limit.
pub fn determined<T>(work: impl FnOnce() -> T) -> Result<T, NotDetermined> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
        if payload.is::<Spent>() { NotDetermined::TooMuchWork } else { NotDetermined::Failed(message(&*payload)) }
    })
}

fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied().or(payload.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no message").trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;

    #[test]
    fn work_ends_at_its_limit_for_any_number_of_threads() {
        for threads in [1, 2, 7] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let outcome = |limit: u64| {
                let work = Work::limited(limit);
                let parts = || (1..=100_u64).into_par_iter().map(|units| work.clone().spend(units)).count();
                pool.install(|| determined(parts))
            };
            assert_eq!(outcome(5050), Ok(100));
            assert_eq!(outcome(5049), Err(NotDetermined::TooMuchWork));
        }
        assert_eq!(determined(|| Work::default().spend(u64::MAX)), Ok(()));
    }

    #[test]
    fn a_panic_is_the_reason() {
        let failed = determined(|| Vec::<f64>::new()[std::hint::black_box(3)]).unwrap_err().to_string();
        assert!(failed.starts_with("not determined: the computation failed (index out of bounds"), "{failed}");
    }
}
