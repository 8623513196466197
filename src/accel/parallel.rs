//! What builders do over threads, on the pool they are called in.
//!
//! ```text
//! map(count, grain, make)     | make(0) make(1) … | make(grain) … | …     a task a grain, results in order
//! chunks(slice, size, work)   | work(chunk 0)     | work(chunk 1) | …
//! ```
//!
//! An iterator of rayon is compiled anew, thousands of lines each time, for every closure that it is given; with kernels among
//! the types that was a tenth of what the compiler had to do. Here the tasks are behind a pointer, and it is compiled once.

#![expect(
    unsafe_code,
    reason = "results are written where they stay, by several threads"
)]

use std::mem::MaybeUninit;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::pages;

/// The grain for what is made in nanoseconds: a call and a lock are nothing beside so many.
pub(super) const MANY: usize = 1024;

/// Does `task` for each number below `count`.
fn each(count: usize, task: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(task);
}

/// What `make` gives for each number below `count`, in huge pages where they are many; `grain` by one thread after another.
pub(super) fn map<T: Send>(count: usize, grain: usize, make: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let mut made = pages::with_capacity(count);
    extend(&mut made, count, grain, make);
    made
}

/// Appends what [`map`] gives. What was made when `make` panics is never dropped.
pub(super) fn extend<T: Send>(
    all: &mut Vec<T>,
    count: usize,
    grain: usize,
    make: impl Fn(usize) -> T + Sync,
) {
    all.reserve_exact(count);
    let grain = grain.max(1);
    let room = &mut all.spare_capacity_mut()[..count];
    let parts: Vec<Mutex<&mut [MaybeUninit<T>]>> = room.chunks_mut(grain).map(Mutex::new).collect();
    each(parts.len(), &|part| {
        let first = part * grain;
        let mut places = parts[part].lock().unwrap_or_else(PoisonError::into_inner);
        for (i, place) in places.iter_mut().enumerate() {
            place.write(make(first + i));
        }
    });
    drop(parts);
    // SAFETY: `each` has returned, so each part was gone through, and all of its places were written.
    unsafe { all.set_len(all.len() + count) };
}

/// What `work` gives for each chunk of `slice`, in their order: a task a chunk.
pub(super) fn chunks<T: Sync, U: Send>(
    slice: &[T],
    size: usize,
    work: impl Fn(&[T]) -> U + Sync,
) -> Vec<U> {
    ranges(slice.len(), size, |range| work(&slice[range]))
}

/// As [`chunks`], of the numbers below `count`.
pub(super) fn ranges<U: Send>(
    count: usize,
    size: usize,
    work: impl Fn(Range<usize>) -> U + Sync,
) -> Vec<U> {
    map(count.div_ceil(size), 1, |chunk| {
        let first = chunk * size;
        work(first..count.min(first + size))
    })
}

/// As many copies of `value`. In parallel, since the first touch of a page takes longer than writing it.
pub(super) fn filled<T: Copy + Send + Sync>(count: usize, value: T) -> Vec<T> {
    map(count, MANY, |_| value)
}

#[cfg(test)]
mod tests {
    use std::panic::catch_unwind;

    use super::*;

    #[test]
    fn results_come_in_order_whatever_the_grain() {
        for count in [0, 1, 7, 1000] {
            for grain in [0, 1, 3, MANY] {
                let squares: Vec<String> = map(count, grain, |i| (i * i).to_string());
                assert!(
                    squares
                        .iter()
                        .enumerate()
                        .all(|(i, x)| *x == (i * i).to_string())
                );
                assert_eq!(squares.len(), count);
            }
        }
        assert!(filled(2500, 7).iter().eq(std::iter::repeat_n(&7, 2500)));
    }

    #[test]
    fn what_is_appended_comes_behind_what_was_there() {
        let mut all = vec![5, 6];
        extend(&mut all, 3, 2, |i| i);
        assert_eq!(all, [5, 6, 0, 1, 2]);
    }

    #[test]
    fn chunks_are_those_of_the_slice() {
        let slice: Vec<u32> = (0..100).collect();
        for size in [1, 7, 100, 1000] {
            let expected: Vec<Vec<u32>> = slice.chunks(size).map(<[u32]>::to_vec).collect();
            assert_eq!(chunks(&slice, size, <[u32]>::to_vec), expected);
        }
        assert!(chunks(&[0_u8; 0], 4, <[u8]>::len).is_empty());
    }

    #[test]
    fn a_panic_reaches_the_caller() {
        let made = catch_unwind(|| map(100, 8, |i| assert_ne!(i, 50)));
        assert!(made.is_err());
    }
}
