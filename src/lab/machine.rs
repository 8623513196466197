//! What the machine gives a sweep: thread pools, cores that are awake, and reasons to distrust its clock.

use std::collections::BTreeMap;
use std::thread::available_parallelism;
use std::time::{Duration, Instant};
use std::{hint, mem};

use rayon::{ThreadPool, ThreadPoolBuilder};
use sysinfo::System;

use super::LabError;

/// One pool a thread count, built once, and one of all cores for what is not timed.
pub(super) struct Pools {
    timed: BTreeMap<usize, ThreadPool>,
    all: ThreadPool,
}

impl Pools {
    /// Pools of these thread counts.
    ///
    /// # Errors
    /// The system gives no such number of threads.
    pub fn new(threads: &[usize]) -> Result<Self, LabError> {
        let pool = |threads: usize| {
            let built = ThreadPoolBuilder::new().num_threads(threads).build();
            built.map_err(|why| LabError::Pool {
                threads,
                why: why.to_string(),
            })
        };
        Ok(Self {
            timed: threads
                .iter()
                .map(|t| Ok((*t, pool(*t)?)))
                .collect::<Result<_, LabError>>()?,
            all: pool(cores())?,
        })
    }

    /// The pool of this many threads; of all cores where there is none of that size.
    pub fn of(&self, threads: usize) -> &ThreadPool {
        self.timed.get(&threads).unwrap_or(&self.all)
    }

    /// The pool of all cores.
    pub fn all(&self) -> &ThreadPool {
        &self.all
    }
}

/// Cores that the program may use; 1 where the system does not say.
pub fn cores() -> usize {
    available_parallelism().map_or(1, usize::from)
}

/// How long threads work before several of them are timed.
///
/// Cores that idled take a while to come to full speed, those of a virtual machine above all, whose host first finds places
/// for them. Builds of `bvh-wide` over the Stanford bunny with two threads, after one of two cores had idled for a tenth of a
/// second: at once 10.0 ms (median; 13.1 the slowest tenth), after 5 to 10 ms of work 14 to 16 ms (18 to 19), after 20 ms 10.0
/// (12.6), after 40 to 150 ms 9.6 to 9.7 (11.1 to 11.6).
const WARM_UP: Duration = Duration::from_millis(50);

/// Keeps the threads of the current pool at work for a while, so that what is timed next has all their cores at full speed.
///
/// One thread alone has its core already: it has just called this.
pub fn warm_up() {
    if rayon::current_num_threads() > 1 {
        let end = Instant::now() + WARM_UP;
        rayon::broadcast(|_| {
            while Instant::now() < end {
                hint::spin_loop();
            }
        });
    }
}

/// Whether the cores for what is timed next are awake.
#[derive(Default)]
pub(super) struct Awake {
    /// Threads of what was timed last.
    threads: usize,
}

impl Awake {
    /// Warms `pool` up, unless as many threads have just been timed.
    pub fn ready(&mut self, pool: &ThreadPool) {
        if self.lacks(pool.current_num_threads()) {
            pool.install(warm_up);
        }
    }

    /// Whether so many threads are more than were timed last; they are timed next.
    fn lacks(&mut self, threads: usize) -> bool {
        let before = mem::replace(&mut self.threads, threads);
        threads > before
    }
}

/// Why figures of runs with this many threads should be read with care, one sentence each.
pub(super) fn warnings(threads: usize) -> Vec<String> {
    // Systems without a load average, like Windows, give no warning of load.
    let load = System::load_average().map_or(0.0, |load| load.one);
    warnings_of(threads, cores(), load)
}

fn warnings_of(threads: usize, cores: usize, load: f64) -> Vec<String> {
    let mut warnings = Vec::new();
    if threads > cores {
        warnings.push(format!("{threads} threads shared {cores} CPUs"));
    }
    // The sweep itself adds at most one for each core that it uses.
    if load > cores as f64 + 0.5 {
        warnings.push(format!(
            "the load average was {load:.1} on {cores} CPUs: other programs ran beside"
        ));
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pool_has_the_threads_that_were_asked_for() {
        let pools = Pools::new(&[1, 3]).unwrap();
        for threads in [1, 3] {
            assert_eq!(pools.of(threads).current_num_threads(), threads);
        }
        assert_eq!(pools.all().current_num_threads(), cores());
    }

    #[test]
    fn several_threads_work_for_a_while_before_they_are_timed() {
        let pools = Pools::new(&[1, 2]).unwrap();
        let start = Instant::now();
        pools.of(2).install(warm_up);
        assert!(start.elapsed() >= WARM_UP);
    }

    #[test]
    fn cores_are_woken_after_fewer_threads_only() {
        let mut awake = Awake::default();
        let lacks = [2, 2, 1, 1, 2, 8, 4].map(|threads| awake.lacks(threads));
        assert_eq!(lacks, [true, false, false, false, true, true, false]);
    }

    #[test]
    fn too_many_threads_and_foreign_load_are_told() {
        assert!(warnings_of(2, 4, 4.2).is_empty());
        assert!(warnings_of(8, 4, 0.0)[0].contains("8 threads shared 4 CPUs"));
        assert!(warnings_of(2, 4, 6.04)[0].contains("6.0 on 4 CPUs"));
    }
}
