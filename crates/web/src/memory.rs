//! How texts pass between the page and this module: the only code with raw memory.
//!
//! The page gets memory by `allocate`, writes its question there and calls `ask`. The answer's address and length come back
//! in one number; the page copies it and frees it by `release`. Written by hand because it is so short:
//! no generated code, and no second tool whose version must match.
#![allow(unsafe_code)]

/// Memory for `length` bytes.
#[unsafe(no_mangle)]
pub extern "C" fn allocate(length: usize) -> *mut u8 {
    Box::into_raw(vec![0_u8; length].into_boxed_slice()).cast()
}

/// Frees `length` bytes.
///
/// # Safety
/// `at` and `length` come from `allocate` or `ask`, and are not freed twice.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn release(at: *mut u8, length: usize) {
    // SAFETY: the caller's promise; both functions hand out boxed slices.
    drop(unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(at, length)) });
}

/// Answers the question of `length` bytes at `at`, and frees it. The answer's address is in the upper 32 bits,
/// its length in the lower ones.
///
/// # Safety
/// `at` and `length` come from `allocate`, and the page has written UTF-8 there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ask(at: *mut u8, length: usize) -> u64 {
    #[cfg(target_family = "wasm")]
    std::panic::set_hook(Box::new(|panic| say(0, &panic.to_string())));
    // SAFETY: the caller's promise.
    let bytes = unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(at, length)) };
    let answer = crate::answer(&String::from_utf8_lossy(&bytes)).into_bytes().into_boxed_slice();
    let length = answer.len() as u64;
    (Box::into_raw(answer).cast::<u8>() as u64) << 32 | length
}

/// Progress for the waiting page.
pub fn progress(words: &str) {
    say(1, words);
}

#[cfg(target_family = "wasm")]
fn say(kind: u32, words: &str) {
    #[link(wasm_import_module = "page")]
    unsafe extern "C" {
        fn hear(kind: u32, at: *const u8, length: usize);
    }
    // SAFETY: the page reads the words before it returns.
    unsafe { hear(kind, words.as_ptr(), words.len()) };
}

#[cfg(not(target_family = "wasm"))]
fn say(_: u32, _: &str) {}
