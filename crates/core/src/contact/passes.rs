//! Gauss-Seidel passes over contacts.

/// Largest number of passes.
const MAX_PASSES: usize = 20;

/// Calls `settle` for contacts, counted from 0, pass by pass, until nothing changes any more or the
/// number of passes reaches a limit. A contact is passed over while its parts, by their numbers
/// below `all`, stay as they were when it settled. `settle` returns whether it left them so.
pub(super) fn run<P: Iterator<Item = usize>>(
    contacts: usize,
    all: usize,
    parts: impl Fn(usize) -> P,
    mut settle: impl FnMut(usize) -> bool,
) {
    // Numbers of the updates that changed each part, and settled each contact, last.
    let mut changed = vec![1_u32; all];
    let mut settled = vec![0_u32; contacts];
    let mut now = 1;
    for _ in 0..MAX_PASSES {
        let mut is_still = true;
        for (k, settled) in settled.iter_mut().enumerate() {
            if parts(k).all(|part| changed[part] <= *settled) {
                continue;
            }
            now += 1;
            *settled = now;
            if !settle(k) {
                is_still = false;
                parts(k).for_each(|part| changed[part] = now);
            }
        }
        if is_still {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Springs between the points of a line, each of which is halved in turn: all points end at the
    /// mean, and nothing is visited once it is still.
    #[test]
    fn what_is_still_is_passed_over() {
        let mut x = [0.0, 1.0, 5.0, 5.0, 5.0, 5.0];
        let mut visits = [0; 5];
        run(
            5,
            6,
            |k| [k, k + 1].into_iter(),
            |k| {
                visits[k] += 1;
                let gap: f64 = x[k + 1] - x[k];
                if k >= 2 || gap == 0.0 {
                    return true;
                }
                x[k] += 0.5 * gap;
                x[k + 1] -= 0.5 * gap;
                gap.abs() < 1e-3
            },
        );
        assert!(x[..3].iter().all(|x| (x - 2.0).abs() < 1e-3), "{x:?}");
        assert!(visits[0] > 3 && visits[2] > 3, "{visits:?}");
        assert_eq!(visits[3..], [1, 1]);
    }
}
