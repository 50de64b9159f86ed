//! The end of a program that gets no more memory.
//!
//! The runtime of Rust aborts where an allocation fails, without a word about the way out, and leaves what was half done. A
//! task that will not fit is refused beforehand where its need is known: `hsad::Error::NotEnoughMemory`.

use std::{
    alloc::{GlobalAlloc, Layout, System},
    io::{self, IsTerminal, Write},
    sync::atomic::{AtomicBool, Ordering},
};

use super::interruption;

/// The allocator of the system; ends the program with code 1 and one message if the system refuses memory.
pub struct Allocator;

/// Whether the program is ending, so that an allocation on the way is refused silently.
static ENDING: AtomicBool = AtomicBool::new(false);

// SAFETY: all calls go to the allocator of the system; the end of the program neither unwinds nor allocates.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as promised by the caller.
        given(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as promised by the caller.
        given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as promised by the caller.
        given(unsafe { System.realloc(memory, layout, size) }, size)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as promised by the caller.
        unsafe { System.dealloc(memory, layout) }
    }
}

/// `memory`, unless it was refused.
fn given(memory: *mut u8, bytes: usize) -> *mut u8 {
    if memory.is_null() && !ENDING.swap(true, Ordering::Relaxed) {
        end(bytes);
    }
    memory
}

#[cold]
fn end(bytes: usize) -> ! {
    let mut stderr = io::stderr();
    if stderr.is_terminal() {
        // The line may hold the progress so far.
        let _ = writeln!(stderr);
    }
    let _ = writeln!(
        stderr,
        "error: the system refuses {bytes} bytes of memory: scale the pictures down, search fewer disparities, or raise the \
         limit"
    );
    interruption::abandon_at_once(1)
}
