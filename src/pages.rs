//! Huge pages for large buffers: a hint to the system, nothing that a result depends on.
//!
//! A sum over a stencil reads 16 places far apart; with pages of 4 kB most of them need a walk through the page tables first, once a field
//! is larger than what the processor keeps of these.

/// Bytes from which on a buffer is worth a hint: two huge pages of x86-64.
const LARGE: usize = 4 << 20;

/// Asks for huge pages for the memory of `buffer`, before it is written first. Systems without them, or without any to give, go on as
/// without the hint.
pub fn prefer_huge<T>(buffer: &mut Vec<T>) {
    let bytes = buffer.capacity().saturating_mul(size_of::<T>());
    if bytes >= LARGE {
        advise(buffer.as_mut_ptr().cast(), bytes);
    }
}

#[cfg(target_os = "linux")]
fn advise(start: *mut u8, bytes: usize) {
    // Whole pages, of the largest size that Linux has on any machine; a buffer's ragged ends do without.
    const PAGE: usize = 1 << 16;
    let skip = start.align_offset(PAGE);
    if let Some(whole) = bytes.checked_sub(skip).map(|bytes| bytes & !(PAGE - 1)) {
        // SAFETY: the range lies in a buffer that is the caller's alone, and the advice changes what no program can read.
        unsafe { libc::madvise(start.wrapping_add(skip).cast(), whole, libc::MADV_HUGEPAGE) };
    }
}

#[cfg(not(target_os = "linux"))]
fn advise(_start: *mut u8, _bytes: usize) {}
