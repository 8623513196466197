//! OBJ and MTL files.

use std::path::Path;
use std::sync::Arc;

use super::{Camera, Material, Mesh, Scene, SceneError};
use crate::geometry::Vec3;

/// Loads the mesh in `path`.
pub fn load_file(path: &Path) -> Result<Scene, SceneError> {
    let unreadable = |reason: String| SceneError::Unreadable {
        path: path.to_owned(),
        reason,
    };
    let text = std::fs::read(path).map_err(|e| unreadable(e.to_string()))?;
    let options = tobj::LoadOptions {
        triangulate: true,
        ..tobj::LoadOptions::default()
    };
    let (models, _) = tobj::load_obj_buf(&mut &text[..], &options, |_| {
        Err(tobj::LoadError::OpenFileFailed)
    })
    .map_err(|e| unreadable(e.to_string()))?;
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for model in models {
        let first = vertices.len() as u32;
        vertices.extend(model.mesh.positions.chunks(3).map(Vec3::from_slice));
        triangles.extend(
            model
                .mesh
                .indices
                .chunks(3)
                .map(|t| [t[0] + first, t[1] + first, t[2] + first]),
        );
    }
    let mesh = Mesh::new(vertices, triangles)?;
    Ok(Scene {
        name: path.display().to_string(),
        about: "A mesh from a file.".to_owned(),
        materials: vec![Material::default()],
        material_of: vec![0; mesh.len()],
        lights: Vec::new(),
        camera: Camera::framing(mesh.bounds(), Vec3::Y),
        background: Vec3::new(0.03, 0.035, 0.045),
        warnings: Vec::new(),
        mesh: Arc::new(mesh),
    })
}

/// Checks that `path` can be opened.
pub fn check_file(path: &Path) -> Result<(), SceneError> {
    std::fs::File::open(path)
        .map(|_| ())
        .map_err(|e| SceneError::Unreadable {
            path: path.to_owned(),
            reason: e.to_string(),
        })
}
