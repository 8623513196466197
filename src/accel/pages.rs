//! Room for large arrays, in huge pages where the system offers them: a ray that jumps about in nodes and triangles then
//! misses the page table's cache less often.

/// An empty vector with room for `count`, which the system is asked to put into huge pages before it is first touched.
///
/// Small rooms are left alone. Where there are no huge pages this is [`Vec::with_capacity`].
pub(super) fn with_capacity<T>(count: usize) -> Vec<T> {
    let room = Vec::with_capacity(count);
    #[cfg(target_os = "linux")]
    advise(room.as_ptr() as usize, count * size_of::<T>());
    room
}

/// As many zeros, in such a room. None is written: fresh pages are zero.
pub(super) fn zeroed(count: usize) -> Vec<u8> {
    let zeros = vec![0; count];
    #[cfg(target_os = "linux")]
    advise(zeros.as_ptr() as usize, count);
    zeros
}

/// Asks for huge pages in the whole pages between `start` and `start + bytes`.
#[cfg(target_os = "linux")]
#[expect(
    unsafe_code,
    reason = "a call to the system that the standard library lacks"
)]
fn advise(start: usize, bytes: usize) {
    /// A huge page; less than one cannot become one.
    const HUGE: usize = 2 << 20;
    /// Start and length of what is advised are whole pages.
    const PAGE: usize = 4096;

    let first = start.next_multiple_of(PAGE);
    let end = (start + bytes) / PAGE * PAGE;
    if bytes >= HUGE && first < end {
        // SAFETY: the pages belong to this room, and the advice does not change what they hold. If the system refuses,
        // nothing happens.
        unsafe {
            libc::madvise(first as *mut libc::c_void, end - first, libc::MADV_HUGEPAGE);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rooms_of_any_size_hold_what_is_put_in() {
        for count in [0, 1, 1000, 3 << 20] {
            let mut room = with_capacity::<u32>(count);
            assert!(room.capacity() >= count);
            room.extend(0..count as u32);
            assert!(room.iter().copied().eq(0..count as u32));
            assert_eq!(zeroed(count), vec![0; count]);
        }
    }
}
