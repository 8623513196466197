//! Eight and sixteen lanes in registers of AVX-512, with masks in mask registers.
//!
//! Made only inside [`super::InstructionSet::run`], which is entered after the processor was asked; see [`super::isa`].

#![expect(
    unsafe_code,
    reason = "vector instructions; entered only where the processor has them"
)]

use std::arch::x86_64::{
    __m128i, __m256, __m256i, __m512, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm_loadu_ps,
    _mm_mask_blend_epi32, _mm_max_epu32, _mm_min_epu32, _mm_shuffle_epi32, _mm_storeu_ps,
    _mm_storeu_si128, _mm256_add_ps, _mm256_and_si256, _mm256_andnot_ps, _mm256_castps_si256,
    _mm256_castsi128_si256, _mm256_castsi256_si128, _mm256_cmp_ps_mask, _mm256_cmpeq_epi32_mask,
    _mm256_cvtss_f32, _mm256_div_ps, _mm256_fmadd_ps, _mm256_fmsub_ps, _mm256_loadu_ps,
    _mm256_loadu_si256, _mm256_mask_blend_epi32, _mm256_mask_blend_ps, _mm256_maskz_compress_epi32,
    _mm256_maskz_compress_ps, _mm256_max_epu32, _mm256_max_ps, _mm256_min_epu32, _mm256_min_ps,
    _mm256_mul_ps, _mm256_or_si256, _mm256_permutevar8x32_epi32, _mm256_permutexvar_ps,
    _mm256_set1_epi32, _mm256_set1_ps, _mm256_setr_epi32, _mm256_sqrt_ps, _mm256_storeu_ps,
    _mm256_storeu_si256, _mm256_sub_ps, _mm256_xor_ps, _mm512_add_ps, _mm512_andnot_ps,
    _mm512_castps_si512, _mm512_castps128_ps512, _mm512_cmp_ps_mask, _mm512_cmpeq_epi32_mask,
    _mm512_cvtss_f32, _mm512_div_ps, _mm512_extractf32x4_ps, _mm512_fmadd_ps, _mm512_fmsub_ps,
    _mm512_insertf32x4, _mm512_loadu_ps, _mm512_mask_blend_ps, _mm512_max_ps, _mm512_min_ps,
    _mm512_mul_ps, _mm512_permutexvar_ps, _mm512_reduce_min_ps, _mm512_set1_epi32, _mm512_set1_ps,
    _mm512_shuffle_ps, _mm512_sqrt_ps, _mm512_storeu_ps, _mm512_sub_ps, _mm512_unpackhi_ps,
    _mm512_unpacklo_ps, _mm512_xor_ps,
};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::isa::LANE_BITS;
use super::rows::transpose_quarters;
use super::{HitLanes, Lane, LaneMask, RayLanes, SIXTEEN};
use crate::geometry::{Hit, Ray};

macro_rules! lanes {
    (
        $numbers:ident($register:ty), $mask:ident($bits:ty), $n:literal, triangles $w:literal,
        load $load:expr, $set1:ident $loadu:ident $storeu:ident $add:ident $sub:ident $mul:ident $div:ident
        $fma:ident $fms:ident $max:ident $min:ident $xor:ident $andnot:ident $sqrt:ident $blend:ident $cmp:ident
        $cast:ident $same:ident $first:ident $permute:ident $places:ident
        $(, $least:item)?
    ) => {
        #[doc = concat!(stringify!($n), " `f32`.")]
        #[derive(Debug, Clone, Copy)]
        pub struct $numbers(pub(super) $register);

        #[doc = concat!(stringify!($n), " truth values, one a bit.")]
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub struct $mask(pub(super) $bits);

        lanes!(@binary $numbers Add add $add);
        lanes!(@binary $numbers Sub sub $sub);
        lanes!(@binary $numbers Mul mul $mul);
        lanes!(@binary $numbers Div div $div);

        impl Neg for $numbers {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                // SAFETY: AVX-512 was detected before any such value was made.
                Self(unsafe { $xor(self.0, $set1(-0.0)) })
            }
        }

        impl BitAnd for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, other: Self) -> Self {
                Self(self.0 & other.0)
            }
        }

        impl BitOr for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitor(self, other: Self) -> Self {
                Self(self.0 | other.0)
            }
        }

        impl Not for $mask {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(!self.0)
            }
        }

        impl LaneMask for $mask {
            #[inline(always)]
            fn bits(self) -> u32 {
                u32::from(self.0)
            }
        }

        impl Lane<$w> for $numbers {
            type Mask = $mask;

            const N: usize = $n;

            #[inline(always)]
            fn splat(x: f32) -> Self {
                // SAFETY: AVX-512 was detected; see the module. So for all below.
                Self(unsafe { $set1(x) })
            }
            #[inline(always)]
            fn load(xs: &[f32; $w]) -> Self {
                $load(xs)
            }
            #[inline(always)]
            fn from_fn(number: impl FnMut(usize) -> f32) -> Self {
                let all: [f32; $n] = std::array::from_fn(number);
                // SAFETY: all its numbers are read, without asking for alignment.
                Self(unsafe { $loadu(all.as_ptr()) })
            }
            #[inline(always)]
            fn get(self, lane: usize) -> f32 {
                // SAFETY: as above; what is beyond the lanes counts from 0 again.
                unsafe { $first($permute($places(lane as i32), self.0)) }
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                // SAFETY: FMA was detected too.
                Self(unsafe { $fma(self.0, factor.0, term.0) })
            }
            #[inline(always)]
            fn mul_sub_freely(self, factor: Self, term: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $fms(self.0, factor.0, term.0) })
            }
            #[inline(always)]
            fn mul_add_freely(self, factor: Self, term: Self) -> Self {
                self.mul_add(factor, term)
            }
            #[inline(always)]
            fn write(self, room: &mut [f32]) {
                if let Some(room) = room.first_chunk_mut::<$n>() {
                    // SAFETY: there is room for all numbers.
                    unsafe { $storeu(room.as_mut_ptr(), self.0) };
                }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $max(self.0, other.0) })
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $min(self.0, other.0) })
            }
            $($least)?
            #[inline(always)]
            fn abs(self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $andnot($set1(-0.0), self.0) })
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $sqrt(self.0) })
            }
            #[inline(always)]
            fn select(mask: $mask, a: Self, b: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $blend(mask.0, b.0, a.0) })
            }
            #[inline(always)]
            fn lt(self, other: Self) -> $mask {
                // SAFETY: as above.
                $mask(unsafe { $cmp::<_CMP_LT_OQ>(self.0, other.0) })
            }
            #[inline(always)]
            fn le(self, other: Self) -> $mask {
                // SAFETY: as above.
                $mask(unsafe { $cmp::<_CMP_LE_OQ>(self.0, other.0) })
            }
            #[inline(always)]
            fn eq(self, other: Self) -> $mask {
                // SAFETY: as above.
                $mask(unsafe { $cmp::<_CMP_EQ_OQ>(self.0, other.0) })
            }
            #[inline(always)]
            fn same_bits(self, other: Self) -> $mask {
                // SAFETY: as above.
                $mask(unsafe { $same($cast(self.0), $cast(other.0)) })
            }
        }
    };
    (@binary $numbers:ident $trait:ident $method:ident $op:ident) => {
        impl $trait for $numbers {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: AVX-512 was detected before any such value was made.
                Self(unsafe { $op(self.0, other.0) })
            }
        }
    };
}

lanes!(
    F32x8(__m256), Mask8(u8), 8, triangles 8,
    // SAFETY: AVX was detected; eight numbers are there, alignment is not asked for.
    load |xs: &[f32; 8]| F32x8(unsafe { _mm256_loadu_ps(xs.as_ptr()) }),
    _mm256_set1_ps _mm256_loadu_ps _mm256_storeu_ps _mm256_add_ps _mm256_sub_ps _mm256_mul_ps _mm256_div_ps
    _mm256_fmadd_ps _mm256_fmsub_ps _mm256_max_ps _mm256_min_ps _mm256_xor_ps _mm256_andnot_ps _mm256_sqrt_ps _mm256_mask_blend_ps _mm256_cmp_ps_mask
    _mm256_castps_si256 _mm256_cmpeq_epi32_mask _mm256_cvtss_f32 _mm256_permutexvar_ps _mm256_set1_epi32
);

lanes!(
    F32x16(__m512), Mask16(u16), 16, triangles 1,
    load |xs: &[f32; 1]| F32x16::splat(xs[0]),
    _mm512_set1_ps _mm512_loadu_ps _mm512_storeu_ps _mm512_add_ps _mm512_sub_ps _mm512_mul_ps _mm512_div_ps
    _mm512_fmadd_ps _mm512_fmsub_ps _mm512_max_ps _mm512_min_ps _mm512_xor_ps _mm512_andnot_ps _mm512_sqrt_ps _mm512_mask_blend_ps _mm512_cmp_ps_mask
    _mm512_castps_si512 _mm512_cmpeq_epi32_mask _mm512_cvtss_f32 _mm512_permutexvar_ps _mm512_set1_epi32,
    #[inline(always)]
    fn least(self) -> f32 {
        // SAFETY: as above.
        unsafe { _mm512_reduce_min_ps(self.0) }
    }
);

/// See [`super::Isa::rays`].
#[inline(always)]
pub(super) fn rays(rays: &[Ray; SIXTEEN]) -> RayLanes<F32x16> {
    RayLanes::of_columns(columns::<0>(rays), columns::<4>(rays))
}

/// Four numbers of each ray, from number `AT` on: a register each.
#[inline(always)]
fn columns<const AT: usize>(rays: &[Ray; SIXTEEN]) -> [F32x16; 4] {
    /// Those numbers of a ray and of every fourth after it.
    macro_rules! quarters {
        ($numbers:expr, $ray:literal) => {{
            let first = _mm512_castps128_ps512(_mm_loadu_ps($numbers.add(8 * $ray)));
            let two = _mm512_insertf32x4::<1>(first, _mm_loadu_ps($numbers.add(8 * ($ray + 4))));
            let three = _mm512_insertf32x4::<2>(two, _mm_loadu_ps($numbers.add(8 * ($ray + 8))));
            _mm512_insertf32x4::<3>(three, _mm_loadu_ps($numbers.add(8 * ($ray + 12))))
        }};
    }
    // SAFETY: AVX-512 was detected; a ray is eight numbers, and those from `AT` to `AT` + 4 of sixteen rays are read.
    unsafe {
        let numbers = rays.as_ptr().cast::<f32>().add(AT);
        let [a, b, c, d] = transpose_quarters!(
            _mm512_unpacklo_ps _mm512_unpackhi_ps _mm512_shuffle_ps,
            quarters!(numbers, 0),
            quarters!(numbers, 1),
            quarters!(numbers, 2),
            quarters!(numbers, 3)
        );
        [F32x16(a), F32x16(b), F32x16(c), F32x16(d)]
    }
}

/// See [`super::Isa::hits`].
#[inline(always)]
pub(super) fn hits(lanes: &HitLanes<F32x16>, hits: &mut [Hit; SIXTEEN]) {
    // SAFETY: AVX-512 was detected; a hit is four numbers, and those of sixteen are written.
    unsafe {
        let numbers = hits.as_mut_ptr().cast::<f32>();
        let rows = transpose_quarters!(
            _mm512_unpacklo_ps _mm512_unpackhi_ps _mm512_shuffle_ps,
            lanes.t.0,
            lanes.u.0,
            lanes.v.0,
            lanes.prim.0
        );
        for (hit, row) in rows.into_iter().enumerate() {
            // Of every fourth hit from this one on.
            let place = numbers.add(4 * hit);
            _mm_storeu_ps(place, _mm512_extractf32x4_ps::<0>(row));
            _mm_storeu_ps(place.add(16), _mm512_extractf32x4_ps::<1>(row));
            _mm_storeu_ps(place.add(32), _mm512_extractf32x4_ps::<2>(row));
            _mm_storeu_ps(place.add(48), _mm512_extractf32x4_ps::<3>(row));
        }
    }
}

/// See [`super::Isa::greatest_first`]: the keys are compressed to the front and sorted by a network, of four where four
/// suffice, and the values are permuted by the lanes' numbers that the keys carry.
#[inline(always)]
pub(super) fn greatest_first(
    keys: F32x8,
    met: u32,
    values: &[u32; 8],
    sorted_values: &mut [u32; 8],
    sorted_keys: &mut [f32; 8],
) {
    // SAFETY: AVX-512 was detected; loads and stores stay within eight numbers and ask for no alignment.
    unsafe {
        let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        let cleared = _mm256_and_si256(
            _mm256_castps_si256(keys.0),
            _mm256_set1_epi32(!(LANE_BITS as i32)),
        );
        let keyed = _mm256_maskz_compress_epi32(met as u8, _mm256_or_si256(cleared, lanes));
        let values = _mm256_loadu_si256(values.as_ptr().cast());
        if met.count_ones() <= 4 {
            let sorted = sort_four(_mm256_castsi256_si128(keyed));
            let permuted = _mm256_permutevar8x32_epi32(values, _mm256_castsi128_si256(sorted));
            _mm_storeu_si128(
                sorted_values.as_mut_ptr().cast(),
                _mm256_castsi256_si128(permuted),
            );
            _mm_storeu_si128(sorted_keys.as_mut_ptr().cast(), sorted);
        } else {
            let sorted = sort_eight(keyed);
            let permuted = _mm256_permutevar8x32_epi32(values, sorted);
            _mm256_storeu_si256(sorted_values.as_mut_ptr().cast(), permuted);
            _mm256_storeu_si256(sorted_keys.as_mut_ptr().cast(), sorted);
        }
    }
}

/// See [`super::Isa::compress`].
#[inline(always)]
pub(super) fn compress(
    keys: F32x8,
    met: u32,
    values: &[u32; 8],
    compressed_values: &mut [u32; 8],
    compressed_keys: &mut [f32; 8],
) {
    // SAFETY: AVX-512 was detected; loads and stores stay within eight numbers and ask for no alignment.
    unsafe {
        let values = _mm256_loadu_si256(values.as_ptr().cast());
        let values = _mm256_maskz_compress_epi32(met as u8, values);
        let keys = _mm256_maskz_compress_ps(met as u8, keys.0);
        _mm256_storeu_si256(compressed_values.as_mut_ptr().cast(), values);
        _mm256_storeu_ps(compressed_keys.as_mut_ptr(), keys);
    }
}

/// One stage of a network: each number meets its `partner`; the greater stays where `lesser` has no bit.
macro_rules! stage {
    ($blend:ident, $max:ident, $min:ident, $numbers:expr, $partner:expr, $lesser:literal) => {
        $blend($lesser, $max($numbers, $partner), $min($numbers, $partner))
    };
}

/// Sorts four numbers, the greatest first.
#[inline(always)]
unsafe fn sort_four(k: __m128i) -> __m128i {
    // SAFETY: the caller's.
    unsafe {
        macro_rules! meet {
            ($k:expr, $shuffle:literal, $lesser:literal) => {
                stage!(
                    _mm_mask_blend_epi32,
                    _mm_max_epu32,
                    _mm_min_epu32,
                    $k,
                    _mm_shuffle_epi32::<$shuffle>($k),
                    $lesser
                )
            };
        }
        let k = meet!(k, 0b10_11_00_01, 0b1010);
        let k = meet!(k, 0b01_00_11_10, 0b1100);
        let partner = _mm_shuffle_epi32::<0b11_01_10_00>(k);
        let middle = _mm_mask_blend_epi32(0b0010, k, _mm_max_epu32(k, partner));
        _mm_mask_blend_epi32(0b0100, middle, _mm_min_epu32(k, partner))
    }
}

/// Sorts eight numbers by a bitonic network, the greatest first.
#[inline(always)]
unsafe fn sort_eight(k: __m256i) -> __m256i {
    // SAFETY: the caller's.
    unsafe {
        macro_rules! meet {
            ($k:expr, $partner:expr, $lesser:literal) => {
                stage!(
                    _mm256_mask_blend_epi32,
                    _mm256_max_epu32,
                    _mm256_min_epu32,
                    $k,
                    _mm256_permutevar8x32_epi32($k, $partner),
                    $lesser
                )
            };
        }
        let neighbour = _mm256_setr_epi32(1, 0, 3, 2, 5, 4, 7, 6);
        let k = meet!(k, neighbour, 0b1010_1010);
        let k = meet!(k, _mm256_setr_epi32(3, 2, 1, 0, 7, 6, 5, 4), 0b1100_1100);
        let k = meet!(k, neighbour, 0b1010_1010);
        let k = meet!(k, _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0), 0b1111_0000);
        let k = meet!(k, _mm256_setr_epi32(2, 3, 0, 1, 6, 7, 4, 5), 0b1100_1100);
        meet!(k, neighbour, 0b1010_1010)
    }
}
