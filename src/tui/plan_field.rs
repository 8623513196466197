//! The lines of plans: what they are called, how they are written, what they offer.

use crate::accel;
use crate::kernel;
use crate::lab::stability::CASES;
use crate::scene::SCENES;
use crate::trace::RAY_SETS;

/// A line of the plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Field {
    /// Scene specs.
    Scenes,
    /// Accelerators.
    Accels,
    /// Grid resolutions.
    N,
    /// Kernels.
    Kernels,
    /// Ray sets.
    Rays,
    /// Rays of a set.
    RayCount,
    /// Thread counts.
    Threads,
    /// Fewest and most samples of a run.
    Samples,
    /// How far the scene is moved.
    Offsets,
    /// How much larger the scene is made.
    Scales,
    /// Stability cases.
    Cases,
    /// With which kernels accelerators are tried.
    Extent,
}

/// What can be chosen in a line, with a sentence on it.
pub type Offer = (String, String);

impl Field {
    /// The lines of a sweep's plan, from top to bottom.
    pub const OF_SWEEP: &[Self] = &[
        Self::Scenes,
        Self::Accels,
        Self::N,
        Self::Kernels,
        Self::Rays,
        Self::RayCount,
        Self::Threads,
        Self::Samples,
    ];

    /// The lines of a plan that is judged by the oracle, from top to bottom.
    pub const OF_ACCURACY: &[Self] = &[
        Self::Scenes,
        Self::Rays,
        Self::Offsets,
        Self::Scales,
        Self::Kernels,
        Self::Accels,
        Self::N,
        Self::RayCount,
        Self::Threads,
    ];

    /// The lines of the stability suite's plan, from top to bottom.
    pub const OF_STABILITY: &[Self] = &[
        Self::Cases,
        Self::Kernels,
        Self::Accels,
        Self::Extent,
        Self::Threads,
    ];

    /// How many there are.
    pub(super) const COUNT: usize = Self::Extent as usize + 1;

    /// Its name on the screen.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Scenes => "scenes",
            Self::Accels => "accelerators",
            Self::N => "grid n",
            Self::Kernels => "kernels",
            Self::Rays => "rays",
            Self::RayCount => "rays a set",
            Self::Threads => "threads",
            Self::Samples => "samples a run",
            Self::Offsets => "offsets",
            Self::Scales => "scales",
            Self::Cases => "cases",
            Self::Extent => "try them with",
        }
    }

    /// How the line is written.
    #[must_use]
    pub fn form(self) -> &'static str {
        match self {
            Self::Scenes => "names, sizes or files: teapot, soup:5000, my/mesh.obj",
            Self::Accels => "names with parameters: grid, grid:overlap=sat, bvh",
            Self::N => "a range or a list: 1..128, or 8,16,32,auto",
            Self::Kernels => "names with parameters: woop, sheet-unsigned:eps=1e-4",
            Self::Rays => "names or files: primary, random, file:my.rays",
            Self::RayCount => "a number: 65536, 64k or 1M",
            Self::Threads => "a list: 1, 2, max",
            Self::Samples => "fewest..most: 5..30",
            Self::Offsets => "distances along each axis: 0, 1e4",
            Self::Scales => "factors, about the origin: 1, 1e-3",
            Self::Cases => "names of cases, or all",
            Self::Extent => "quick: woop and exact only; full: every kernel",
        }
    }

    /// What the list of choices offers; empty for lines that are typed.
    #[must_use]
    pub fn offers(self) -> Vec<Offer> {
        let offer = |name: &str, about: &str| (name.to_owned(), about.to_owned());
        match self {
            Self::Scenes => SCENES.iter().map(|s| offer(s.name, s.about)).collect(),
            Self::Accels => accel::ACCELERATORS
                .iter()
                .map(|a| offer(a.name, a.about))
                .collect(),
            Self::Kernels => kernel::KERNELS
                .iter()
                .map(|k| offer(k.name, k.about))
                .collect(),
            // A file of rays has no name to choose; it is typed.
            Self::Rays => RAY_SETS
                .iter()
                .filter(|r| r.argument.is_empty())
                .map(|r| offer(r.name, r.about))
                .collect(),
            Self::Cases => CASES.iter().map(|c| offer(c.name, c.about)).collect(),
            Self::N
            | Self::RayCount
            | Self::Threads
            | Self::Samples
            | Self::Offsets
            | Self::Scales
            | Self::Extent => Vec::new(),
        }
    }

    /// Whether the line is a list of specs.
    #[must_use]
    pub fn is_list(self) -> bool {
        matches!(
            self,
            Self::Scenes | Self::Accels | Self::Kernels | Self::Rays | Self::Cases
        )
    }

    /// Its place among all lines of all plans.
    pub(super) fn index(self) -> usize {
        self as usize
    }
}
