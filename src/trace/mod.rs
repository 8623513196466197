//! Ray sets, and tracing them in batches over threads.

use serde::{Deserialize, Serialize};

use crate::geometry::Ray;

/// What is asked of each ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Query {
    /// The nearest hit.
    Closest,
    /// Whether anything is hit.
    Occluded,
}

/// Rays to trace, all of them valid.
#[derive(Debug, Clone, PartialEq)]
pub struct RaySet {
    /// The spec it was made from: `primary`, `shadow`, …, `file:PATH`.
    pub name: String,
    /// What is asked of each ray.
    pub query: Query,
    /// The rays; neighbours in the list are neighbours in space where the set has any order.
    pub rays: Vec<Ray>,
    /// What a reader of figures from this set should know, one sentence each.
    pub warnings: Vec<String>,
}
