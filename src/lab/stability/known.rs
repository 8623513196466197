//! What is expected to fail: data with bounds. A test fails when a failure gets worse, and when one disappears.
//!
//! The rows stand in `rows`. A row of a kernel is about the kernel in brute force. Accelerators have none but exhibits:
//! their rows are measured with `woop`, and with another kernel the mistake that an exhibit shows explains whatever fails.

use crate::registry::Choice;

use super::case::CaseEntry;
use super::model::Faults;
use super::reasons::{MISTAKES, OWN_REASONS, REASONS};
use super::rows::{EXHIBITS, KERNELS};
use super::run::{accel_label, kernel_label};

/// What one method is expected to get wrong on one case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownFailure {
    /// Why.
    pub reason: &'static str,
    /// How much; `None` for an exhibit with another kernel than `woop`.
    pub bound: Option<Bound>,
}

/// How much fails.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// The first rung at which anything is wrong.
    pub first: f64,
    /// Faults on all rungs together, with seed 1.
    pub most: u64,
}

/// The kernel that rows of exhibits are measured with.
pub(super) const MEASURED_WITH: &str = "woop";

/// The failures of one method: case, first rung, most faults.
pub(super) type Rows = &'static [(&'static str, f64, u64)];

/// What `kernel` in `accel` is expected to get wrong on `case`; `None` where nothing is, and for parameters that are not
/// the defaults.
#[must_use]
pub fn known_failure(kernel: &Choice, accel: &Choice, case: &CaseEntry) -> Option<KnownFailure> {
    if accel.name == super::BRUTE {
        let kernel = kernel_label(kernel);
        return Some(KnownFailure {
            bound: Some(bound(KERNELS, &kernel, case)?),
            reason: reason(&kernel, case.name)?,
        });
    }
    let label = accel_label(accel);
    let (_, reason) = MISTAKES.iter().find(|(exhibit, _)| *exhibit == label)?;
    let bound = bound(EXHIBITS, &label, case);
    let measured = kernel_label(kernel) == MEASURED_WITH;
    (bound.is_some() || !measured).then_some(KnownFailure {
        reason,
        bound: bound.filter(|_| measured),
    })
}

/// The row of `table` about `method` and `case`.
fn bound(table: &[(&str, Rows)], method: &str, case: &CaseEntry) -> Option<Bound> {
    let (_, rows) = table.iter().find(|(name, _)| *name == method)?;
    let (_, first, most) = rows.iter().find(|(name, ..)| *name == case.name)?;
    Some(Bound {
        first: *first,
        most: *most,
    })
}

/// Why `kernel` fails on `case`: a reason of its own, else the one that the case has for all.
fn reason(kernel: &str, case: &str) -> Option<&'static str> {
    let own = OWN_REASONS
        .iter()
        .filter(|(kernels, cases, _)| kernels.contains(&kernel) && cases.contains(&case))
        .map(|(.., reason)| *reason);
    let of_case = REASONS
        .iter()
        .filter(|(cases, _)| cases.contains(&case))
        .map(|(_, reason)| *reason);
    own.chain(of_case).next()
}

/// Why what was found is not as the list states; `None` where it is.
pub(super) fn deviation(
    bound: &Bound,
    case: &CaseEntry,
    faults: &Faults,
    first: Option<usize>,
) -> Option<String> {
    let Some(first) = first else {
        return Some("the list of known failures states one that does not occur".to_owned());
    };
    if faults.total() > bound.most {
        return Some(format!(
            "the list of known failures states {} faults at most",
            bound.most
        ));
    }
    (case.rungs[first] != bound.first).then(|| {
        let stated = case.rungs.iter().position(|r| *r == bound.first);
        format!(
            "the list of known failures states {} as the first",
            stated.map_or("no rung of this case".to_owned(), |rung| case.label(rung))
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel;
    use crate::kernel;
    use crate::lab::stability::CASES;

    #[test]
    fn every_row_names_a_method_a_case_and_one_of_its_rungs_once_and_has_a_reason() {
        let is_control = |name: &str| accel::entry(name).is_ok_and(|e| e.control);
        for (kernel, rows) in KERNELS {
            assert!(kernel::parse(kernel).is_ok(), "{kernel}");
            for (case, ..) in *rows {
                assert!(reason(kernel, case).is_some(), "{kernel} on {case}");
            }
        }
        for (exhibit, _) in EXHIBITS {
            assert!(is_control(exhibit), "{exhibit}");
            assert!(MISTAKES.iter().any(|(name, _)| name == exhibit));
        }
        let mut seen = std::collections::BTreeSet::new();
        for (method, rows) in KERNELS.iter().chain(EXHIBITS) {
            for (name, first, most) in *rows {
                let case = CASES.iter().find(|c| c.name == *name).expect(name);
                assert!(case.rungs.contains(first), "{method}, {name}: {first}");
                assert!(*most > 0, "{method}, {name}");
                assert!(seen.insert((method, name)), "{method}, {name}: twice");
            }
        }
    }

    #[test]
    fn the_exact_kernel_and_sound_accelerators_have_no_rows() {
        assert!(KERNELS.iter().all(|(kernel, _)| *kernel != "exact"));
        let exact = kernel::parse("exact").unwrap();
        for entry in accel::ACCELERATORS.iter().filter(|a| !a.control) {
            let accel = accel::parse(entry.name).unwrap();
            for case in CASES {
                assert_eq!(known_failure(&exact, &accel, case), None, "{}", entry.name);
            }
        }
    }
}
