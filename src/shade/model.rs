//! The colour model: no more than the materials and lights of a scene need, and a sentence that says what that is.

use crate::scene::{Material, Scene};

/// What a scene needs to be coloured.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Model {
    /// Lights; none means a head light.
    pub lights: usize,
    /// Whether a used material has highlights that a light can cause.
    pub highlights: bool,
    /// Whether a used material glows by itself.
    pub glow: bool,
}

impl Model {
    /// What `scene` needs; only materials that a triangle uses count.
    pub fn of(scene: &Scene) -> Self {
        let mut used = vec![false; scene.materials.len()];
        for &index in &scene.material_of {
            if let Some(used) = used.get_mut(index as usize) {
                *used = true;
            }
        }
        let any = |has: fn(&Material) -> bool| {
            (scene.materials.iter().zip(&used)).any(|(material, &used)| used && has(material))
        };
        Self {
            lights: scene.lights.len(),
            highlights: !scene.lights.is_empty() && any(has_highlight),
            glow: any(|material| material.emission.max_element() > 0.0),
        }
    }

    /// One sentence without its full stop, e.g. `Blinn-Phong, 2 lights with shadows`.
    pub fn describe(&self) -> String {
        let mut text = match (self.lights, self.highlights) {
            (0, _) => "Lambert, head light; no shadows needed".to_owned(),
            (1, false) => "Lambert, 1 light with shadows".to_owned(),
            (n, false) => format!("Lambert, {n} lights with shadows"),
            (1, true) => "Blinn-Phong, 1 light with shadows".to_owned(),
            (n, true) => format!("Blinn-Phong, {n} lights with shadows"),
        };
        if self.glow {
            text.push_str("; glowing surfaces");
        }
        text
    }
}

/// Whether MTL's illumination model gives the material highlights.
pub(super) fn has_highlight(material: &Material) -> bool {
    material.illum >= 2 && material.specular.max_element() > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;
    use crate::scene::Light;

    #[test]
    fn a_scene_without_lights_needs_no_shadows() {
        let scene = crate::scene::load("one").unwrap();
        let bare = Scene {
            lights: Vec::new(),
            ..scene
        };
        assert_eq!(
            Model::of(&bare).describe(),
            "Lambert, head light; no shadows needed"
        );
    }

    #[test]
    fn materials_that_no_triangle_uses_do_not_count() {
        let mut scene = crate::scene::load("one").unwrap();
        scene.lights = vec![Light {
            position: Vec3::Y,
            intensity: Vec3::ONE,
        }];
        scene.materials = vec![Material::default(), Material::default()];
        scene.materials[1].specular = Vec3::ONE;
        scene.materials[1].illum = 2;
        scene.material_of = vec![0];
        assert_eq!(
            Model::of(&scene).describe(),
            "Lambert, 1 light with shadows"
        );
        scene.material_of = vec![1];
        assert!(Model::of(&scene).describe().starts_with("Blinn-Phong"));
    }
}
