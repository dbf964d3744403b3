//! Checks of a run while it takes its steps.

/// Number of checks during a run that holds.
const CHECKS: u64 = 200;

/// Takes `steps` steps and then 8 more, one by one: calls `check` with numbers of steps to take and
/// to check. Returns its result as soon as that is not `Some(true)`.
pub(super) fn take_checked(steps: u64, mut check: impl FnMut(u64) -> Option<bool>) -> Option<bool> {
    let mut left = steps;
    while left > 0 {
        let count = (steps / CHECKS).clamp(1, left);
        if !check(count)? {
            return Some(false);
        }
        left -= count;
    }
    for _ in 0..8 {
        if !check(1)? {
            return Some(false);
        }
    }
    Some(true)
}
