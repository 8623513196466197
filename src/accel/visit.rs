//! Visitors: what a traversal reports to. One visitor bundles the query (closest hit or occlusion), the counter (real or
//! compiled away) and the kernel, so that a traversal is written once.

/// What a traversal reports to.
pub trait Visitor {
    /// Whether anyone looks at what [`Visitor::step`] is told; where not, computing it can be spared.
    const WATCHED: bool;

    /// Whether near places should come before far ones: not where any hit will do, and ordering costs more than it saves.
    const ORDERED: bool = true;

    /// Whether traversals are compiled for it, as [`super::Structure::DIRECT`] says.
    const DIRECT: bool = true;

    /// Prepares the ray for its tests. Its first test does so where it was not asked to, but which is the first is guessed wrong
    /// once a ray: in advance it is quicker for rays that each test something by themselves.
    #[inline(always)]
    fn prepare(&mut self) {}

    /// A cell or node was entered; `entry` and `exit` are the ray's `t` there, `references` is how many triangles it
    /// lists (0 for an interior node) and `leaf` whether it can list any.
    fn step(&mut self, place: u64, leaf: bool, references: u32, entry: f64, exit: f64);

    /// Tests an item of the structure, a triangle or a block of them; returns true when the query is finished and the
    /// traversal must return.
    fn test(&mut self, item: u32) -> bool;

    /// As [`Visitor::test`], for callers that are compiled for no instruction set.
    fn test_apart(&mut self, item: u32) -> bool {
        self.test(item)
    }

    /// A triangle was not tested, because this ray had tested it before.
    #[inline(always)]
    fn skipped(&mut self, _prim: u32) {}

    /// From now on only hits with `t` in this interval count: what `grid-inside-only` does wrong, and nothing else needs.
    #[inline(always)]
    fn narrow(&mut self, _from: f32, _to: f32) {}

    /// Nothing that begins beyond this `t` can change the answer; what begins at it still can.
    fn t_limit(&self) -> f32;
}

/// The work of one ray.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Cells or nodes visited.
    pub steps: u64,
    /// Of these, cells or leaves without a reference.
    pub empty_steps: u64,
    /// Ray/triangle tests.
    pub tests: u64,
    /// Of these, tests of a triangle that this ray had tested before.
    pub duplicate_tests: u64,
}

/// Counts, or compiles away.
pub trait Counter {
    /// Whether it counts.
    const COUNTS: bool;
    /// See [`Visitor::step`].
    fn step(&mut self, place: u64, leaf: bool, references: u32, entry: f64, exit: f64);
    /// A triangle was tested: the kernel's `t` where it found a hit, and whether that became the nearest.
    fn test(&mut self, prim: u32, t: Option<f32>, nearest: bool);
    /// See [`Visitor::skipped`].
    fn skipped(&mut self, prim: u32);
}

/// Counts nothing; every call compiles away.
#[derive(Clone, Copy)]
pub struct Uncounted;

impl Counter for Uncounted {
    const COUNTS: bool = false;
    #[inline(always)]
    fn step(&mut self, _: u64, _: bool, _: u32, _: f64, _: f64) {}
    #[inline(always)]
    fn test(&mut self, _: u32, _: Option<f32>, _: bool) {}
    #[inline(always)]
    fn skipped(&mut self, _: u32) {}
}

/// What is done with the work of rays, one after another. Called through a pointer, so that each combination of structure
/// and kernel is compiled once for all that watch.
pub(super) trait Watch {
    /// See [`Visitor::step`].
    fn step(&mut self, place: u64, leaf: bool, references: u32, entry: f64, exit: f64);
    /// See [`Counter::test`].
    fn test(&mut self, prim: u32, t: Option<f32>, nearest: bool);
    /// See [`Visitor::skipped`].
    fn skipped(&mut self, _prim: u32) {}
}

impl Counter for &mut dyn Watch {
    const COUNTS: bool = true;
    fn step(&mut self, place: u64, leaf: bool, references: u32, entry: f64, exit: f64) {
        (**self).step(place, leaf, references, entry, exit);
    }
    fn test(&mut self, prim: u32, t: Option<f32>, nearest: bool) {
        (**self).test(prim, t, nearest);
    }
    fn skipped(&mut self, prim: u32) {
        (**self).skipped(prim);
    }
}

/// Counts the work of one ray after another.
pub(super) struct Counted {
    /// The work of the ray that was begun last.
    pub counts: Counts,
    ray: u32,
    /// For each triangle the number of the ray that tested it last.
    tested_by: Vec<u32>,
}

impl Counted {
    pub fn new(triangles: usize) -> Self {
        Self {
            counts: Counts::default(),
            ray: 0,
            tested_by: vec![0; triangles],
        }
    }

    /// The next ray begins.
    pub fn begin(&mut self) {
        // A batch holds fewer than 2³² rays, so a number never returns.
        self.ray += 1;
        self.counts = Counts::default();
    }
}

impl Watch for Counted {
    fn step(&mut self, _: u64, leaf: bool, references: u32, _: f64, _: f64) {
        self.counts.steps += 1;
        self.counts.empty_steps += u64::from(leaf && references == 0);
    }

    fn test(&mut self, prim: u32, _: Option<f32>, _: bool) {
        let last = std::mem::replace(&mut self.tested_by[prim as usize], self.ray);
        self.counts.tests += 1;
        self.counts.duplicate_tests += u64::from(last == self.ray);
    }
}
