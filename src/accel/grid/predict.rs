//! What a grid will cost, in closed form, before it is built: references, steps, tests, and the n that costs least.
//!
//! One pass over the triangles sums, for each axis, their extents and projected areas. Then, with `n_i` cells of size
//! `h_i` along axis i, S the surface of the box and C a cell:
//!
//! ```text
//! references  R = N + Σ (planes crossed) + Σ (grid lines pierced) = N + Σ W_i/h_i + Σ A_i/(h_j·h_k)
//! steps of a random line    1 + Σ (n_i - 1)·2·L_j·L_k/S
//! references it meets       R·S_C/S                                  = its tests without mailboxes
//! triangles it meets        (2·ΣA + 1.2·Σ h_i·P_i + N·S_C)/S         = its tests with mailboxes
//! ```
//!
//! R is Euler's count: planes and the lines in which they meet cut a triangle into 1 + planes + lines pieces, one a
//! cell. The last line is the surface of triangle ⊕ cell (Steiner's formula; `P_i`: perimeter of the triangle seen along
//! axis i), with its edge term corrected: a line meets the cells that list a triangle about as often as that sum.
//!
//! **Source:** REFERENCE of the project, section 3; in a cube its optimum without mailboxes is the positive root of
//! n³ − c·(W·n + 2N) = 0, which contains n ∝ N^(1/3) (Cleary and Wyvill 1988) and n ∝ √W for long triangles (Ize,
//! Shirley and Parker 2007). **Differs:** few planes are counted as what they are (see `met_planes`), which is right at
//! small n as well; boxes instead of triangles where `overlap=bbox` lists those; tests with mailboxes; and the best n is
//! found by evaluating the model at every n, so the shape of the grid and flat axes are respected; of those as good the least
//! is taken.

use crate::accel::{MAX_N, Prediction};
use crate::geometry::{DVec3, Vec3};
use crate::scene::Mesh;

use super::lattice::pad;
use super::{Settings, lists};

/// Costs in units of a step: the median of what fits the times of rays best on seven meshes from 10 thousand to 100 thousand
/// triangles (scans, soups, cities, a sphereflake) with six n from 24 to 136 each, `woop`, one thread of an AMD EPYC with 1 MiB
/// of second-level cache. Primary rays, whose neighbours visit the same cells: a step 6 to 19 ns, a test 7 to 12, their ratio 0.4 to
/// 2; random rays, for whom the memory fetches both: 19 to 54 and 12 to 51, 0.3 to 1.3. In that cache alone, where a step takes
/// 7 ns, it is 1.5, and a look into the mailboxes 1 ns. The best n goes with the third root of the ratio, and its plateau is wide:
/// twice the ratio costs about 2 %.
const TEST_COST: f64 = 0.8;
const MAILBOX_COST: f64 = 0.15;

/// How much farther than half a cell the cells of a triangle reach beyond its edges, seen from a random side.
///
/// Half a cell is the mean over cells that touch the edge; the farthest of those seen one before another counts. Fitted:
/// with 1.2 the tests of random lines through spheres, soups and needles are within 3 % of the counted ones from n = 8
/// on, and within 5 % where cells are three times as long as wide.
const EDGE_REACH: f64 = 1.2;

/// n whose predicted cost is within this factor of the best are ties.
const PLATEAU: f64 = 1.05;

/// `--n auto` takes the least n that is predicted to cost at most this much more than the best. Rays of five meshes and three
/// cities could not tell them apart (primary, bounce and random: within what one run differs from the next), but n is a seventh
/// smaller, the cells are a third fewer, and `city:316` and `plant` are built in a seventh less time: finer grids list tall
/// triangles ever more often.
const SPARING: f64 = 1.02;

/// The predicted best n takes at most this much memory, plus so much a triangle, and never more than the last.
///
/// Where triangles cover each other, cells of any size list them all, and ever finer grids gain ever less; long thin
/// triangles are best served by thousands of bytes each.
const AUTO_BYTES: [u64; 3] = [64 << 20, 4 << 10, 1 << 30];

/// The sums over all triangles that the model needs.
#[derive(Debug, Clone, Copy)]
pub(in crate::accel) struct Model {
    settings: Settings,
    triangles: f64,
    extent: DVec3,
    /// Σ of the share of the box's edge that a triangle's box spans, on each axis.
    spans: DVec3,
    /// Σ over triangles of the share of the box's face across each axis that a triangle covers (`overlap=bbox`: its box).
    faces: DVec3,
    /// `overlap=bbox`: Σ of the share of the box's volume that a triangle's box fills; else 0.
    volume: f64,
    /// Σ of areas.
    area: f64,
    /// Σ of perimeters seen along each axis.
    perimeters: DVec3,
}

impl Model {
    /// Sums over the triangles of `mesh`, in file order.
    pub fn new(mesh: &Mesh, settings: Settings) -> Self {
        let bounds = mesh.bounds();
        let mut model = Self {
            settings,
            triangles: mesh.len() as f64,
            extent: DVec3::ZERO,
            spans: DVec3::ZERO,
            faces: DVec3::ZERO,
            volume: 0.0,
            area: 0.0,
            perimeters: DVec3::ZERO,
        };
        if bounds.is_empty() {
            return model;
        }
        let [min, max] = [bounds.min.as_dvec3(), bounds.max.as_dvec3()];
        model.extent = max - min;
        let shell = 2.0 * pad(min, max);
        for prim in 0..mesh.len() as u32 {
            model.add(mesh.corners(prim).map(Vec3::as_dvec3), shell);
        }
        model
    }

    /// Adds a triangle, all of whose extents the cells' shells enlarge by `shell`.
    fn add(&mut self, [a, b, c]: [DVec3; 3], shell: f64) {
        let span = a.max(b).max(c) - a.min(b).min(c);
        let share = ratio(span + shell, self.extent).min(DVec3::ONE);
        let normal = (b - a).cross(c - a) * 0.5;
        let faces_of_box = others(share);
        self.spans += share;
        if self.settings.lists_boxes() {
            self.faces += faces_of_box;
            self.volume += share.element_product();
        } else {
            // The shell enlarges the shadow by about its own width along the shadow's box.
            let rim = DVec3::new(span.y + span.z, span.z + span.x, span.x + span.y) * shell;
            let shadow = ratio(normal.abs() + rim, others(self.extent));
            self.faces += shadow.min(faces_of_box);
        }
        self.area += normal.length();
        for edge in [b - a, c - b, a - c] {
            let square = edge * edge;
            self.perimeters += DVec3::new(
                (square.y + square.z).sqrt(),
                (square.z + square.x).sqrt(),
                (square.x + square.y).sqrt(),
            );
        }
    }

    /// Cells along each axis at `n`.
    pub fn dims(&self, n: u32) -> [u32; 3] {
        self.settings.shape.dims(self.extent, n)
    }

    /// References at `n`.
    pub fn references(&self, n: u32) -> f64 {
        let planes = self.met_planes(n);
        self.triangles
            + planes.dot(self.spans)
            + others(planes).dot(self.faces)
            + planes.element_product() * self.volume
    }

    /// Number of triangles.
    pub fn triangles(&self) -> f64 {
        self.triangles
    }

    /// Cells at `n`.
    pub fn cells(&self, n: u32) -> u64 {
        // Saturating: an n far beyond `MAX_N` is refused with a size that is too low rather than a panic.
        self.dims(n)
            .iter()
            .fold(1_u64, |cells, &d| cells.saturating_mul(u64::from(d)))
    }

    /// Bytes of the grid at `n`.
    pub fn bytes(&self, n: u32) -> u64 {
        lists::bytes(self.cells(n), self.references(n).ceil() as u64)
    }

    /// Cells that a random line through the box visits at `n`.
    pub fn steps(&self, n: u32) -> f64 {
        1.0 + self.inner_planes(n).dot(others(self.extent)) * 2.0 * inverse(self.surface())
    }

    /// References in the cells that a random line visits at `n`.
    pub fn listed(&self, n: u32) -> f64 {
        let cell = self.cell(n);
        let surface = self.surface();
        // A box without surface: lines through it have no measure; one cell of all is met.
        let share = if surface > 0.0 {
            surface_of(cell) / surface
        } else {
            1.0 / self.dims(n).iter().map(|&d| f64::from(d)).product::<f64>()
        };
        self.references(n) * share
    }

    /// Tests of a random line at `n`.
    pub fn tests(&self, n: u32) -> f64 {
        let listed = self.listed(n);
        let surface = self.surface();
        if !self.settings.mailbox || self.settings.lists_boxes() || surface <= 0.0 {
            return listed;
        }
        let cell = self.cell(n);
        let met = 2.0 * self.area
            + EDGE_REACH * cell.dot(self.perimeters)
            + self.triangles * surface_of(cell);
        // A triangle is met at most once by every line, and at most as often as it is listed.
        (met / surface).min(listed).min(self.triangles)
    }

    /// Cost of a random line at `n`, in steps.
    pub fn cost(&self, n: u32) -> f64 {
        let looks = if self.settings.mailbox {
            self.listed(n) * MAILBOX_COST
        } else {
            0.0
        };
        self.steps(n) + looks + self.tests(n) * TEST_COST
    }

    /// The n that costs least, and the ends of the plateau around it where n cost at most 5 % more.
    pub fn best(&self) -> (u32, [u32; 2]) {
        let costs: Vec<f64> = (1..=self.largest_auto_n()).map(|n| self.cost(n)).collect();
        least(&costs)
    }

    /// The n that `--n auto` takes, see [`SPARING`], and the plateau.
    pub fn auto(&self) -> (u32, [u32; 2]) {
        let (best, plateau) = self.best();
        let most = self.cost(best) * SPARING;
        let as_good = (1..=best).rev().take_while(|&n| self.cost(n) <= most);
        (as_good.last().unwrap_or(best), plateau)
    }

    /// The greatest n that is considered for the best: see [`AUTO_BYTES`].
    pub fn largest_auto_n(&self) -> u32 {
        self.largest_n(self.auto_bytes()).max(1)
    }

    /// The greatest size of a structure with a predicted n: see [`AUTO_BYTES`].
    pub fn auto_bytes(&self) -> u64 {
        let [base, each, most] = AUTO_BYTES;
        most.min(base + self.triangles as u64 * each)
    }

    /// The greatest n up to [`MAX_N`] whose grid takes at most `bytes`; 0 if not even one cell fits.
    pub fn largest_n(&self, bytes: u64) -> u32 {
        (1..=MAX_N)
            .rev()
            .find(|&n| self.bytes(n) <= bytes)
            .unwrap_or(0)
    }

    /// All that is predicted of the grid that is `built` with this n.
    pub fn predict(&self, built: u32) -> Prediction {
        let (n, plateau) = self.auto();
        Prediction {
            n,
            plateau,
            references: self.references(built),
            steps: self.steps(built),
            tests: self.tests(built),
        }
    }

    /// The planes that matter to triangles: `span` of a box is crossed as if there were this many, evenly spread.
    ///
    /// How many triangles a plane crosses, as a function of its place, is 0 on both faces of the box, rises within a
    /// triangle's width and is level between. With cells narrower than triangles the trapezoid rule makes the sum over
    /// the inner planes n·span; with wider ones all inner planes lie where it is level: (n - 1)·span/(1 - span).
    fn met_planes(&self, n: u32) -> DVec3 {
        let level = DVec3::ONE - self.spans / self.triangles.max(1.0);
        let cells = DVec3::from_array(self.dims(n).map(f64::from));
        let wide = DVec3::from_array(std::array::from_fn(|a| {
            if level[a] > 0.0 {
                (cells[a] - 1.0) / level[a]
            } else {
                cells[a]
            }
        }));
        // Of one cell no plane is met, however wide the triangles.
        wide.min(cells) * DVec3::from_array(cells.to_array().map(|c| f64::from(u8::from(c > 1.0))))
    }

    fn inner_planes(&self, n: u32) -> DVec3 {
        DVec3::from_array(self.dims(n).map(|d| f64::from(d) - 1.0))
    }

    fn cell(&self, n: u32) -> DVec3 {
        self.extent / DVec3::from_array(self.dims(n).map(f64::from))
    }

    fn surface(&self) -> f64 {
        surface_of(self.extent)
    }
}

/// The n that costs least, where `costs` begin with n = 1, and the ends of the plateau around it where n cost at most 5 %
/// more. There is at least one.
pub(in crate::accel) fn least(costs: &[f64]) -> (u32, [u32; 2]) {
    let best = (0..costs.len()).fold(0, |b, i| if costs[i] < costs[b] { i } else { b });
    let tie = |i: &usize| costs[*i] <= costs[best] * PLATEAU;
    let first = (0..=best).rev().take_while(tie).last().unwrap_or(best);
    let last = (best..costs.len()).take_while(tie).last().unwrap_or(best);
    (best as u32 + 1, [first as u32 + 1, last as u32 + 1])
}

/// For each axis the product of the other two components.
fn others(v: DVec3) -> DVec3 {
    DVec3::new(v.y * v.z, v.z * v.x, v.x * v.y)
}

/// Surface of a box with these edge lengths.
fn surface_of(extent: DVec3) -> f64 {
    2.0 * others(extent).element_sum()
}

/// Componentwise quotient, 0 where the divisor is 0: what has no extent is never divided.
fn ratio(a: DVec3, b: DVec3) -> DVec3 {
    a * DVec3::from_array(b.to_array().map(inverse))
}

fn inverse(x: f64) -> f64 {
    if x > 0.0 { x.recip() } else { 0.0 }
}
