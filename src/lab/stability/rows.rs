//! The rows of known failures, as the suite measures them with seed 1.

use super::known::Rows;

/// Why a kernel fails on these cases, unless it has a reason of its own.
pub(super) const REASONS: &[(&[&str], &str)] = &[];

/// Reasons of some kernels' own.
pub(super) const OWN_REASONS: &[(&[&str], &[&str], &str)] = &[];

/// The mistake of each exhibit.
pub(super) const MISTAKES: &[(&str, &str)] = &[];

/// Kernels in brute force.
pub(super) const KERNELS: &[(&str, Rows)] = &[];

/// Exhibits, with `woop`.
pub(super) const EXHIBITS: &[(&str, Rows)] = &[];
