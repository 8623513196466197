//! Scenes: a mesh with materials, lights and a camera; where they come from.
//!
//! A scene is named by a *spec*: a bundled name (`teapot`), a procedural family with its size (`soup:1000,0.5`), or a
//! path to an `.obj`. [`load`] turns a spec into a [`Scene`].

use std::sync::Arc;

use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::geometry::Vec3;
use crate::registry::ParamSpec;

mod bundled;
mod camera;
mod catalog;
mod error;
pub mod family;
mod mesh;
mod obj;
mod polygon;

pub use camera::Camera;
pub use catalog::{MAX_TRIANGLES, SCENES, Sizes, check, family_of, load};
pub use error::SceneError;
pub use mesh::{Mesh, MeshError};

/// Linear RGB behind scenes that do not say: dark enough that every surface stands out.
const BACKGROUND: Vec3 = Vec3::new(0.03, 0.035, 0.045);

/// What reflects light at a triangle, as MTL states it.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name in the MTL file.
    pub name: String,
    /// Diffuse reflectance (Kd), linear RGB in 0..1.
    pub diffuse: Vec3,
    /// Specular reflectance (Ks).
    pub specular: Vec3,
    /// Specular exponent (Ns).
    pub shininess: f32,
    /// Transmission filter (Tf).
    pub transmission: Vec3,
    /// Index of refraction (Ni).
    pub refraction_index: f32,
    /// 1 is opaque (d).
    pub opacity: f32,
    /// Emitted radiance (Ke).
    pub emission: Vec3,
    /// MTL illumination model; 3, 5, 7 mirror, 4, 6, 7, 9 transmit.
    pub illum: u8,
}

impl Default for Material {
    /// Matte light grey, what a mesh without materials gets.
    fn default() -> Self {
        Self {
            name: "default".to_owned(),
            diffuse: Vec3::splat(0.8),
            specular: Vec3::ZERO,
            shininess: 10.0,
            transmission: Vec3::ONE,
            refraction_index: 1.0,
            opacity: 1.0,
            emission: Vec3::ZERO,
            illum: 1,
        }
    }
}

/// A point light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Where it is.
    pub position: Vec3,
    /// Radiant intensity, linear RGB: at distance d a surface that faces the light receives `intensity` / d².
    pub intensity: Vec3,
}

/// Everything that is rendered and measured.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The spec it was loaded from.
    pub name: String,
    /// One sentence: what the scene is good for.
    pub about: String,
    /// The triangles.
    pub mesh: Arc<Mesh>,
    /// Materials; never empty.
    pub materials: Vec<Material>,
    /// For each triangle the index of its material.
    pub material_of: Vec<u32>,
    /// Lights; none means a head light.
    pub lights: Vec<Light>,
    /// The default view.
    pub camera: Camera,
    /// Colour where no triangle is hit, linear RGB.
    pub background: Vec3,
    /// What the reader had to mend or ignore, one sentence each.
    pub warnings: Vec<String>,
}

impl Scene {
    /// The material of a triangle.
    #[must_use]
    pub fn material(&self, prim: u32) -> &Material {
        &self.materials[self.material_of[prim as usize] as usize]
    }
}

/// A row of the scene registry.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct SceneEntry {
    /// Kebab-case name: the part of a spec before its `:`.
    pub name: &'static str,
    /// One sentence: what the scene is good for.
    pub about: &'static str,
    /// How sizes are written, e.g. `N[,s]`; empty for scenes without a size.
    pub size: &'static str,
    /// The sizes in the order in which they are written, with bounds and defaults; an empty default means "none".
    pub params: &'static [ParamSpec],
    /// An example spec, small enough for tests.
    pub example: &'static str,
    /// Whether no ray can hit the scene.
    pub blind: bool,
    /// How many triangles the scene will have.
    #[serde(skip)]
    pub triangles: fn(&Sizes) -> u64,
    /// Builds the scene; its name and sentence are filled in by [`load`].
    #[serde(skip)]
    pub build: fn(&Sizes) -> Result<Scene, SceneError>,
}

/// SHA-256 of a mesh in lowercase hexadecimal: numbers of vertices and triangles, vertices, triangles, little-endian.
///
/// Depends on the mesh alone, so it is the same on every machine for the same mesh, bit for bit.
#[must_use]
pub fn hash(mesh: &Mesh) -> String {
    let mut sha = Sha256::new();
    sha.update((mesh.vertices().len() as u64).to_le_bytes());
    sha.update((mesh.len() as u64).to_le_bytes());
    // In blocks, because hashing a few bytes at a time costs several times as much.
    let mut block = Vec::with_capacity(12 << 10);
    let mut flush = |block: &mut Vec<u8>, at_least: usize| {
        if block.len() >= at_least {
            sha.update(&*block);
            block.clear();
        }
    };
    for vertex in mesh.vertices() {
        block.extend(vertex.to_array().into_iter().flat_map(f32::to_le_bytes));
        flush(&mut block, 12 << 10);
    }
    for triangle in mesh.triangles() {
        block.extend(triangle.iter().flat_map(|i| i.to_le_bytes()));
        flush(&mut block, 12 << 10);
    }
    flush(&mut block, 0);
    format!("{:x}", sha.finalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_of_the_empty_mesh_is_that_of_sixteen_zero_bytes() {
        assert_eq!(
            hash(&load("empty").unwrap().mesh),
            "374708fff7719dd5979ec875d56cd2286f6d3cf7ec317a3b25632aab28ec37bb"
        );
    }

    #[test]
    fn meshes_that_differ_in_one_bit_have_different_hashes() {
        let mesh = |x: f32| {
            let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::new(x, 1.0, 0.0)];
            Mesh::new(vertices, vec![[0, 1, 2]]).unwrap()
        };
        assert_eq!(hash(&mesh(0.0)), hash(&mesh(0.0)));
        assert_ne!(hash(&mesh(0.0)), hash(&mesh(-0.0)));
    }
}
