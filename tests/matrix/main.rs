//! The matrix: every accelerator × every kernel × every scene, each its own test; for some kernels every choice of the
//! accelerator's parameters, the ways to trace a batch among them. Each case is traced with one thread and three and with
//! every instruction set that the machine has.
//!
//! Made from the registries, so a new row is covered when it is added. A test's name is
//! `accelerator[:parameters][@n]/kernel/scene`. What a case checks stands in [`check`], on what in [`scenes`] and
//! [`rays`].
//!
//! Peers (structures of other libraries) are tried on every scene, too, but promise nothing: see [`peers`].
//!
//! Rays on which a kernel errs and the answers differ are counted and printed at the end. `woop` and `moller-trumbore`
//! on scenes of ordinary scale have none, but for rays in the plane of the triangle that brute force took; `exact` has none
//! anywhere, and its brute force answers every ray as the oracle does.

mod check;
mod peers;
mod rays;
mod scenes;
mod setting;

use std::collections::BTreeMap;
use std::process::ExitCode;
use std::sync::{Arc, Mutex};

use libtest_mimic::{Arguments, Trial};
use raylab::accel::{ACCELERATORS, AcceleratorEntry};
use raylab::kernel::{self, KERNELS};
use raylab::registry::{Choice, ParamKind, ParamSpec, Params};

use check::{Case, Tally};
use peers::{PeerCase, Wrong};
use setting::Setting;

/// The kernel that makes no error on any scene: what brute force says with it is compared with the oracle too.
const EXACT: &str = "exact";

/// Kernels of which not even an error may differ on a scene of ordinary scale.
const STRICT: &[&str] = &["woop", "moller-trumbore"];

/// Kernels that every combination of an accelerator's parameters, and every n, is tried with; the others meet its defaults.
const EVERYWAY: &[&str] = &["woop", "moller-trumbore", "exact"];

/// Every combination of the words of `specs`; numbers keep their defaults.
fn combinations(specs: &'static [ParamSpec]) -> Vec<Params> {
    specs
        .iter()
        .fold(vec![Params::defaults(specs)], |all, spec| {
            let ParamKind::Choice(words) = spec.kind else {
                return all;
            };
            all.iter()
                .flat_map(|params| {
                    words.iter().map(|word| {
                        let mut params = params.clone();
                        params
                            .set(specs, spec.name, word)
                            .expect("the word is in the list");
                        params
                    })
                })
                .collect()
        })
}

/// The n at which all parameters of an accelerator are tried: small, and not one at which cells meet the scenes' planes.
const EVERYWHERE: u32 = 5;

/// What is built of one accelerator over one scene: the defaults and, where `all` is asked for, every combination of its
/// parameters, and the defaults at several n, where it has one, the predicted among them.
fn builds(
    entry: &'static AcceleratorEntry,
    scene: &Setting,
    all: bool,
) -> Vec<(Choice, Option<u32>)> {
    let choice = |params| Choice {
        name: entry.name.to_owned(),
        params,
    };
    let n = entry.resolution.map(|_| EVERYWHERE);
    let params = if all {
        combinations(entry.params)
    } else {
        vec![Params::defaults(entry.params)]
    };
    let builds = params.into_iter().map(|params| (choice(params), n));
    if n.is_none() || !all {
        return builds.collect();
    }
    let defaults = choice(Params::defaults(entry.params));
    let resolutions = scene.resolutions.iter().copied().map(Some).chain([None]);
    builds
        .chain(resolutions.map(|n| (defaults.clone(), n)))
        .collect()
}

/// A choice of each kernel with its default parameters.
fn kernels() -> impl Iterator<Item = Choice> {
    KERNELS
        .iter()
        .map(|k| kernel::parse(k.name).expect("a row's name is known"))
}

fn trials(tally: &Tally) -> Vec<Trial> {
    let mut trials = Vec::new();
    for scene in scenes::all() {
        let scene = Arc::new(scene);
        for entry in ACCELERATORS
            .iter()
            .filter(|a| !a.control && a.peer.is_none())
        {
            for kernel in kernels() {
                // Which cells list a triangle is no matter of the kernel, and `exact` is the dearest on tiny scenes.
                let of_cells = entry.resolution.is_some() && kernel.name == EXACT;
                let all = EVERYWAY.contains(&kernel.name.as_str()) && !of_cells;
                for (accel, n) in builds(entry, &scene, all) {
                    let case = Case {
                        scene: Arc::clone(&scene),
                        accel: accel.clone(),
                        n,
                        strict: kernel.name == EXACT
                            || (scene.ordinary && STRICT.contains(&kernel.name.as_str())),
                        kernel: kernel.clone(),
                    };
                    let at = n.map_or(String::new(), |n| format!("@{n}"));
                    let name = format!(
                        "{}{at}/{}/{}",
                        accel.label(entry.params),
                        case.kernel.name,
                        scene.name
                    );
                    let tally = Arc::clone(tally);
                    trials.push(Trial::test(name, move || {
                        check::check(&case, &tally).map_err(Into::into)
                    }));
                }
            }
        }
    }
    trials
}

/// Every peer with every choice of its parameters × every scene; no more is promised of them than [`peers`] checks.
fn peer_trials(wrong: &Wrong) -> Vec<Trial> {
    let mut trials = Vec::new();
    for scene in scenes::all() {
        let scene = Arc::new(scene);
        for entry in ACCELERATORS.iter().filter(|a| a.peer.is_some()) {
            for (accel, _) in builds(entry, &scene, true) {
                let case = PeerCase {
                    scene: Arc::clone(&scene),
                    entry,
                    accel,
                };
                let name = format!("peer/{}/{}", case.label(), scene.name);
                let wrong = Arc::clone(wrong);
                trials.push(Trial::test(name, move || {
                    peers::check(&case, &wrong).map_err(Into::into)
                }));
            }
        }
    }
    trials
}

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let tally: Tally = Arc::new(Mutex::new(BTreeMap::new()));
    let wrong: Wrong = Arc::new(Mutex::new(BTreeMap::new()));
    let mut trials = trials(&tally);
    trials.extend(peer_trials(&wrong));
    let conclusion = libtest_mimic::run(&arguments, trials);
    if let Ok(tally) = tally.lock() {
        for (kernel, (errors, rays)) in tally.iter() {
            eprintln!("kernel errors that differ: {kernel}: {errors} of {rays} rays");
        }
    }
    if let Ok(wrong) = wrong.lock() {
        for (peer, (mistakes, answers)) in wrong.iter() {
            eprintln!("wrong answers of peers: {peer}: {mistakes} of {answers}");
        }
    }
    conclusion.exit_code()
}
