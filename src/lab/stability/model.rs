//! What the suite finds: a map of cells, one a kernel, accelerator and case.

use serde::{Serialize, Serializer};

/// The word of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Nothing was wrong.
    Ok,
    /// It fails, within the bound and from the rung on that the list of known failures states.
    Known,
    /// The list states a failure that does not occur: the list is wrong, or something was mended.
    Gone,
    /// It fails, and the list does not say so, or states less.
    Fails,
    /// It was not built; the note says why.
    Refused,
}

impl Verdict {
    /// All verdicts, best first.
    pub const ALL: [Self; 5] = [
        Self::Ok,
        Self::Known,
        Self::Gone,
        Self::Fails,
        Self::Refused,
    ];

    /// The letter that stands in the map.
    #[must_use]
    pub const fn letter(self) -> char {
        match self {
            Self::Ok => '.',
            Self::Known => 'k',
            Self::Gone => 'g',
            Self::Fails => 'F',
            Self::Refused => '-',
        }
    }

    /// What the letter means.
    #[must_use]
    pub const fn about(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Known => "fails as known",
            Self::Gone => "known failure that is gone",
            Self::Fails => "FAILS",
            Self::Refused => "not built",
        }
    }
}

/// How an answer is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fault {
    /// The ray hits, the method misses.
    Leak,
    /// The method hits, the ray misses.
    Phantom,
    /// Another triangle than any nearest one, elsewhere.
    WrongSurface,
    /// A nearest triangle, at a point that is off by more than rounding.
    Astray,
    /// Of an accelerator: the kernel's right answer in another form: another of equally near triangles, or other bits of t.
    Differs,
    /// Closest hit and occlusion contradict each other, or the occlusion query is wrong where brute force is right.
    Occlusion,
    /// The structure breaks a promise that it makes of itself.
    Invalid,
}

impl Fault {
    /// What it is called in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Leak => "leak",
            Self::Phantom => "phantom",
            Self::WrongSurface => "wrong surface",
            Self::Astray => "t astray",
            Self::Differs => "differs",
            Self::Occlusion => "occlusion",
            Self::Invalid => "invalid structure",
        }
    }
}

/// How often answers were wrong, by kind; a ray has at most one fault, its gravest. In JSON: the kinds that occur.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Faults {
    /// See [`Fault::Leak`].
    pub leaks: u64,
    /// See [`Fault::Phantom`].
    pub phantoms: u64,
    /// See [`Fault::WrongSurface`].
    pub wrong_surface: u64,
    /// See [`Fault::Astray`].
    pub astray: u64,
    /// See [`Fault::Differs`].
    pub differs: u64,
    /// See [`Fault::Occlusion`].
    pub occlusion: u64,
    /// Structures, not rays; see [`Fault::Invalid`].
    pub invalid: u64,
}

impl Serialize for Faults {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.each().into_iter().filter(|(_, count)| *count > 0))
    }
}

impl Faults {
    /// Counts one.
    pub fn add(&mut self, fault: Fault) {
        *match fault {
            Fault::Leak => &mut self.leaks,
            Fault::Phantom => &mut self.phantoms,
            Fault::WrongSurface => &mut self.wrong_surface,
            Fault::Astray => &mut self.astray,
            Fault::Differs => &mut self.differs,
            Fault::Occlusion => &mut self.occlusion,
            Fault::Invalid => &mut self.invalid,
        } += 1;
    }

    /// Each kind with its count.
    #[must_use]
    pub fn each(&self) -> [(Fault, u64); 7] {
        [
            (Fault::Leak, self.leaks),
            (Fault::Phantom, self.phantoms),
            (Fault::WrongSurface, self.wrong_surface),
            (Fault::Astray, self.astray),
            (Fault::Differs, self.differs),
            (Fault::Occlusion, self.occlusion),
            (Fault::Invalid, self.invalid),
        ]
    }

    /// All of them.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.each().iter().map(|(_, count)| count).sum()
    }

    /// The sum of both.
    #[must_use]
    pub fn plus(mut self, other: Self) -> Self {
        self.leaks += other.leaks;
        self.phantoms += other.phantoms;
        self.wrong_surface += other.wrong_surface;
        self.astray += other.astray;
        self.differs += other.differs;
        self.occlusion += other.occlusion;
        self.invalid += other.invalid;
        self
    }
}

/// What was found at one rung of a case's ladder.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rung {
    /// `offset 1e4`; empty where the case has one rung only.
    pub label: String,
    /// Rays that were judged.
    pub rays: u64,
    /// What was wrong.
    pub faults: Faults,
}

/// A ray on which a cell fails: enough to make it again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Witness {
    /// Index of the rung.
    pub rung: usize,
    /// Index of the ray there; 0 where the structure itself is invalid.
    pub ray: usize,
    /// How the answer is wrong.
    pub fault: Fault,
}

/// One kernel in one accelerator on one case.
///
/// In brute force the oracle judges the kernel. Elsewhere brute force with the same kernel judges the accelerator: what
/// the kernel itself gets wrong is not counted again.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cell {
    /// Kernel, with the parameters that are not the defaults.
    pub kernel: String,
    /// Accelerator, with the parameters that are not the defaults; `brute` is the kernel alone.
    pub accel: String,
    /// Case.
    pub case: &'static str,
    /// What it comes to.
    pub verdict: Verdict,
    /// Why it fails, where that is known.
    pub reason: Option<String>,
    /// The first rung at which anything is wrong, `offset 1e4`; empty where the case has one rung only.
    pub first: Option<String>,
    /// All rungs together.
    pub faults: Faults,
    /// Rung by rung.
    pub rungs: Vec<Rung>,
    /// Why it was not built, which promise is broken, or what the list of known failures says otherwise.
    pub note: Option<String>,
    /// The first failing ray of the first failing rung.
    pub witness: Option<Witness>,
}

impl Cell {
    /// Rays that were judged.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.rungs.iter().map(|rung| rung.rays).sum()
    }

    /// Whether the cell is about a kernel alone.
    #[must_use]
    pub fn of_kernel(&self) -> bool {
        self.accel == super::BRUTE
    }

    /// Why it is as it is, one line: faults, first rung, reason.
    #[must_use]
    pub fn story(&self) -> String {
        let counts: Vec<String> = self
            .faults
            .each()
            .iter()
            .filter(|(_, count)| *count > 0)
            .map(|(fault, count)| format!("{} {count}", fault.name()))
            .collect();
        let mut parts = vec![];
        if !counts.is_empty() {
            parts.push(format!("{} of {} rays", counts.join(", "), self.rays()));
        }
        if let Some(first) = self.first.as_deref().filter(|first| !first.is_empty()) {
            parts.push(format!("from {first} on"));
        }
        parts.extend(self.reason.clone());
        parts.extend(self.note.clone());
        parts.join("; ")
    }
}

/// All cells of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Map {
    /// Cases, in the order of the registry.
    pub cases: Vec<&'static str>,
    /// Kernels, as they are labelled in cells.
    pub kernels: Vec<String>,
    /// Accelerators beside brute force, as they are labelled in cells.
    pub accels: Vec<String>,
    /// By case, then brute force with each kernel, then each accelerator with each kernel.
    pub cells: Vec<Cell>,
    /// The seed of all cases.
    pub seed: u64,
    /// Whether it was stopped before all cells were done.
    pub stopped: bool,
}

impl Map {
    /// What `kernel` alone did on `case`.
    #[must_use]
    pub fn kernel_cell(&self, kernel: &str, case: &str) -> Option<&Cell> {
        self.cell(kernel, super::BRUTE, case)
    }

    /// What `accel` with `kernel` did on `case`.
    #[must_use]
    pub fn cell(&self, kernel: &str, accel: &str, case: &str) -> Option<&Cell> {
        self.cells
            .iter()
            .find(|c| c.kernel == kernel && c.accel == accel && c.case == case)
    }

    /// What `accel` did on `case`: its worst cell over all kernels, of equals the first.
    #[must_use]
    pub fn accel_cell(&self, accel: &str, case: &str) -> Option<&Cell> {
        let cells = self.cells.iter();
        let of = cells.filter(|c| c.accel == accel && c.case == case);
        of.reduce(|worst, cell| {
            if cell.verdict > worst.verdict {
                cell
            } else {
                worst
            }
        })
    }

    /// Cells with this verdict.
    pub fn with(&self, verdict: Verdict) -> impl Iterator<Item = &Cell> {
        self.cells.iter().filter(move |c| c.verdict == verdict)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_verdict_has_a_letter_of_its_own() {
        for (i, a) in Verdict::ALL.iter().enumerate() {
            assert!(
                Verdict::ALL[..i]
                    .iter()
                    .all(|b| a.letter() != b.letter() && b < a)
            );
        }
    }

    #[test]
    fn faults_add_up_by_kind() {
        let mut faults = Faults::default();
        for (fault, _) in Faults::default().each() {
            faults.add(fault);
        }
        assert!(faults.each().iter().all(|(_, count)| *count == 1));
        assert!(faults.plus(faults).each().iter().all(|(_, c)| *c == 2));
        assert_eq!(faults.total(), 7);
    }
}
