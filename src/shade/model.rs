//! The colour model: no more than the materials and lights of a scene need, and a sentence that says what that is.

use crate::scene::{Material, Scene};

use super::scatter::{mirrors, transmits};

/// What a scene needs to be coloured.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Model {
    /// Lights; none means a head light.
    pub lights: usize,
    /// Whether a used material has highlights that a light can cause.
    pub highlights: bool,
    /// Used materials that glow by themselves.
    pub glowing: usize,
    /// Whether a used material mirrors.
    pub mirror: bool,
    /// Whether a used material lets light through.
    pub glass: bool,
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
        let count = |has: fn(&Material) -> bool| {
            let used = (scene.materials.iter().zip(&used)).filter(|(_, used)| **used);
            used.filter(|(material, _)| has(material)).count()
        };
        let any = |has| count(has) > 0;
        Self {
            lights: scene.lights.len(),
            highlights: !scene.lights.is_empty() && any(has_highlight),
            glowing: count(|material| material.emission.max_element() > 0.0),
            mirror: any(|material| mirrors(material) && !transmits(material)),
            glass: any(transmits),
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
        if self.glowing > 0 {
            text.push_str("; glowing surfaces");
        }
        text.push_str(match (self.mirror, self.glass) {
            (false, false) => "; no mirror, no glass",
            (true, false) => "; mirrors, no glass",
            (false, true) => "; glass, no mirror",
            (true, true) => "; mirrors, glass",
        });
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
            "Lambert, head light; no shadows needed; no mirror, no glass"
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
            "Lambert, 1 light with shadows; no mirror, no glass"
        );
        scene.material_of = vec![1];
        assert!(Model::of(&scene).describe().starts_with("Blinn-Phong"));
    }
}
