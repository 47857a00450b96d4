//! Pointers from C, checked before they become references.

use crate::{Error, Result};
use std::ffi::{CStr, c_char};
use std::path::PathBuf;

fn check<T>(pointer: *const T, name: &str) -> Result<()> {
    if pointer.is_null() {
        return Err(Error::InvalidArgument(format!("{name} is NULL; it is required")));
    }
    if !pointer.is_aligned() {
        return Err(Error::InvalidArgument(format!(
            "{name} is at address {pointer:p}, which is not a multiple of {}",
            align_of::<T>()
        )));
    }
    Ok(())
}

/// The object behind `pointer`.
///
/// # Safety
/// `pointer` is NULL or points to a `T` that lives, and is not written to, for `'a`.
pub(super) unsafe fn object<'a, T>(pointer: *const T, name: &str) -> Result<&'a T> {
    check(pointer, name)?;
    // SAFETY: not NULL and aligned; the rest is the caller's promise.
    Ok(unsafe { &*pointer })
}

/// [`object`], with `None` for NULL: an input that need not be given.
///
/// # Safety
/// As for [`object`].
pub(super) unsafe fn object_or_none<'a, T>(pointer: *const T, name: &str) -> Result<Option<&'a T>> {
    // SAFETY: the caller's promise.
    if pointer.is_null() { Ok(None) } else { unsafe { object(pointer, name) }.map(Some) }
}

/// The place behind `pointer`.
///
/// # Safety
/// `pointer` is NULL or points to a `T` that lives, and is used by no one else, for `'a`.
pub(super) unsafe fn place<'a, T>(pointer: *mut T, name: &str) -> Result<&'a mut T> {
    check(pointer, name)?;
    // SAFETY: not NULL and aligned; the rest is the caller's promise.
    Ok(unsafe { &mut *pointer })
}

fn check_array<T>(pointer: *const T, len: usize, name: &str) -> Result<()> {
    check(pointer, name)?;
    match len.checked_mul(size_of::<T>()).and_then(|bytes| isize::try_from(bytes).ok()) {
        Some(_) => Ok(()),
        None => Err(Error::InvalidArgument(format!("{name} is said to have {len} entries, more than memory can hold"))),
    }
}

/// `len` entries at `pointer`, which may be NULL when there are none.
///
/// # Safety
/// `pointer` is NULL or points to `len` entries that live, and are not written to, for `'a`.
pub(super) unsafe fn array<'a, T>(pointer: *const T, len: usize, name: &str) -> Result<&'a [T]> {
    if len == 0 {
        return Ok(&[]);
    }
    check_array(pointer, len, name)?;
    // SAFETY: not NULL, aligned, of a size that a slice may have; the rest is the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(pointer, len) })
}

/// [`array`], with `None` for NULL: an input that need not be given.
///
/// # Safety
/// As for [`array`].
pub(super) unsafe fn array_or_none<'a, T>(pointer: *const T, len: usize, name: &str) -> Result<Option<&'a [T]>> {
    // SAFETY: the caller's promise.
    if pointer.is_null() { Ok(None) } else { unsafe { array(pointer, len, name) }.map(Some) }
}

/// Numbers and arrays of them: whatever bytes C hands over are a value, so that it need not have written them.
///
/// # Safety
/// Every pattern of bits is a value of `Self`.
pub(super) unsafe trait Plain {}

// SAFETY: plain numbers.
unsafe impl Plain for u8 {}
// SAFETY: as above.
unsafe impl Plain for i32 {}
// SAFETY: as above.
unsafe impl Plain for u32 {}
// SAFETY: as above.
unsafe impl Plain for usize {}
// SAFETY: as above.
unsafe impl Plain for f64 {}
// SAFETY: an array has no padding.
unsafe impl<T: Plain, const N: usize> Plain for [T; N] {}

/// `len` places at `pointer`, which may be NULL when there are none. What stands in them is for no one to read.
///
/// # Safety
/// `pointer` is NULL or points to `len` entries that live, and are used by no one else, for `'a`.
pub(super) unsafe fn array_mut<'a, T: Plain>(pointer: *mut T, len: usize, name: &str) -> Result<&'a mut [T]> {
    if len == 0 {
        return Ok(&mut []);
    }
    check_array(pointer, len, name)?;
    // SAFETY: not NULL, aligned, of a size that a slice may have; the rest is the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, len) })
}

/// [`array_mut`], with `None` for NULL: an output that is not wanted.
///
/// # Safety
/// As for [`array_mut`].
pub(super) unsafe fn wanted<'a, T: Plain>(pointer: *mut T, len: usize, name: &str) -> Result<Option<&'a mut [T]>> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's promise.
    unsafe { array_mut(pointer, len, name) }.map(Some)
}

/// What [`place`] will refuse of an output that is NULL where it is not wanted: asked before work whose result goes there.
pub(super) fn check_wanted_place<T>(to: *const T, name: &str) -> Result<()> {
    if to.is_null() { Ok(()) } else { check(to, name) }
}

/// Writes `value` to `to`, where it is wanted.
///
/// # Safety
/// `to` is NULL or a place to write that no one else uses.
pub(super) unsafe fn tell<T>(to: *mut T, value: T) -> Result<()> {
    if !to.is_null() {
        // SAFETY: the caller's promise.
        *unsafe { place(to, "an output") }? = value;
    }
    Ok(())
}

/// The path in the C string at `pointer`.
///
/// # Safety
/// `pointer` is NULL or points to a NUL-terminated string.
pub(super) unsafe fn path(pointer: *const c_char, name: &str) -> Result<PathBuf> {
    check(pointer, name)?;
    // SAFETY: not NULL; the rest is the caller's promise.
    let text = unsafe { CStr::from_ptr(pointer) };
    if text.is_empty() {
        return Err(Error::InvalidArgument(format!("{name} is empty; the name of a file is needed")));
    }
    path_of(text, name)
}

#[cfg(unix)]
fn path_of(text: &CStr, _name: &str) -> Result<PathBuf> {
    use std::os::unix::ffi::OsStrExt;
    Ok(std::ffi::OsStr::from_bytes(text.to_bytes()).into())
}

#[cfg(not(unix))]
fn path_of(text: &CStr, name: &str) -> Result<PathBuf> {
    match text.to_str() {
        Ok(text) => Ok(text.into()),
        Err(_) => Err(Error::InvalidArgument(format!("{name} is not UTF-8"))),
    }
}

/// Sets the handle at `out` to NULL, and later, on success, to a new object.
///
/// # Safety
/// `out` is NULL or points to a handle that no one else uses.
pub(super) unsafe fn create<T>(out: *mut *mut T, name: &str, make: impl FnOnce() -> Result<T>) -> Result<()> {
    // SAFETY: the caller's promise.
    let out = unsafe { place(out, name) }?;
    *out = std::ptr::null_mut();
    *out = Box::into_raw(Box::new(make()?));
    Ok(())
}

/// [`create`] of several objects that are made at once.
///
/// # Safety
/// As for [`create`], of each.
pub(super) unsafe fn create_all<T, const N: usize>(
    outs: [(*mut *mut T, &str); N],
    make: impl FnOnce() -> Result<[T; N]>,
) -> Result<()> {
    for (out, name) in outs {
        // SAFETY: the caller's promise.
        *unsafe { place(out, name) }? = std::ptr::null_mut();
    }
    for ((out, name), made) in outs.into_iter().zip(make()?) {
        // SAFETY: as above.
        *unsafe { place(out, name) }? = Box::into_raw(Box::new(made));
    }
    Ok(())
}

/// Frees an object made by [`create`]; NULL is taken.
///
/// # Safety
/// `pointer` is NULL or came from [`create`] and was not freed.
pub(super) unsafe fn free<T>(pointer: *mut T) {
    if !pointer.is_null() {
        // SAFETY: the caller's promise.
        drop(unsafe { Box::from_raw(pointer) });
    }
}

/// Plain structs shared with C that begin with their own size and may grow at their end.
///
/// # Safety
/// `Self` is `repr(C)`, starts with a `usize`, has no padding, and every pattern of bits is a value of it.
pub(super) unsafe trait Sized_: Copy {
    /// Size in the first version that had the struct: no caller knows less. What is smaller is a mistake, such as the size of a pointer.
    const FIRST_SIZE: usize;
}

/// Copies the struct at `from`, whose first field tells how much of it the caller knows, over `defaults`.
///
/// # Safety
/// `from` points to a struct of as many readable bytes as its first field says.
pub(super) unsafe fn read_sized<T: Sized_>(from: *const T, defaults: T, name: &str) -> Result<T> {
    check(from, name)?;
    // SAFETY: the first field is a usize, by the trait's promise.
    let size = unsafe { from.cast::<usize>().read() };
    check_size::<T>(size, name)?;
    let mut value = defaults;
    // SAFETY: both are as long as the part that is copied, and any bits are a value.
    unsafe { from.cast::<u8>().copy_to_nonoverlapping((&raw mut value).cast(), size.min(size_of::<T>())) };
    // A caller with a newer header may ask for what this library does not know.
    for i in size_of::<T>()..size {
        // SAFETY: `size` bytes are readable, by the caller's promise.
        if unsafe { from.cast::<u8>().add(i).read() } != 0 {
            return Err(Error::Unsupported(format!(
                "{name} sets a field at byte {i} that this library does not know; it was made for a newer one"
            )));
        }
    }
    Ok(value)
}

/// [`read_sized`], with `defaults` for NULL.
///
/// # Safety
/// `from` is NULL or points to a struct of as many readable bytes as its first field says.
pub(super) unsafe fn read_sized_or<T: Sized_>(from: *const T, defaults: T, name: &str) -> Result<T> {
    if from.is_null() {
        return Ok(defaults);
    }
    // SAFETY: the caller's promise.
    unsafe { read_sized(from, defaults, name) }
}

/// Writes `value` to `to`, as much of it as the caller knows; what the caller knows beyond it becomes 0.
///
/// # Safety
/// `to` points to `size` writable bytes.
pub(super) unsafe fn write_sized<T: Sized_>(to: *mut T, size: usize, value: T, name: &str) -> Result<()> {
    check_sized(to, size, name)?;
    // SAFETY: `size` bytes are writable, by the caller's promise; the value is copied as far as both reach.
    unsafe {
        to.cast::<u8>().write_bytes(0, size);
        (&raw const value).cast::<u8>().copy_to_nonoverlapping(to.cast(), size.min(size_of::<T>()));
        to.cast::<usize>().write(size);
    }
    Ok(())
}

/// What [`write_sized`] will refuse: asked before work whose result goes there. The struct may be smaller than a `T`, so that there is no
/// reference to it.
pub(super) fn check_sized<T: Sized_>(to: *const T, size: usize, name: &str) -> Result<()> {
    check(to, name)?;
    check_size::<T>(size, name)
}

/// [`check_sized`] of a struct that is NULL where it is not wanted.
pub(super) fn check_wanted_sized<T: Sized_>(to: *const T, size: usize, name: &str) -> Result<()> {
    if to.is_null() { Ok(()) } else { check_sized(to, size, name) }
}

/// No version of a struct is smaller than the first, and none will ever have a page.
fn check_size<T: Sized_>(size: usize, name: &str) -> Result<()> {
    const LARGEST: usize = 4096;
    if (T::FIRST_SIZE..=LARGEST).contains(&size) {
        return Ok(());
    }
    Err(Error::InvalidArgument(format!(
        "{name} has struct_size {size}; it must be sizeof the struct, {} here: initialise it first",
        size_of::<T>()
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A struct that grew by its last field since its first version.
    #[derive(Clone, Copy)]
    #[repr(C)]
    struct Grown {
        struct_size: usize,
        first: u64,
        later: u64,
    }

    // SAFETY: repr(C), starts with a usize, plain numbers without padding.
    unsafe impl Sized_ for Grown {
        const FIRST_SIZE: usize = std::mem::offset_of!(Grown, later);
    }

    const DEFAULTS: Grown = Grown { struct_size: 0, first: 1, later: 2 };

    #[test]
    fn callers_of_the_first_version_are_served_with_their_part() {
        let mut to = Grown { struct_size: 0, first: 0, later: 7 };
        // SAFETY: `to` has these bytes.
        unsafe { write_sized(&raw mut to, Grown::FIRST_SIZE, DEFAULTS, "to") }.unwrap();
        assert_eq!((to.struct_size, to.first, to.later), (Grown::FIRST_SIZE, 1, 7));
        to.first = 5;
        // SAFETY: as above.
        let read = unsafe { read_sized(&raw const to, DEFAULTS, "to") }.unwrap();
        assert_eq!((read.first, read.later), (5, 2));
    }

    #[test]
    fn the_size_of_a_pointer_is_refused() {
        let mut to = DEFAULTS;
        // SAFETY: `to` has these bytes.
        let wrong = unsafe { write_sized(&raw mut to, size_of::<*const Grown>(), DEFAULTS, "to") };
        assert!(matches!(wrong, Err(Error::InvalidArgument(text)) if text.contains("struct_size 8")));
    }
}
