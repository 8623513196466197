//! Kernels: ray/triangle intersection methods, each one file, written once over a lane type.
//!
//! A kernel owns the precision and alone decides what is a hit. It packs triangles for its own test, prepares a ray
//! once, and answers for `W` triangles at a time. Kernels know nothing of structures, of other triangles, or of which
//! hit is the nearest.
//!
//! To add one: a file here, and a row in `kernels!` below.

use std::fmt::Debug;

use serde::Serialize;

use crate::geometry::lanes::{Lane, LaneMask, LaneRay, LaneVec3};
use crate::geometry::{DVec3, Hit, Ray, Vec3};
use crate::registry::{Choice, ChoiceError, ParamSpec};
use crate::scene::Mesh;

mod badouel;
mod baldwin_weber;
mod corners;
mod error;
pub mod exact;
mod havel_herout;
mod kensler_shirley;
mod known;
mod moller_trumbore;
mod moller_trumbore_f64;
mod pbrt;
mod plucker;
mod prepared;
mod shear;
mod sheet;
mod sheet_signed;
mod sheet_unsigned;
mod woop;

pub use badouel::Badouel;
pub use baldwin_weber::BaldwinWeber;
pub use corners::Corners;
pub use exact::Exact;
pub use havel_herout::HavelHerout;
pub use kensler_shirley::KenslerShirley;
pub use moller_trumbore::MollerTrumbore;
pub use moller_trumbore_f64::MollerTrumboreF64;
pub use pbrt::Pbrt;
pub use plucker::Plucker;
pub use prepared::PreparedRay;
pub use sheet_signed::SheetSigned;
pub use sheet_unsigned::SheetUnsigned;
pub use woop::Woop;

/// What a kernel answers for `W` triangles.
#[derive(Debug, Clone, Copy)]
pub struct LaneHit<const W: usize, L: Lane<W>, R = ()> {
    /// Which lanes are hit, whatever their `t`.
    pub mask: L::Mask,
    /// Ray parameter; meaningless where `mask` is false.
    pub t: L,
    /// Barycentric weight of vertex 1; meaningless where `mask` is false.
    pub u: L,
    /// Barycentric weight of vertex 2; meaningless where `mask` is false.
    pub v: L,
    /// See [`Kernel::Rest`].
    rest: R,
}

impl<const W: usize, L: Lane<W>> LaneHit<W, L> {
    /// Without a rest.
    #[inline(always)]
    fn new(mask: L::Mask, t: L, u: L, v: L) -> Self {
        Self {
            mask,
            t,
            u,
            v,
            rest: (),
        }
    }
}

impl<const W: usize, L: Lane<W>, R> LaneHit<W, L, R> {
    /// That of one lane, on the triangle `prim`.
    #[inline(always)]
    pub(crate) fn of_lane(&self, lane: usize, prim: u32) -> Hit {
        Hit {
            t: self.t.get(lane),
            u: self.u.get(lane),
            v: self.v.get(lane),
            prim,
        }
    }

    /// The lanes that are hit at a `t` within these intervals. Both ends belong to them, NaN to none.
    #[inline(always)]
    pub(crate) fn within(&self, t_min: L, t_max: L) -> L::Mask {
        self.mask & self.t.ge(t_min) & self.t.le(t_max)
    }

    /// These lanes only; `None` if there are none.
    #[inline(always)]
    fn only_within(self, [t_min, t_max]: [L; 2]) -> Option<Self> {
        let mask = self.within(t_min, t_max);
        mask.any().then_some(Self { mask, ..self })
    }
}

/// A ray/triangle intersection method.
pub trait Kernel: Debug + Clone + Send + Sync + 'static {
    /// `W` triangles in the form that the test reads.
    type Packed<const W: usize>: Debug + Clone + Send + Sync;
    /// A ray in the form that the test reads, made once a ray.
    type Prepared<const W: usize, L: Lane<W>>: PreparedRay<W, L, Self::Prepared<1, f32>>;
    /// What [`Kernel::t_error_bound`] reads of the test, where it would take long to compute it again.
    type Rest<const W: usize, L: Lane<W>>: Copy;

    /// Whether hits are compared more exactly than their `f32` `t` tells, by [`Kernel::within`] and [`Kernel::nearer`].
    const EXACT_T: bool = false;

    /// Packs the triangles whose corners `corners(lane)` gives.
    fn pack<const W: usize>(&self, corners: impl Fn(usize) -> [Vec3; 3]) -> Self::Packed<W>;

    /// One triangle of a block.
    fn lane(block: &Self::Packed<8>, lane: usize) -> Self::Packed<1>;

    /// Whether batches are traced in all ways, packets among them: what a block holds tells the corners, and the kernel is
    /// one that is chosen for its speed. All ways of all kernels would take the compiler twice as long.
    const PACKETS: bool = false;

    /// Whether the traversals of structures are compiled for it: a control need not be fast.
    const DIRECT: bool = true;

    /// The corners of a block's triangles, off by no more than a rounding of an edge; asked only where
    /// [`Kernel::PACKETS`] says so.
    #[must_use]
    fn corners<L: Lane<8>>(_: &Self::Packed<8>) -> [LaneVec3<L>; 3] {
        [LaneVec3::splat(Vec3::ZERO); 3]
    }

    /// Prepares valid rays, one a lane: the same in each, or several that are tested together, of which `lead` is one.
    fn prepare<const W: usize, L: Lane<W>>(
        &self,
        lead: &Ray,
        rays: &LaneRay<L>,
    ) -> Self::Prepared<W, L>;

    /// Tests the whole lines of the rays against the triangles, lane by lane; `None` only if no lane is hit.
    ///
    /// The caller compares `t` with the rays' intervals, see [`Kernel::within`]. A NaN `t` is never accepted.
    fn intersect<const W: usize, L: Lane<W>>(
        &self,
        ray: &Self::Prepared<W, L>,
        triangles: &Self::Packed<W>,
    ) -> Option<LaneHit<W, L, Self::Rest<W, L>>>;

    /// As [`Kernel::intersect`], of hits at a `t` within these intervals, both ends of which belong to them. Here a kernel may do
    /// without branches but the last: of rays that begin on a surface every second one has a triangle on its line, behind it or
    /// where it begins, and a branch is guessed wrong as often.
    #[inline(always)]
    fn intersect_within<const W: usize, L: Lane<W>>(
        &self,
        ray: &Self::Prepared<W, L>,
        triangles: &Self::Packed<W>,
        interval: [L; 2],
    ) -> Option<LaneHit<W, L, Self::Rest<W, L>>> {
        self.intersect(ray, triangles)?.only_within(interval)
    }

    /// A bound on the absolute error of the `t` that this kernel computed for one triangle it accepted.
    ///
    /// Traversals stop only beyond `t + t_error`, so an error of the kernel never makes them miss a nearer triangle.
    /// Asked once an accepted hit, not once a test. May be infinite, never NaN.
    fn t_error(&self, ray: &Ray, corners: &[Vec3; 3], t: f32) -> f32;

    /// A bound as that of [`Kernel::t_error`], for the hits of each lane: quickly found from what the test reads, and larger;
    /// infinite where it does not know, as in lanes that are not hit.
    #[inline(always)]
    fn t_error_bound<const W: usize, L: Lane<W>>(
        _: &Self::Prepared<W, L>,
        _triangles: &Self::Packed<W>,
        _hit: &LaneHit<W, L, Self::Rest<W, L>>,
    ) -> L {
        L::splat(f32::INFINITY)
    }

    /// Whether `hit`, which this kernel found on the ray's line, lies within the ray's interval. Both ends belong to it.
    #[inline(always)]
    fn within(&self, _: &Mesh, ray: &Ray, hit: &Hit) -> bool {
        hit.t >= ray.t_min && hit.t <= ray.t_max
    }

    /// Whether `new` is to be preferred to `best`, which may be [`Hit::MISS`]: nearer, or as near with a lower index.
    #[inline(always)]
    fn nearer(&self, _: &Mesh, _: &Ray, new: &Hit, best: &Hit) -> bool {
        // A miss has t = infinity and the highest index, so it loses to every hit, even one at infinity.
        new.t < best.t || (new.t == best.t && new.prim < best.prim)
    }
}

/// A row of the kernel registry.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct KernelEntry {
    /// Kebab-case name.
    pub name: &'static str,
    /// One sentence.
    pub about: &'static str,
    /// Where it was published.
    pub paper: &'static str,
    /// Whether no ray slips between triangles that share an edge or vertex.
    pub watertight: bool,
    /// Whether it shows a known mistake: an exhibit, chosen only by name, and no method to use.
    pub control: bool,
    /// Bytes kept for each triangle.
    pub bytes_per_triangle: usize,
    /// What one test costs: multiplications, additions, divisions.
    pub operations: &'static str,
    /// Where it is known to fail.
    pub known_failures: &'static str,
    /// Parameters.
    pub params: &'static [ParamSpec],
}

/// The corners as they are; those of a triangle without area all moved into the first, where every test misses it.
///
/// A test that rounds would hit such a triangle where its determinant is a rounding error instead of 0. Area is decided
/// in `f64`, which is exact unless the corners' exponents lie more than 29 apart.
#[inline(always)]
fn with_area(corners: [Vec3; 3]) -> [Vec3; 3] {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    if (b - a).cross(c - a) == DVec3::ZERO {
        [corners[0]; 3]
    } else {
        corners
    }
}

/// One lane of rows of eight.
fn lane_of<const ROWS: usize>(rows: &[[f32; 8]; ROWS], lane: usize) -> [[f32; 1]; ROWS] {
    rows.map(|row| [row[lane & 7]])
}

/// Three rows of `W` components from one vector a lane.
fn rows<const W: usize>(vector: impl Fn(usize) -> Vec3) -> [[f32; W]; 3] {
    let [rows] = rows_of(|lane| [vector(lane)]);
    rows
}

/// Three rows of `W` components from each of `N` vectors a lane. A loop that is compiled into its caller: packing is a fifth
/// of building a tree.
#[inline(always)]
fn rows_of<const N: usize, const W: usize>(
    vectors: impl Fn(usize) -> [Vec3; N],
) -> [[[f32; W]; 3]; N] {
    let mut all = [[[0.0; W]; 3]; N];
    for lane in 0..W {
        for (rows, vector) in all.iter_mut().zip(vectors(lane)) {
            for (row, x) in rows.iter_mut().zip(vector.to_array()) {
                row[lane] = x;
            }
        }
    }
    all
}

/// Something that is done with a kernel whose type is known.
pub trait KernelUser {
    /// What it gives.
    type Out;
    /// Does it.
    fn with<K: Kernel>(self, kernel: K) -> Self::Out;
}

/// Makes [`KERNELS`] and [`dispatch`] from one row a kernel.
macro_rules! kernels {
    ($($kernel:ty),* $(,)?) => {
        /// All kernels, in the order in which they are listed.
        pub const KERNELS: &[KernelEntry] = &[$(<$kernel>::ENTRY),*];

        /// Hands the kernel that `choice` names to `user`: the one place where a name becomes a type.
        ///
        /// # Errors
        /// `choice` names no kernel.
        pub fn dispatch<U: KernelUser>(choice: &Choice, user: U) -> Result<U::Out, ChoiceError> {
            match choice.name.as_str() {
                $(name if name == <$kernel>::ENTRY.name => Ok(user.with(<$kernel>::from_params(&choice.params))),)*
                name => Err(ChoiceError::unknown("kernel", name, KERNELS.iter().map(|k| k.name))),
            }
        }
    };
}

kernels![
    SheetSigned<false>,
    SheetSigned<true>,
    SheetUnsigned<false>,
    SheetUnsigned<true>,
    MollerTrumbore<false>,
    MollerTrumboreF64,
    Badouel,
    KenslerShirley,
    BaldwinWeber,
    HavelHerout,
    Plucker,
    Woop<false>,
    Pbrt,
    Exact,
    Woop<true>,
    MollerTrumbore<true>,
];

/// The rows of [`KERNELS`] that are methods to use: all but the controls.
pub fn methods() -> impl Iterator<Item = &'static KernelEntry> {
    KERNELS.iter().filter(|k| !k.control)
}

/// Reads `name` or `name:key=value…`.
///
/// # Errors
/// An unknown name, parameter or value.
pub fn parse(text: &str) -> Result<Choice, ChoiceError> {
    Choice::parse("kernel", text, KERNELS.iter().map(|k| (k.name, k.params)))
}

/// The row that `choice` names.
#[must_use]
pub fn entry(choice: &Choice) -> Option<&'static KernelEntry> {
    KERNELS.iter().find(|k| k.name == choice.name)
}
