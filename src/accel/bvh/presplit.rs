//! The build with pre-splits: where it pays, spatial splits divide the top of the tree, and the binned build what is below.
//! Elsewhere the large nodes of the binned build move to better places, if there are any (see [`reinsert`]).
//!
//! ```text
//!   useless:  +--------+      a box pays for its surface, a triangle uses that of its shadows along the axes;
//!             |      / |      long triangles across the axes have much larger boxes
//!             |   /    |
//!             +--------+
//! ```
//!
//! Whether it pays is asked of a sample of the triangles: some of them must have boxes with much useless surface, beside the
//! scene and beside those of the others. Where triangles are even (Stanford bunny, armadillo, sphereflake, city, soup) none is
//! cut; what asking takes is not seen beside the build.
//!
//! **Source:** M. Ernst and G. Greiner, "Early Split Clipping for Bounding Volume Hierarchies", 2007, and T. Karras and
//! T. Aila, "Fast Parallel Construction of High-Quality Bounding Volume Hierarchies", HPG 2013, §4.3, for what a triangle's
//! box has too much; the splits are those of [`spatial`].
//! **Differs:** planes are chosen by the surface area heuristic, node by node, not taken from a grid over the scene.
//!
//! **What was tried:** Karras and Aila's splits of single triangles by planes of a grid, a sixth more references: on the
//! two-cylinder engine rays test a seventh fewer triangles but visit 1 to 4 % more nodes, on the Crytek Sponza a sixth more
//! nodes, since pieces along many planes still lie across each other. Few spatial splits at the top: engine and kitchen a sixth
//! and a fifth fewer nodes, for 15 and 10 % more references, which is nearly what `sbvh` has.

use crate::geometry::Vec3;
use crate::scene::Mesh;

use super::super::parallel;
use super::super::sah::half_area;
use super::spatial::{self, Effort};
use super::{BinaryTree, binned, reinsert};

/// How much larger than its share of the scene's surface the useless surface of a triangle's box must be.
const LARGE: f64 = 30.0;

/// How much larger than that of most others it must be, unless the triangle is a [`NEEDLE`]. Where all triangles are alike
/// each would be split, which saves little: rays of `soup:1000000` are as quick (bounce, random) or 2 % faster (primary)
/// for 1.5 times the build, those of `soup:100000,8` 3 to 5 % for 2.2 times.
const UNUSUAL: f64 = 3.0;

/// A triangle whose shadows are a smaller part of its box than this: its pieces have much smaller boxes than it has, even
/// together. Of soups one of 28 is one, of `plant` every other.
const NEEDLE: f64 = 0.1;

/// One of so many triangles must have such a box. Of the Stanford bunny, the armadillo and `sphereflake:4` none has, of
/// `city:300` one of 600, of the kitchen one of 36, of the Crytek Sponza one of 23, of the two-cylinder engine one of 11 and
/// of `plant` every other. Rays of the engine are then a tenth (bounce) and a fifth (random) faster, those of `plant` a
/// twentieth and a tenth; the kitchen's would be an eighth faster, but Sponza's a twelfth slower: the heuristic finds its
/// trees cheaper, its rays test a sixth more triangles. Nothing cheap was found that tells those two apart.
const RARE: usize = 16;

/// Triangles that are asked.
const SAMPLE: usize = 1 << 12;

/// A tree over `mesh` whose leaves hold at most `most` references each.
pub(super) fn build(mesh: &Mesh, most: usize) -> BinaryTree {
    if pays(mesh) {
        spatial::build(mesh, Effort::TOP, most)
    } else {
        let tree = binned::build(binned::references(mesh), most);
        reinsert::optimised(tree, reinsert::Work::TOP)
    }
}

/// Whether enough triangles have boxes with much useless surface. Decided by the mesh alone.
fn pays(mesh: &Mesh) -> bool {
    let count = mesh.len().min(SAMPLE);
    let waste = |i| Waste::of(mesh, sampled(i, mesh.len()));
    let mut asked = parallel::map(count, SAMPLE / 16, waste);
    asked.sort_unstable_by(|a, b| a.useless.total_cmp(&b.useless));
    let Some(median) = asked.get(count / 2) else {
        return false;
    };
    let (unusual, least) = (
        UNUSUAL * median.useless,
        LARGE * half_area(&mesh.bounds()) / mesh.len() as f64,
    );
    let is_large =
        |of: &&Waste| of.useless > least && (of.useless > unusual || of.is_of_a_needle());
    asked.iter().filter(is_large).count() * RARE > count
}

/// The `i`-th of the triangles that are asked, of so many: all where they are few, else spread over them without a period,
/// since those of a mesh often have one.
fn sampled(i: usize, count: usize) -> u32 {
    /// 2⁶⁴ over the golden ratio.
    const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
    if count <= SAMPLE {
        return i as u32;
    }
    let part = u128::from((i as u64).wrapping_mul(GOLDEN));
    ((part * count as u128) >> 64) as u32
}

/// Half the surface of a triangle's box.
struct Waste {
    /// That of the triangle's shadows along the axes, which no box of it can do without.
    shadows: f64,
    /// What the box has more; at least zero, but for rounding.
    useless: f64,
}

impl Waste {
    fn of(mesh: &Mesh, prim: u32) -> Self {
        let [a, b, c] = mesh.corners(prim).map(Vec3::as_dvec3);
        let shadows = 0.5 * (b - a).cross(c - a).abs().element_sum();
        Self {
            shadows,
            useless: half_area(&mesh.triangle_bounds(prim)) - shadows,
        }
    }

    fn is_of_a_needle(&self) -> bool {
        self.shadows < NEEDLE * (self.shadows + self.useless)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::testbed::{mesh, nasty, soup, sphere};
    use super::super::{Build, binary, grouped, validate};
    use super::*;
    use std::sync::Arc;

    /// Needles across the axes among small triangles.
    fn needles(count: u32, small: u32) -> Arc<Mesh> {
        let mut triangles = soup(small, 0.01, 1);
        triangles.extend(
            soup(count, 0.01, 2)
                .iter()
                .map(|t| [t[0], t[1], t[2] + Vec3::ONE]),
        );
        mesh(&triangles)
    }

    #[test]
    fn only_a_mesh_with_enough_large_boxes_is_split() {
        assert!(!pays(&mesh(&sphere(64))));
        assert!(!pays(&mesh(&soup(20_000, 0.01, 3))));
        assert!(!pays(&needles(20, 20_000)));
        assert!(!pays(&needles(1000, 20_000)));
        assert!(pays(&needles(2000, 20_000)));
        let even = mesh(&sphere(32));
        assert_eq!(
            binary(&even, Build::Presplit, 1),
            binary(&even, Build::Binned, 1)
        );
    }

    #[test]
    fn triangles_that_are_all_alike_are_split_only_where_they_are_needles() {
        // Edges of eight mean distances between triangles: boxes have hundreds of times their share of the surface.
        let alike = soup(20_000, 0.3, 4);
        assert!(!pays(&mesh(&alike)));
        let slimmed = |t: &[Vec3; 3]| [t[0], t[1], t[0] + (t[1] - t[0]) * 0.5];
        let needles: Vec<_> = alike.iter().map(slimmed).collect();
        assert!(pays(&mesh(&needles)));
    }

    #[test]
    fn a_tree_of_needles_costs_less_and_has_at_most_a_fifth_more_references() {
        let needles = needles(2000, 8000);
        let [plain, split] = [Build::Binned, Build::Presplit].map(|build| grouped(&needles, build));
        validate::validate(&split, &needles).expect("valid");
        assert!(split.references.len() > needles.len() + needles.len() / 20);
        assert!(split.references.len() <= needles.len() + needles.len() / 5);
        assert!(
            split.cost() < 0.9 * plain.cost(),
            "{} {}",
            split.cost(),
            plain.cost()
        );
    }

    #[test]
    fn trees_without_splits_cost_less_where_large_nodes_have_better_places_and_else_stay_as_they_were()
     {
        // Too few large triangles to split, but they lie across everything.
        let mut triangles = soup(20_000, 0.01, 1);
        triangles.extend(soup(100, 1.0, 2));
        let uneven = mesh(&triangles);
        assert!(!pays(&uneven));
        let [plain, moved] = [Build::Binned, Build::Presplit].map(|build| grouped(&uneven, build));
        validate::validate(&moved, &uneven).expect("valid");
        assert!(
            moved.cost() < 0.9 * plain.cost(),
            "{} {}",
            moved.cost(),
            plain.cost()
        );
        let sorted = |mut references: Vec<u32>| {
            references.sort_unstable();
            references
        };
        assert_eq!(sorted(moved.references), sorted(plain.references));
        let even = mesh(&sphere(64));
        assert_eq!(
            grouped(&even, Build::Presplit),
            grouped(&even, Build::Binned)
        );
    }

    #[test]
    fn the_sphereflake_stays_as_it_was_since_only_nodes_as_large_as_the_scene_could_be_spared() {
        let scene = crate::scene::load("sphereflake:3").unwrap();
        let [plain, same] =
            [Build::Binned, Build::Presplit].map(|build| grouped(&scene.mesh, build));
        // Not `assert_eq`, which would print both.
        assert!(plain == same);
    }

    #[test]
    fn useless_is_what_the_box_has_more_than_the_triangle() {
        let corners = [
            Vec3::ZERO,
            Vec3::new(2.0, 0.0, 0.0),
            Vec3::new(0.0, 3.0, 0.0),
        ];
        let flat = mesh(&[corners]);
        let flat = Waste::of(&flat, 0);
        assert!((flat.useless - 3.0).abs() < 1e-12 && !flat.is_of_a_needle());
        let diagonal = mesh(&[[Vec3::ZERO, Vec3::ZERO, Vec3::ONE]]);
        let diagonal = Waste::of(&diagonal, 0);
        assert!((diagonal.useless - 3.0).abs() < 1e-12 && diagonal.is_of_a_needle());
    }

    #[test]
    fn nasty_meshes_are_no_number_and_no_surface_without_harm() {
        for (name, mesh) in nasty() {
            for tree in [
                grouped(&mesh, Build::Presplit),
                spatial::build(&mesh, Effort::TOP, 8),
            ] {
                assert_eq!(validate::validate(&tree, &mesh), Ok(()), "{name}");
            }
        }
    }

    #[test]
    fn triangles_that_are_asked_are_all_or_spread_over_the_mesh() {
        assert!((0..SAMPLE).all(|i| sampled(i, SAMPLE) == i as u32));
        let mut eighths = [0; 8];
        for i in 0..SAMPLE {
            eighths[sampled(i, 8_000_000) as usize / 1_000_000] += 1;
        }
        assert!(eighths.iter().all(|&asked| asked > 500), "{eighths:?}");
    }
}
