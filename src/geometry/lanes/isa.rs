//! Instruction sets: which lanes a batch of rays is traced with, chosen when the program runs.
//!
//! ```text
//! InstructionSet::best() ── run(task) ──> the processor is asked ──> one function compiled for the set ──> task.run::<Avx512>()
//! ```
//!
//! In lane code a closure that is called more than once, or passed to `array::map`, may be left out of line and is then
//! compiled for no set, ten times slower: write it as a function with `#[inline(always)]`.
//!
//! A [`Task`] is inlined whole into the function that is compiled for a set, so all of its arithmetic is. The types of a
//! set's lanes can be named only through [`Isa`], and a task gets one only from [`InstructionSet::run`]: that is why the
//! lanes may rely on the processor.
//!
//! **Differs** from the usual tokens: there is no value to carry, the type parameter is the proof.

#![cfg_attr(
    target_arch = "x86_64",
    expect(
        unsafe_code,
        reason = "functions compiled for what the processor was found to have"
    )
)]

use std::fmt::{self, Display};

use super::{F32x8, HitLanes, Lane, Ones, Pair, RayLanes, SIXTEEN};
use crate::geometry::{Hit, Ray};

#[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
use super::{avx2, avx512};

/// What is compiled once for each instruction set.
pub trait Task {
    /// What it gives.
    type Out;
    /// Does it. Implementations are `#[inline(always)]`, else they are compiled for no set at all.
    fn run<I: Isa>(self) -> Self::Out;
}

/// The lanes of an instruction set.
pub trait Isa: Copy + Send + Sync + 'static {
    /// A number for each of eight triangles or boxes.
    type X8: Lane<8>;
    /// A number for each of the sixteen rays of a packet.
    type Rays: Lane<1>;

    /// Whether numbers of sixteen rays are quickly computed with, so that packets and groups of them are worth compiling.
    const SIXTEEN: bool = true;

    /// Runs `task`, with these lanes, in a function compiled for them: from code that knows the set but is compiled for none.
    fn enter<T: Task>(task: T) -> T::Out;

    /// Sorts the lanes whose bit is set in `met` by key, the greatest first, and writes their `values` and `keys` to the
    /// front of the two rooms; what lies behind is overwritten with anything.
    ///
    /// Keys are not negative. Their last three bits are taken for the lane's number, so equal keys have an order, the same
    /// on every instruction set.
    fn greatest_first(
        keys: Self::X8,
        met: u32,
        values: &[u32; 8],
        sorted_values: &mut [u32; 8],
        sorted_keys: &mut [f32; 8],
    );

    /// Sixteen rays, a lane each.
    #[must_use]
    #[inline(always)]
    fn rays(rays: &[Ray; SIXTEEN]) -> RayLanes<Self::Rays> {
        RayLanes::gathered(rays)
    }

    /// Writes sixteen hits.
    #[inline(always)]
    fn hits(lanes: &HitLanes<Self::Rays>, hits: &mut [Hit; SIXTEEN]) {
        lanes.scattered(hits);
    }

    /// Writes the `values` and `keys` of the lanes whose bit is set in `met` to the front of the two rooms, in the order of
    /// the lanes; what lies behind is overwritten with anything.
    #[inline(always)]
    fn compress(
        keys: Self::X8,
        met: u32,
        values: &[u32; 8],
        compressed_values: &mut [u32; 8],
        compressed_keys: &mut [f32; 8],
    ) {
        let places = compressed_values.iter_mut().zip(compressed_keys);
        for ((value, key), lane) in places.zip(Ones(met)) {
            (*value, *key) = (values[lane & 7], keys.get(lane & 7));
        }
    }
}

/// Lanes in plain Rust, right on every processor.
#[derive(Debug, Clone, Copy)]
pub struct Portable;

/// AVX2 and FMA.
#[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
#[derive(Debug, Clone, Copy)]
pub struct Avx2;

/// AVX-512 F, VL, BW and DQ.
#[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
#[derive(Debug, Clone, Copy)]
pub struct Avx512;

/// The bits of a key that hold the lane's number.
pub(super) const LANE_BITS: u32 = 7;

impl Isa for Portable {
    type X8 = F32x8;
    type Rays = Pair<F32x8>;

    // Where there is better, this is only the judge of it, and compiled sooner without.
    const SIXTEEN: bool = !cfg!(target_arch = "x86_64");

    #[inline(always)]
    fn enter<T: Task>(task: T) -> T::Out {
        task.run::<Self>()
    }

    #[inline(always)]
    fn greatest_first(
        keys: F32x8,
        met: u32,
        values: &[u32; 8],
        sorted_values: &mut [u32; 8],
        sorted_keys: &mut [f32; 8],
    ) {
        let mut sorted = [0_u32; 8];
        let mut count = 0;
        for lane in Ones(met) {
            let key = keys.get(lane).to_bits() & !LANE_BITS | lane as u32;
            let mut at = count;
            while at > 0 && sorted[at - 1] < key {
                sorted[at] = sorted[at - 1];
                at -= 1;
            }
            sorted[at] = key;
            count += 1;
        }
        for (i, key) in sorted[..count].iter().enumerate() {
            sorted_values[i] = values[(key & LANE_BITS) as usize];
            sorted_keys[i] = f32::from_bits(*key);
        }
    }
}

#[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
impl Isa for Avx2 {
    type X8 = avx2::F32x8;
    type Rays = Pair<avx2::F32x8>;

    #[inline(always)]
    fn enter<T: Task>(task: T) -> T::Out {
        // SAFETY: whoever can name these lanes was called by a task that `InstructionSet::run` began.
        unsafe { with_avx2(task) }
    }

    #[inline(always)]
    fn greatest_first(
        keys: avx2::F32x8,
        met: u32,
        values: &[u32; 8],
        sorted_values: &mut [u32; 8],
        sorted_keys: &mut [f32; 8],
    ) {
        avx2::greatest_first(keys, met, values, sorted_values, sorted_keys);
    }

    #[inline(always)]
    fn rays(rays: &[Ray; SIXTEEN]) -> RayLanes<Self::Rays> {
        avx2::rays(rays)
    }
}

#[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
impl Isa for Avx512 {
    type X8 = avx512::F32x8;
    type Rays = avx512::F32x16;

    #[inline(always)]
    fn enter<T: Task>(task: T) -> T::Out {
        // SAFETY: whoever can name these lanes was called by a task that `InstructionSet::run` began.
        unsafe { with_avx512(task) }
    }

    #[inline(always)]
    fn greatest_first(
        keys: avx512::F32x8,
        met: u32,
        values: &[u32; 8],
        sorted_values: &mut [u32; 8],
        sorted_keys: &mut [f32; 8],
    ) {
        avx512::greatest_first(keys, met, values, sorted_values, sorted_keys);
    }

    #[inline(always)]
    fn rays(rays: &[Ray; SIXTEEN]) -> RayLanes<Self::Rays> {
        avx512::rays(rays)
    }

    #[inline(always)]
    fn hits(lanes: &HitLanes<Self::Rays>, hits: &mut [Hit; SIXTEEN]) {
        avx512::hits(lanes, hits);
    }

    #[inline(always)]
    fn compress(
        keys: avx512::F32x8,
        met: u32,
        values: &[u32; 8],
        compressed_values: &mut [u32; 8],
        compressed_keys: &mut [f32; 8],
    ) {
        avx512::compress(keys, met, values, compressed_values, compressed_keys);
    }
}

/// The instruction sets by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum InstructionSet {
    /// Plain Rust.
    Portable,
    /// AVX2 and FMA, on x86-64.
    Avx2,
    /// AVX-512 F, VL, BW and DQ, on x86-64.
    Avx512,
}

impl InstructionSet {
    /// All, the plainest first.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The best that this processor has.
    #[must_use]
    pub fn best() -> Self {
        let available = Self::ALL.into_iter().rev().find(|set| set.is_available());
        available.unwrap_or(Self::Portable)
    }

    /// Whether this processor has it and this build uses it: unoptimised ones use none, since they are built in order to be
    /// built soon, and compile everything once instead of once a set.
    #[must_use]
    pub fn is_available(self) -> bool {
        #[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
        {
            let avx2 = || {
                is_x86_feature_detected!("avx2")
                    && is_x86_feature_detected!("fma")
                    && is_x86_feature_detected!("bmi1")
            };
            match self {
                Self::Portable => true,
                Self::Avx2 => avx2(),
                Self::Avx512 => {
                    avx2()
                        && is_x86_feature_detected!("bmi2")
                        && is_x86_feature_detected!("popcnt")
                        && is_x86_feature_detected!("avx512f")
                        && is_x86_feature_detected!("avx512vl")
                        && is_x86_feature_detected!("avx512bw")
                        && is_x86_feature_detected!("avx512dq")
                }
            }
        }
        #[cfg(not(all(target_arch = "x86_64", not(debug_assertions))))]
        {
            self == Self::Portable
        }
    }

    /// Runs `task` with the lanes of this set, or of [`Portable`] where the processor lacks it.
    #[inline]
    pub fn run<T: Task>(self, task: T) -> T::Out {
        #[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
        if self != Self::Portable && self.is_available() {
            // SAFETY: the processor was just asked.
            return match self {
                Self::Avx512 => unsafe { with_avx512(task) },
                _ => unsafe { with_avx2(task) },
            };
        }
        task.run::<Portable>()
    }

    /// Its name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }
}

impl Display for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Compiled for AVX2. Only [`Lane::mul_add`] uses fused multiply-add: the compiler fuses nothing that is written apart.
#[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
#[target_feature(enable = "avx2,fma,bmi1")]
#[inline(never)]
fn with_avx2<T: Task>(task: T) -> T::Out {
    task.run::<Avx2>()
}

/// Compiled for AVX-512.
#[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt,avx512f,avx512vl,avx512bw,avx512dq")]
#[inline(never)]
fn with_avx512<T: Task>(task: T) -> T::Out {
    task.run::<Avx512>()
}

/// Asks for the first `lines` cache lines of what lies at `place`; never reads it, so any address will do.
#[inline(always)]
pub fn prefetch<T>(place: *const T, bytes: usize) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..bytes.div_ceil(64) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: SSE is part of x86-64, and a prefetch of any address is harmless.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(place.cast::<i8>().wrapping_add(64 * line)) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (place, bytes);
}
