//! A scene under construction.

use std::sync::Arc;

use super::Icosphere;
use crate::geometry::{DVec3, Vec3};
use crate::scene::{BACKGROUND, Camera, Light, Material, Mesh, Scene, SceneError};

/// Corners of a box's faces (−z, +z, −y, +y, −x, +x), counter-clockwise seen from outside; corner k has bits xyz.
pub(super) const CUBOID_FACES: [[usize; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

/// Vertices, triangles and what colours them, until [`Draft::finish`] makes a scene of them.
pub(in crate::scene) struct Draft {
    pub vertices: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// Empty means: all of material 0.
    pub material_of: Vec<u32>,
    /// Empty means: the default material.
    pub materials: Vec<Material>,
    pub lights: Vec<Light>,
    /// Upwards in the picture.
    pub up: Vec3,
    /// `None` frames the whole box.
    pub camera: Option<Camera>,
}

impl Draft {
    /// Nothing yet, with `up` upwards.
    pub fn new(up: Vec3) -> Self {
        Self {
            vertices: Vec::new(),
            triangles: Vec::new(),
            material_of: Vec::new(),
            materials: Vec::new(),
            lights: Vec::new(),
            up,
            camera: None,
        }
    }

    /// Adds a vertex and returns its index. −0 becomes +0, so that equal points have equal bits.
    pub fn vertex(&mut self, point: DVec3) -> u32 {
        self.vertices.push(point.as_vec3() + Vec3::ZERO);
        self.vertices.len() as u32 - 1
    }

    /// Adds a triangle with vertices of its own.
    pub fn triangle(&mut self, corners: [DVec3; 3]) {
        let corners = corners.map(|p| self.vertex(p));
        self.triangles.push(corners);
    }

    /// Adds the quadrilateral over vertices `[a, b, c, d]`, cut from `a` to `c`.
    pub fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangles.push([a, b, c]);
        self.triangles.push([a, c, d]);
    }

    /// Adds the six faces of a box over its eight corners, x fastest, normals outwards: 12 triangles.
    pub fn cuboid(&mut self, corners: [u32; 8]) {
        for face in CUBOID_FACES {
            self.quad(face.map(|k| corners[k]));
        }
    }

    /// Adds a sphere.
    pub fn sphere(&mut self, unit: &Icosphere, centre: DVec3, radius: f64) {
        let first = self.vertices.len() as u32;
        for &point in &unit.points {
            self.vertex(centre + point * radius);
        }
        let own = unit.triangles.iter().map(|t| t.map(|i| i + first));
        self.triangles.extend(own);
    }

    /// Adds the square of half side `reach` around the z axis at `height`, facing up: two triangles.
    pub fn floor(&mut self, reach: f64, height: f64) {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let corners = corners.map(|(x, y)| self.vertex(DVec3::new(x * reach, y * reach, height)));
        self.quad(corners);
    }

    /// Gives all triangles that have no material yet the next one.
    pub fn paint(&mut self, material: Material) {
        let index = self.materials.len() as u32;
        self.materials.push(material);
        self.material_of.resize(self.triangles.len(), index);
    }

    /// The scene, without name and sentence.
    ///
    /// # Errors
    /// Vertices and triangles that are no mesh.
    pub fn finish(mut self) -> Result<Scene, SceneError> {
        if self.materials.is_empty() {
            self.paint(Material::default());
        }
        self.material_of.resize(self.triangles.len(), 0);
        let mesh = Mesh::new(self.vertices, self.triangles)?;
        let camera = self
            .camera
            .unwrap_or_else(|| Camera::framing(mesh.bounds(), self.up));
        Ok(Scene {
            name: String::new(),
            about: String::new(),
            mesh: Arc::new(mesh),
            materials: self.materials,
            material_of: self.material_of,
            lights: self.lights,
            camera,
            background: BACKGROUND,
            warnings: Vec::new(),
        })
    }
}

/// A matte material of the given linear RGB.
pub(in crate::scene) fn matte(name: &str, r: f32, g: f32, b: f32) -> Material {
    Material {
        name: name.to_owned(),
        diffuse: Vec3::new(r, g, b),
        ..Material::default()
    }
}
