//! Scenes: a mesh with materials, lights and a camera; where they come from.
//!
//! A scene is named by a *spec*: a bundled name (`teapot`), a procedural family with its size (`soup:1000,0.5`), or a
//! path to an `.obj`. [`load`] turns a spec into a [`Scene`].

use std::sync::Arc;

use serde::Serialize;

use crate::geometry::Vec3;

mod camera;
mod mesh;

pub use camera::Camera;
pub use mesh::{Mesh, MeshError};

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
    /// Radiant intensity, linear RGB; falls off with the square of the distance over `reach`.
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
    /// An example spec, small enough for tests.
    pub example: &'static str,
}
