//! Eight lanes in one register of AVX2.
//!
//! Made only inside [`super::InstructionSet::run`], which is entered after the processor was asked; see [`super::isa`].

#![expect(
    unsafe_code,
    reason = "vector instructions; entered only where the processor has them"
)]

use std::arch::x86_64::{
    __m256, __m256i, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm_loadu_ps, _mm256_add_epi32,
    _mm256_add_ps, _mm256_and_ps, _mm256_and_si256, _mm256_andnot_ps, _mm256_blend_epi32,
    _mm256_blendv_ps, _mm256_castps_si256, _mm256_castps128_ps256, _mm256_castsi256_ps,
    _mm256_cmp_ps, _mm256_cmpeq_epi32, _mm256_cvtss_f32, _mm256_div_ps, _mm256_fmadd_ps,
    _mm256_fmsub_ps, _mm256_insertf128_ps, _mm256_loadu_ps, _mm256_loadu_si256, _mm256_max_epu32,
    _mm256_max_ps, _mm256_min_epu32, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps,
    _mm256_or_ps, _mm256_or_si256, _mm256_permutevar8x32_epi32, _mm256_permutevar8x32_ps,
    _mm256_set1_epi32, _mm256_set1_ps, _mm256_setr_epi32, _mm256_shuffle_ps, _mm256_sllv_epi32,
    _mm256_sqrt_ps, _mm256_srai_epi32, _mm256_storeu_ps, _mm256_storeu_si256, _mm256_sub_epi32,
    _mm256_sub_ps, _mm256_unpackhi_ps, _mm256_unpacklo_ps, _mm256_xor_ps,
};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::isa::LANE_BITS;
use super::rows::transpose_quarters;
use super::{Lane, LaneMask, Pair, RayLanes, SIXTEEN};
use crate::geometry::Ray;

/// Eight `f32`.
#[derive(Debug, Clone, Copy)]
pub struct F32x8(pub(super) __m256);

/// Eight truth values, each all ones or all zeros.
#[derive(Debug, Clone, Copy)]
pub struct Mask8(__m256);

macro_rules! binary {
    ($($type:ident $trait:ident $method:ident $op:ident),*) => {$(
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: AVX was detected before any such value was made.
                Self(unsafe { $op(self.0, other.0) })
            }
        }
    )*};
}

binary!(
    F32x8 Add add _mm256_add_ps, F32x8 Sub sub _mm256_sub_ps, F32x8 Mul mul _mm256_mul_ps,
    F32x8 Div div _mm256_div_ps, Mask8 BitAnd bitand _mm256_and_ps, Mask8 BitOr bitor _mm256_or_ps
);

impl Neg for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_xor_ps(self.0, _mm256_set1_ps(-0.0)) })
    }
}

impl Not for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_xor_ps(self.0, _mm256_castsi256_ps(_mm256_set1_epi32(-1))) })
    }
}

impl LaneMask for Mask8 {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: as above.
        unsafe { _mm256_movemask_ps(self.0) as u32 }
    }
}

impl Lane<8> for F32x8 {
    type Mask = Mask8;

    const N: usize = 8;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: AVX was detected; see the module.
        Self(unsafe { _mm256_set1_ps(x) })
    }
    #[inline(always)]
    fn load(xs: &[f32; 8]) -> Self {
        // SAFETY: as above; eight numbers are there, alignment is not asked for.
        Self(unsafe { _mm256_loadu_ps(xs.as_ptr()) })
    }
    #[inline(always)]
    fn from_fn(number: impl FnMut(usize) -> f32) -> Self {
        Self::load(&std::array::from_fn(number))
    }
    #[inline(always)]
    fn get(self, lane: usize) -> f32 {
        // SAFETY: as above; what is beyond the lanes counts from 0 again.
        unsafe {
            let place = _mm256_set1_epi32(lane as i32);
            _mm256_cvtss_f32(_mm256_permutevar8x32_ps(self.0, place))
        }
    }
    #[inline(always)]
    fn write(self, room: &mut [f32]) {
        if let Some(room) = room.first_chunk_mut::<8>() {
            // SAFETY: as above; there is room for eight numbers.
            unsafe { _mm256_storeu_ps(room.as_mut_ptr(), self.0) };
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        // SAFETY: FMA was detected with AVX2.
        Self(unsafe { _mm256_fmadd_ps(self.0, factor.0, term.0) })
    }
    #[inline(always)]
    fn mul_sub_freely(self, factor: Self, term: Self) -> Self {
        // SAFETY: FMA was detected with AVX2.
        Self(unsafe { _mm256_fmsub_ps(self.0, factor.0, term.0) })
    }
    #[inline(always)]
    fn mul_add_freely(self, factor: Self, term: Self) -> Self {
        self.mul_add(factor, term)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_sqrt_ps(self.0) })
    }
    #[inline(always)]
    fn select(mask: Mask8, a: Self, b: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_blendv_ps(b.0, a.0, mask.0) })
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        // SAFETY: as above.
        Mask8(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        // SAFETY: as above.
        Mask8(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        // SAFETY: as above.
        Mask8(unsafe { _mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn same_bits(self, other: Self) -> Mask8 {
        // SAFETY: as above.
        Mask8(unsafe {
            _mm256_castsi256_ps(_mm256_cmpeq_epi32(
                _mm256_castps_si256(self.0),
                _mm256_castps_si256(other.0),
            ))
        })
    }
}

/// See [`super::Isa::rays`].
#[inline(always)]
pub(super) fn rays(rays: &[Ray; SIXTEEN]) -> RayLanes<Pair<F32x8>> {
    let [first, second] = [columns::<0>(rays, 0), columns::<0>(rays, 8)];
    let [first_dirs, second_dirs] = [columns::<4>(rays, 0), columns::<4>(rays, 8)];
    RayLanes::of_columns(paired(first, second), paired(first_dirs, second_dirs))
}

/// Columns of the first and of the last eight rays side by side.
#[inline(always)]
fn paired([a, b, c, d]: [F32x8; 4], [e, f, g, h]: [F32x8; 4]) -> [Pair<F32x8>; 4] {
    [Pair(a, e), Pair(b, f), Pair(c, g), Pair(d, h)]
}

/// Four numbers, from number `AT` on, of the eight rays from `first` on: a register each.
#[inline(always)]
fn columns<const AT: usize>(rays: &[Ray; SIXTEEN], first: usize) -> [F32x8; 4] {
    /// Those numbers of a ray and of the fourth after it.
    macro_rules! quarters {
        ($numbers:expr, $ray:literal) => {
            _mm256_insertf128_ps::<1>(
                _mm256_castps128_ps256(_mm_loadu_ps($numbers.add(8 * $ray))),
                _mm_loadu_ps($numbers.add(8 * ($ray + 4))),
            )
        };
    }
    let eight: &[Ray] = &rays[first..first + 8];
    // SAFETY: AVX was detected; a ray is eight numbers, and those from `AT` to `AT` + 4 of eight rays are read.
    unsafe {
        let numbers = eight.as_ptr().cast::<f32>().add(AT);
        transpose_quarters!(
            _mm256_unpacklo_ps _mm256_unpackhi_ps _mm256_shuffle_ps,
            quarters!(numbers, 0),
            quarters!(numbers, 1),
            quarters!(numbers, 2),
            quarters!(numbers, 3)
        )
        .map(F32x8)
    }
}

/// See [`super::Isa::greatest_first`]: keys of lanes that are not met become 0, less than any that is met but that of
/// lane 0 at key 0, which is told apart by a bit above the lane's number; a bitonic network sorts all eight.
#[inline(always)]
pub(super) fn greatest_first(
    keys: F32x8,
    met: u32,
    values: &[u32; 8],
    sorted_values: &mut [u32; 8],
    sorted_keys: &mut [f32; 8],
) {
    // SAFETY: AVX2 was detected; loads and stores stay within eight numbers and ask for no alignment.
    unsafe {
        let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        let cleared = _mm256_and_si256(
            _mm256_castps_si256(keys.0),
            _mm256_set1_epi32(!(LANE_BITS as i32)),
        );
        let keyed = _mm256_or_si256(cleared, lanes);
        // Lane i's bit of `met` is moved to the sign, and spread over the lane.
        let signs = _mm256_sllv_epi32(
            _mm256_set1_epi32(met as i32),
            _mm256_setr_epi32(31, 30, 29, 28, 27, 26, 25, 24),
        );
        let is_met = _mm256_srai_epi32::<31>(signs);
        // One more than every key: of those that are not met nothing stays, and a met key is never 0.
        let raised = _mm256_add_epi32(keyed, _mm256_set1_epi32(8));
        let sorted = sort_eight(_mm256_and_si256(raised, is_met));
        let permuted =
            _mm256_permutevar8x32_epi32(_mm256_loadu_si256(values.as_ptr().cast()), sorted);
        _mm256_storeu_si256(sorted_values.as_mut_ptr().cast(), permuted);
        let lowered = _mm256_sub_epi32(sorted, _mm256_set1_epi32(8));
        _mm256_storeu_si256(sorted_keys.as_mut_ptr().cast(), lowered);
    }
}

/// Sorts eight numbers by a bitonic network, the greatest first.
#[inline(always)]
unsafe fn sort_eight(k: __m256i) -> __m256i {
    /// One stage: each number meets its partner; the greater stays where the mask has no bit.
    macro_rules! meet {
        ($k:expr, $partner:expr, $lesser:literal) => {{
            let other = _mm256_permutevar8x32_epi32($k, $partner);
            _mm256_blend_epi32::<$lesser>(_mm256_max_epu32($k, other), _mm256_min_epu32($k, other))
        }};
    }
    // SAFETY: the caller's.
    unsafe {
        let neighbour = _mm256_setr_epi32(1, 0, 3, 2, 5, 4, 7, 6);
        let k = meet!(k, neighbour, 0b1010_1010);
        let k = meet!(k, _mm256_setr_epi32(3, 2, 1, 0, 7, 6, 5, 4), 0b1100_1100);
        let k = meet!(k, neighbour, 0b1010_1010);
        let k = meet!(k, _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0), 0b1111_0000);
        let k = meet!(k, _mm256_setr_epi32(2, 3, 0, 1, 6, 7, 4, 5), 0b1100_1100);
        meet!(k, neighbour, 0b1010_1010)
    }
}
