//! One budget of memory for a process, kept by its allocator.
//!
//! What a file states about its size reserves nothing by itself: readers ask [`left`] first and refuse with the place
//! in the file. What they overlook ends here: an allocation beyond the budget prints the refusal that was set with it
//! and ends the process with its exit code, before the memory is taken. Without a budget nothing is refused.

use std::alloc::{GlobalAlloc, Layout};
use std::cell::Cell;
use std::io::Write;
use std::process;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering::Relaxed};

/// Bytes a thread allocates or frees before it adds them to the count of the process: small allocations cost nothing
/// measurable, and the count is exact to this much a thread.
const GRAIN: i64 = 1 << 16;

/// Allocated by all threads, bytes. Signed, since a thread may free what another has not counted yet.
static USED: AtomicI64 = AtomicI64::new(0);
static PEAK: AtomicI64 = AtomicI64::new(0);
static BUDGET: AtomicI64 = AtomicI64::new(i64::MAX);
static REFUSAL: Mutex<Option<(String, i32)>> = Mutex::new(None);
static REFUSED: AtomicBool = AtomicBool::new(false);

thread_local! {
    static UNCOUNTED: Cell<i64> = const { Cell::new(0) };
}

/// An allocator that counts what another one hands out, and keeps the budget of [`set_budget`].
///
/// ```
/// #[global_allocator]
/// static ALLOCATOR: crumple_memory::Budgeted<std::alloc::System> = crumple_memory::Budgeted(std::alloc::System);
/// ```
#[derive(Debug)]
pub struct Budgeted<A>(pub A);

/// From now on the process may have at most `bytes` allocated at a time. The allocation that exceeds them prints
/// `refusal` to stderr and ends the process with this exit code.
pub fn set_budget(bytes: u64, refusal: String, exit_code: i32) {
    // Nothing is allocated or freed under the lock: the allocation that exceeds the budget takes it.
    let former = REFUSAL.lock().ok().and_then(|mut known| known.replace((refusal, exit_code)));
    drop(former);
    BUDGET.store(i64::try_from(bytes).unwrap_or(i64::MAX), Relaxed);
}

/// Bytes allocated now, to 64 KiB a thread; 0 in a process without [`Budgeted`].
pub fn used() -> u64 {
    USED.load(Relaxed).max(0).cast_unsigned()
}

/// The most bytes that were allocated at a time.
pub fn peak() -> u64 {
    PEAK.load(Relaxed).cast_unsigned()
}

/// Bytes of the budget that are free; without a budget more than any memory has.
pub fn left() -> u64 {
    BUDGET.load(Relaxed).saturating_sub(USED.load(Relaxed)).max(0).cast_unsigned()
}

/// Counts a change; ends the process where it exceeds the budget.
fn count(change: i64) {
    let told = UNCOUNTED.try_with(|uncounted| {
        let sum = uncounted.get().saturating_add(change);
        let told = if sum.abs() < GRAIN { 0 } else { sum };
        uncounted.set(sum - told);
        told
    });
    let told = told.unwrap_or(change);
    if told == 0 {
        return;
    }
    let used = USED.fetch_add(told, Relaxed).saturating_add(told);
    if told > 0 {
        PEAK.fetch_max(used, Relaxed);
        if used > BUDGET.load(Relaxed) && !REFUSED.swap(true, Relaxed) {
            refuse();
        }
    }
}

/// Ends the process. What it was writing stands in a temporary file; nothing that was there is harmed.
#[cold]
fn refuse() -> ! {
    let known = REFUSAL.lock();
    let (text, exit_code) = known
        .as_ref()
        .ok()
        .and_then(|known| known.as_ref())
        .map_or(("error: the memory budget is used up", 3), |(text, exit_code)| (text.as_str(), *exit_code));
    let mut stderr = std::io::stderr();
    let _ = stderr.write_all(text.as_bytes());
    let _ = stderr.write_all(b"\n");
    process::exit(exit_code)
}

#[expect(unsafe_code, reason = "an allocator is unsafe by its trait; every call goes to the inner one unchanged")]
// SAFETY: every method forwards its arguments to an allocator that fulfils the contract, and returns what that returns.
// Counting allocates nothing and does not unwind.
unsafe impl<A: GlobalAlloc> GlobalAlloc for Budgeted<A> {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        // SAFETY: as promised by the caller.
        unsafe { self.0.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        // SAFETY: as promised by the caller.
        unsafe { self.0.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as i64));
        // SAFETY: as promised by the caller.
        unsafe { self.0.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        count(new_size as i64 - layout.size() as i64);
        // SAFETY: as promised by the caller.
        unsafe { self.0.realloc(pointer, layout, new_size) }
    }
}
