//! Triangle meshes in `f32`.

use thiserror::Error;

use crate::geometry::lanes::prefetch;
use crate::geometry::{Aabb, Vec3};

/// Triangles over shared vertices. All coordinates are finite and all indices in range.
///
/// Triangles without area stay in: they are stability cases, and their indices count.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    bounds: Aabb,
}

/// Why vertices and triangles are not a mesh.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} is not finite; every coordinate must be a finite number")]
    NotFinite {
        /// Index of the vertex, from 0.
        vertex: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {vertices}")]
    OutOfRange {
        /// Index of the triangle, from 0.
        triangle: usize,
        /// The index it names, from 0.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// More triangles than an index can name.
    #[error("{0} triangles are more than the 2^31 that an index can name")]
    TooMany(usize),
}

impl Mesh {
    /// Checks and takes vertices and triangles.
    ///
    /// # Errors
    /// A coordinate that is not finite, an index out of range, too many triangles.
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        if let Some(vertex) = vertices.iter().position(|v| !v.is_finite()) {
            return Err(MeshError::NotFinite { vertex });
        }
        if triangles.len() > 1 << 31 {
            return Err(MeshError::TooMany(triangles.len()));
        }
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices.len()) {
                return Err(MeshError::OutOfRange {
                    triangle,
                    vertex,
                    vertices: vertices.len(),
                });
            }
        }
        // Vertices that no triangle uses must not enlarge the box.
        let bounds = Aabb::of_points(triangles.iter().flatten().map(|&v| vertices[v as usize]));
        Ok(Self {
            vertices,
            triangles,
            bounds,
        })
    }

    /// Number of triangles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there are no triangles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The corners of a triangle.
    #[must_use]
    #[inline(always)]
    pub fn corners(&self, prim: u32) -> [Vec3; 3] {
        self.triangles[prim as usize].map(|v| self.vertices[v as usize])
    }

    /// Fetches what [`Mesh::corners`] reads first of a triangle whose corners are asked for later.
    #[inline(always)]
    pub fn prefetch_triangle(&self, prim: u32) {
        prefetch(&raw const self.triangles[prim as usize], 1);
    }

    /// Fetches the corners of a triangle that are asked for soon.
    #[inline(always)]
    pub fn prefetch_corners(&self, prim: u32) {
        for vertex in self.triangles[prim as usize] {
            prefetch(&raw const self.vertices[vertex as usize], 1);
        }
    }

    /// The box of a triangle.
    #[must_use]
    pub fn triangle_bounds(&self, prim: u32) -> Aabb {
        Aabb::of_points(self.corners(prim))
    }

    /// The smallest box around all triangles; empty where there are none.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// All vertices, used or not.
    #[must_use]
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Vertex indices of each triangle.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// How many triangles have no area: their corners lie on a line or in a point, evaluated in `f64`.
    #[must_use]
    pub fn degenerate(&self) -> usize {
        (0..self.len() as u32)
            .filter(|&prim| {
                let [a, b, c] = self.corners(prim).map(Vec3::as_dvec3);
                (b - a).cross(c - a).length_squared() == 0.0
            })
            .count()
    }
}
