//! What is expected to fail: data with bounds. A test fails when a failure gets worse, and when one disappears.
//!
//! A row of a kernel is about the kernel in brute force. A row of an accelerator is measured with `woop`; with other
//! kernels it explains failures of the same case, whatever their number.

use crate::accel;
use crate::kernel;
use crate::registry::Choice;

use super::case::CaseEntry;
use super::model::Faults;

/// What one method is expected to get wrong on one case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownFailure {
    /// Why.
    pub reason: &'static str,
    /// The first rung at which anything is wrong.
    pub first: f64,
    /// Faults on all rungs together, with seed 1.
    pub most: u64,
}

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
    let (table, label) = if accel.name == super::BRUTE {
        let specs = kernel::entry(kernel).map_or(&[][..], |e| e.params);
        (KERNELS, kernel.label(specs))
    } else {
        let specs = accel::entry(&accel.name).map_or(&[][..], |e| e.params);
        (ACCELS, accel.label(specs))
    };
    let of_method = table.iter().filter(|(method, ..)| *method == label);
    of_method
        .flat_map(|(_, reason, rows)| rows.iter().map(move |row| (reason, row)))
        .find(|(_, (name, ..))| *name == case.name)
        .map(|(reason, (_, first, most))| KnownFailure {
            reason,
            first: *first,
            most: *most,
        })
}

/// What the list says of what was found: why it is not as the list states.
pub(super) fn deviation(
    known: &KnownFailure,
    case: &CaseEntry,
    faults: &Faults,
    first: Option<usize>,
) -> Option<String> {
    let Some(first) = first else {
        return Some("the list of known failures states one that does not occur".to_owned());
    };
    if faults.total() > known.most {
        return Some(format!(
            "the list of known failures states {} faults at most",
            known.most
        ));
    }
    (case.rungs[first] != known.first).then(|| {
        let stated = case.rungs.iter().position(|r| *r == known.first);
        format!(
            "the list of known failures states {} as the first",
            stated.map_or("no rung of this case".to_owned(), |rung| case.label(rung))
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::stability::CASES;

    #[test]
    fn every_row_names_a_method_a_case_and_one_of_its_rungs_once() {
        let kernels = KERNELS
            .iter()
            .map(|row| (row, kernel::parse(row.0).is_ok()));
        let accels = ACCELS.iter().map(|row| (row, accel::parse(row.0).is_ok()));
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
