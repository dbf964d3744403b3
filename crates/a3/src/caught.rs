//! Panics in the code of dependencies, turned into errors.

use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};

/// The result of `work`, or `None` if it panics. The panic writes no message.
pub fn caught<T>(work: impl FnOnce() -> T) -> Option<T> {
    let hook = take_hook();
    set_hook(Box::new(|_| {}));
    let result = catch_unwind(AssertUnwindSafe(work));
    set_hook(hook);
    result.ok()
}
