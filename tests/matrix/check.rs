//! What one case of the matrix checks.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use raylab::accel::{Accelerator, Counts};
use raylab::geometry::lanes::InstructionSet;
use raylab::geometry::{Hit, Ray};
use raylab::oracle::{self, Verdict};
use raylab::registry::Choice;
use raylab::trace;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::setting::{Answers, Setting};

/// For each kernel the rays on which it erred and the answers differed, and all rays.
pub type Tally = Arc<Mutex<BTreeMap<String, (u64, u64)>>>;

/// One accelerator over one scene with one kernel.
pub struct Case {
    pub scene: Arc<Setting>,
    pub accel: Choice,
    pub n: Option<u32>,
    pub kernel: Choice,
    /// Whether not even errors of the kernel may differ.
    pub strict: bool,
}

/// Above this n a grid takes hundreds of megabytes: one at a time, and built once.
const HEAVY_N: u32 = 256;

static HEAVY: Mutex<()> = Mutex::new(());

fn pool(threads: usize) -> Result<ThreadPool, String> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| e.to_string())
}

/// Checks everything that [`crate`] promises of a case.
pub fn check(case: &Case, tally: &Tally) -> Result<(), String> {
    let heavy = case.n.is_some_and(|n| n > HEAVY_N);
    let _turn: Option<MutexGuard<()>> =
        heavy.then(|| HEAVY.lock().unwrap_or_else(PoisonError::into_inner));
    let build = || case.scene.build(&case.accel, case.n, &case.kernel);
    let accel = pool(1)?.install(build)?;
    accel.validate()?;
    let rays = case.scene.rays();
    let answers = alone(&*accel, rays);
    let errors = compared_with_brute(case, rays, &answers)?;
    let counts = counted_equals_uncounted(case, &*accel, &answers)?;
    let many = pool(3)?;
    many.install(|| threads_change_nothing(case, &*accel, &answers, &counts))?;
    instruction_sets_change_nothing(case, &*accel, &answers)?;
    if !heavy {
        let again = many.install(build)?;
        builds_are_equal(&*accel, &*again, rays, &counts)?;
    }
    let mut tally = tally.lock().map_err(|e| e.to_string())?;
    let row = tally.entry(case.kernel.name.clone()).or_default();
    row.0 += errors;
    row.1 += rays.len() as u64;
    Ok(())
}

/// All rays in one batch on this thread.
fn alone(accel: &dyn Accelerator, rays: &[Ray]) -> Answers {
    let mut answers = Answers {
        hits: vec![Hit::MISS; rays.len()],
        blocked: vec![false; rays.len()],
    };
    accel.closest(rays, &mut answers.hits);
    accel.occluded(rays, &mut answers.blocked);
    answers
}

/// The rule of the accelerators, by the oracle; returns how many rays the kernel erred on.
fn compared_with_brute(case: &Case, rays: &[Ray], answers: &Answers) -> Result<u64, String> {
    let brute = case.scene.brute(&case.kernel)?;
    let oracle = case.scene.oracle();
    let mut errors = 0;
    for (i, ray) in rays.iter().enumerate() {
        let (hit, expected) = (&answers.hits[i], &brute.hits[i]);
        let (blocked, expected_blocked) = (answers.blocked[i], brute.blocked[i]);
        let closest = oracle::arbitrate(oracle, ray, expected, hit);
        let mut occlusion = oracle::arbitrate_occluded(oracle, ray, expected_blocked, blocked);
        // Brute force may say "blocked", rightly, for a wrong reason: it took a phantom, and lost what is really hit.
        if occlusion == Verdict::Broken
            && expected_blocked
            && !case.scene.rightly_blocked(&case.kernel, ray)?
        {
            occlusion = Verdict::KernelError;
        }
        let verdicts = [closest, occlusion];
        let erred = verdicts.contains(&Verdict::KernelError);
        let exact = case.kernel.name == crate::EXACT;
        let strict = case.strict && (exact || !case.scene.in_plane(ray, expected));
        if verdicts.contains(&Verdict::Broken)
            || (strict && erred)
            || (!erred && blocked != hit.is_hit())
        {
            let truth = oracle.truth(ray);
            return Err(format!(
                "ray {i} {ray:?}:\n  {hit:?}, blocked: {blocked}\n  brute force {expected:?}, blocked: \
                 {expected_blocked}\n  verdicts {verdicts:?}\n  truth: t {:?}, triangles {:?}",
                truth.t.map(|t| t.to_f64()),
                truth.tie_set,
            ));
        }
        errors += u64::from(erred);
    }
    Ok(errors)
}

/// Work of the closest-hit and of the occlusion queries.
type Work = [Vec<Counts>; 2];

fn counted_equals_uncounted(
    case: &Case,
    accel: &dyn Accelerator,
    answers: &Answers,
) -> Result<Work, String> {
    let rays = case.scene.rays();
    let (hits, work) = trace::closest_counted(accel, rays);
    let (blocked, shadow_work) = trace::occluded_counted(accel, rays);
    equal(case, "counted and uncounted", &hits, &blocked, answers)?;
    Ok([work, shadow_work])
}

fn threads_change_nothing(
    case: &Case,
    accel: &dyn Accelerator,
    answers: &Answers,
    work: &Work,
) -> Result<(), String> {
    let rays = case.scene.rays();
    let (hits, blocked) = (trace::closest(accel, rays), trace::occluded(accel, rays));
    equal(case, "one thread and three", &hits, &blocked, answers)?;
    let (hits, counts) = trace::closest_counted(accel, rays);
    equal(
        case,
        "one thread and three, counted,",
        &hits,
        &blocked,
        answers,
    )?;
    if counts == work[0] {
        Ok(())
    } else {
        Err("one thread and three count different work".to_owned())
    }
}

/// All of a hit, bit for bit.
fn bits(hit: &Hit) -> [u32; 4] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.prim]
}

/// Whether two lists of answers are equal, bit for bit. Where the kernel errs they may differ, since a packet meets other
/// triangles than a single ray does, and threads cut other packets; of strict kernels only where a ray runs in the plane of
/// the triangle that one of both took.
fn equal(
    case: &Case,
    what: &str,
    hits: &[Hit],
    blocked: &[bool],
    expected: &Answers,
) -> Result<(), String> {
    let differs =
        |i: usize| bits(&hits[i]) != bits(&expected.hits[i]) || blocked[i] != expected.blocked[i];
    if !(0..hits.len()).any(differs) {
        return Ok(());
    }
    let (brute, rays) = (case.scene.brute(&case.kernel)?, case.scene.rays());
    for i in (0..hits.len()).filter(|i| differs(*i)) {
        let (hit, other, ray) = (&hits[i], &expected.hits[i], &rays[i]);
        let err = |hit| {
            let verdict = oracle::arbitrate(case.scene.oracle(), ray, &brute.hits[i], hit);
            verdict == Verdict::KernelError
        };
        let in_plane = |hit| case.scene.in_plane(ray, hit);
        let exact = case.kernel.name == crate::EXACT;
        let strict = case.strict && (exact || !(in_plane(hit) || in_plane(other)));
        if strict || !(err(hit) || err(other)) {
            return Err(format!(
                "{what} differ, ray {i} {ray:?}: {hit:?}, blocked: {}, and {other:?}, blocked: {}",
                blocked[i], expected.blocked[i]
            ));
        }
    }
    Ok(())
}

/// Every instruction set that this machine has gives the same answers, if the accelerator uses any.
fn instruction_sets_change_nothing(
    case: &Case,
    accel: &dyn Accelerator,
    answers: &Answers,
) -> Result<(), String> {
    let used = accel.instruction_set();
    if used == InstructionSet::Portable {
        return Ok(());
    }
    let others = InstructionSet::ALL.into_iter();
    for set in others.filter(|set| *set != used && set.is_available()) {
        let built = case
            .scene
            .build_for(set, &case.accel, case.n, &case.kernel)?;
        let other = alone(&*built, case.scene.rays());
        let what = format!("{used} and {set}");
        equal(case, &what, &other.hits, &other.blocked, answers)?;
    }
    Ok(())
}

/// A build is the same whatever the number of threads: in its shape, and in what every ray does.
fn builds_are_equal(
    one: &dyn Accelerator,
    other: &dyn Accelerator,
    rays: &[Ray],
    work: &Work,
) -> Result<(), String> {
    if one.stats() != other.stats() || one.memory_bytes() != other.memory_bytes() {
        return Err("two builds have different shapes".to_owned());
    }
    if trace::closest_counted(other, rays).1 == work[0] {
        Ok(())
    } else {
        Err("two builds make rays do different work".to_owned())
    }
}
