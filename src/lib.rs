//! raylab: which ray tracing structure, which grid resolution and which intersection method for this mesh on this machine,
//! what does it cost, and where does it break?
//!
//! This page is the map of the crate. The README says what the program does; `raylab --help` how to use it.
//!
//! # Rooms
//!
//! Dependencies point only downwards; `tests/layering.rs` holds the crate to that.
//!
//! ```text
//!  cli         parse, run, exit code                tui      state + update(event) -> effects + view; screens
//!  ─────────────────────────────────────────────────────────────────────────────────────────────────────────
//!  preview     an image as terminal cells           report   report.json, bundles with journals, plots, exports
//!  ─────────────────────────────────────────────────────────────────────────────────────────────────────────
//!  lab         experiments: a plan becomes runs, runs become raw samples, told as events
//!  stats       medians and intervals over plain slices
//!  ─────────────────────────────────────────────────────────────────────────────────────────────────────────
//!  shade       images: what a pixel shows           trace    ray sets; batches of rays over threads
//!  oracle      what a ray really hits, in exact arithmetic
//!  ─────────────────────────────────────────────────────────────────────────────────────────────────────────
//!  accel       structures that choose which triangles a ray meets; one file each behind one trait
//!  kernel      ray/triangle tests; one file each, written once over a lane type
//!  ─────────────────────────────────────────────────────────────────────────────────────────────────────────
//!  scene       meshes, materials, cameras; OBJ files, bundled and procedural scenes
//!  geometry    vectors, boxes, rays, hits, lanes
//!  registry    what every registry row has: a name, a sentence, parameters
//! ```
//!
//! # The data's way
//!
//! ```text
//!  spec ─scene::load─> Scene ─┬─accel::build(accelerator, n, kernel)─> dyn Accelerator ─┐
//!                             └─trace::ray_set(set, count, seed)─────> RaySet ──────────┤
//!                                                                                       v
//!       report.json, plots <─report::Bundle─ Events <─lab::sweep─ timed, counted and checked passes
//! ```
//!
//! A structure meets a kernel in one place ([`accel::finish`]): it leads a [`accel::Visitor`] through its cells, and the
//! visitor bundles the kernel, the query (closest hit or occlusion) and the counter (real or compiled away). So there is
//! one traversal a structure and one formula a kernel, and every combination is monomorphised. What is dynamic is decided
//! once a batch of rays: the instruction set, found when the program runs, and the way in which the rays are traced.
//!
//! ```text
//!  batch of rays ─ instruction set ─> Structure::trace ─┬─ one ray after another ──┐
//!                  (portable, AVX2,                      ├─ sixteen rays take turns ┼─> one traversal ─> Visitor::test(item)
//!                   AVX-512)                             └─ rays of one origin as a ┘     an item: a triangle, or a block of
//!                                                           packet                        eight, in the kernel's own packing
//! ```
//!
//! The same [`geometry::lanes`] serve all of it: eight triangles against a ray, or sixteen rays against a triangle.
//!
//! # The rule
//!
//! An accelerator never changes a right answer: wherever brute force with the same kernel is right by the [`oracle`],
//! every structure, query, way, instruction set and thread count gives the same triangle and the same `t`, bit for bit. Where a kernel itself
//! errs, answers may differ; such rays are counted as `kernel_errors`. The matrix of tests and every timed run check it.
//!
//! # Where to add what
//!
//! | to add | write | and a row in |
//! |---|---|---|
//! | an accelerator | a file in `accel/` that implements [`accel::Structure`] | [`accel::ACCELERATORS`] |
//! | a kernel | a file in `kernel/` that implements [`kernel::Kernel`] | the list in [`kernel`] |
//! | a scene or family | a file in `scene/` | [`scene::SCENES`] |
//! | a stability case | an entry in `lab/stability/cases/` | [`lab::stability::CASES`] |
//! | a ray set | a file in `trace/` | [`trace::RAY_SETS`] |
//! | a channel of pictures | a file in `shade/` | [`shade::CHANNELS`] |
//! | an export format | a file in `report/` | [`report::FORMATS`] |
//! | a key of the TUI | nothing | the keymap of [`tui`] |
//!
//! The rows feed the command line, `raylab list`, the TUI, sweeps, generated tests and the README's tables.

pub mod accel;
pub mod cli;
pub mod geometry;
pub mod kernel;
pub mod lab;
pub mod oracle;
pub mod preview;
pub mod registry;
pub mod report;
pub mod scene;
pub mod shade;
pub mod stats;
pub mod trace;
pub mod tui;
