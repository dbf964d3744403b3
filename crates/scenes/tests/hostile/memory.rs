//! Memory of a thread: how much at once, and how much in total.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// Allocator of the system that counts the bytes of each thread.
struct Counting;

thread_local! {
    static NOW: Cell<usize> = const { Cell::new(0) };
    static MOST: Cell<usize> = const { Cell::new(0) };
    static ALL: Cell<usize> = const { Cell::new(0) };
}

fn take(bytes: usize) {
    let now = NOW.get().wrapping_add(bytes);
    NOW.set(now);
    ALL.set(ALL.get() + bytes);
    // Memory of another thread may be freed here, so the count may be negative.
    if now as isize > MOST.get() as isize {
        MOST.set(now);
    }
}

#[expect(unsafe_code, reason = "an allocator cannot be written without")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        take(layout.size());
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        NOW.set(NOW.get().wrapping_sub(layout.size()));
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        NOW.set(NOW.get().wrapping_sub(layout.size()));
        take(size);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Returns the bytes that `run` allocates on this thread: the most at once, and the total.
pub fn taken(run: impl FnOnce()) -> [usize; 2] {
    let (now, all) = (NOW.get(), ALL.get());
    MOST.set(now);
    run();
    [MOST.get().wrapping_sub(now), ALL.get() - all]
}
