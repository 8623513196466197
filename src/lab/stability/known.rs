//! What is expected to fail: data with bounds. A test fails when a failure gets worse, and when one disappears.
//!
//! A row of a kernel is about the kernel in brute force. Accelerators have none but exhibits: their rows are measured with
//! `woop`, and with another kernel the mistake that an exhibit shows explains whatever fails.

use crate::registry::Choice;

use super::case::CaseEntry;
use super::model::Faults;
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

/// The failures of one method for one reason: case, first rung, most faults.
type Rows = &'static [(&'static str, f64, u64)];

/// Kernels.
const KERNELS: &[(&str, &str, Rows)] = &[];

/// Accelerators.
const ACCELS: &[(&str, &str, Rows)] = &[];

/// What `kernel` in `accel` is expected to get wrong on `case`; `None` where nothing is, and for parameters that are not
/// the defaults.
#[must_use]
pub fn known_failure(kernel: &Choice, accel: &Choice, case: &CaseEntry) -> Option<KnownFailure> {
    if accel.name == super::BRUTE {
        return row(KERNELS, &kernel_label(kernel), case);
    }
    let label = accel_label(accel);
    if kernel_label(kernel) == MEASURED_WITH {
        return row(ACCELS, &label, case);
    }
    let (_, reason, _) = ACCELS.iter().find(|(method, ..)| *method == label)?;
    Some(KnownFailure {
        reason,
        bound: None,
    })
}

/// The row of `table` about `method` and `case`.
fn row(
    table: &[(&str, &'static str, Rows)],
    method: &str,
    case: &CaseEntry,
) -> Option<KnownFailure> {
    let of_method = table.iter().filter(|(name, ..)| *name == method);
    of_method
        .flat_map(|(_, reason, rows)| rows.iter().map(move |row| (reason, row)))
        .find(|(_, (name, ..))| *name == case.name)
        .map(|(reason, (_, first, most))| KnownFailure {
            reason,
            bound: Some(Bound {
                first: *first,
                most: *most,
            }),
        })
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
    fn every_row_names_a_method_a_case_and_one_of_its_rungs_once() {
        let kernels = KERNELS
            .iter()
            .map(|row| (row, kernel::parse(row.0).is_ok()));
        let control = |name: &str| accel::entry(name).is_ok_and(|e| e.control);
        let accels = ACCELS.iter().map(|row| (row, control(row.0)));
        let mut seen = std::collections::BTreeSet::new();
        for ((method, reason, rows), method_exists) in kernels.chain(accels) {
            assert!(method_exists, "{method}");
            assert!(!reason.is_empty(), "{method}");
            for (name, first, most) in *rows {
                let case = CASES.iter().find(|c| c.name == *name).expect(name);
                assert!(case.rungs.contains(first), "{method}, {name}: {first}");
                assert!(*most > 0, "{method}, {name}");
                assert!(seen.insert((method, name)), "{method}, {name}: twice");
            }
        }
    }
}
