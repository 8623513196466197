//! Light at a point of a surface: Lambert and Blinn-Phong as MTL's `illum` says, and the exposure of the picture.
//!
//! **Source:** Blinn, "Models of light reflection for computer synthesized pictures" (1977); the MTL format of
//! Wavefront for what `illum` selects.
//! **Differs:** MTL's constant ambient term is replaced by a weak fill from the eye, so that what lies in shadow keeps
//! its shape; exposure follows from the scene's lights and surfaces, not from the picture, so that it does not flicker
//! while the eye moves.

use crate::geometry::{SurfacePoint, Vec3, unit_normal};
use crate::scene::{Light, Material, Scene};

use super::model::has_highlight;

/// Share of the reference light that fills shadows.
const FILL: f32 = 0.12;

/// Brightness of a white surface in the reference light, where 1 is the white of the screen.
const KEY: f32 = 0.8;

/// Triangles that are looked at to find the exposure; they are spread over the whole list.
const SAMPLES: usize = 2048;

/// A point of a surface as seen along a ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surface<'a> {
    /// What reflects.
    pub material: &'a Material,
    /// The point.
    pub point: SurfacePoint,
    /// Unit normal on the side that is seen.
    pub normal: Vec3,
    /// Unit direction to where it is seen from.
    pub to_eye: Vec3,
}

/// A light as a point of a surface receives it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Incoming {
    /// From the point to the light, full length.
    pub towards: Vec3,
    /// What the surface would send to the eye if nothing stood in between, linear RGB.
    pub reflected: Vec3,
}

/// What a surface sends to the eye by a light; `None` where the light cannot matter: it lies behind the side that is
/// seen, or the material reflects nothing of it.
pub(super) fn incoming(surface: &Surface, light: &Light) -> Option<Incoming> {
    let towards = light.position - surface.point.position;
    let distance_squared = towards.length_squared();
    let direction = towards.try_normalize()?;
    let cosine = surface.normal.dot(direction);
    if cosine <= 0.0 {
        return None;
    }
    let material = surface.material;
    let mut reflectance = material.diffuse * cosine;
    if has_highlight(material) {
        let half = (direction + surface.to_eye).normalize_or(surface.normal);
        let shine = surface.normal.dot(half).max(0.0);
        reflectance += material.specular * shine.powf(material.shininess.max(0.0));
    }
    let reflected = reflectance * light.intensity / distance_squared;
    (reflected.max_element() > 0.0 && reflected.is_finite())
        .then_some(Incoming { towards, reflected })
}

/// What a surface sends to the eye by a white light of brightness 1 at the eye: Lambert.
pub(super) fn head_light(surface: &Surface) -> Vec3 {
    surface.material.diffuse * surface.normal.dot(surface.to_eye).max(0.0)
}

/// How much light becomes how much brightness on the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Exposure {
    /// Multiplies light that surfaces send.
    pub scale: f32,
    /// Light that fills shadows, before `scale`.
    pub fill: f32,
}

impl Exposure {
    /// The exposure for a head light: a white surface seen face on is the white of the screen, and nothing is filled.
    pub const HEAD_LIGHT: Self = Self {
        scale: 1.0,
        fill: 0.0,
    };

    /// The exposure of `scene`: surfaces that get more light than three quarters of the lit area do, and are white,
    /// come out at [`KEY`].
    pub fn of(scene: &Scene) -> Self {
        if scene.lights.is_empty() {
            return Self::HEAD_LIGHT;
        }
        let mut lit = lit_areas(scene);
        lit.sort_by(|a, b| a.0.total_cmp(&b.0));
        let three_quarters = lit.iter().map(|(_, area)| area).sum::<f64>() * 0.75;
        let mut below = 0.0;
        let reference = lit.iter().find(|(_, area)| {
            below += area;
            below >= three_quarters
        });
        match reference {
            Some(&(light, _)) => Self {
                scale: KEY / light,
                fill: FILL * light,
            },
            None => Self::HEAD_LIGHT,
        }
    }

    /// The brightness of light on the screen, 0..1, where nothing is cut off: above [`KEY`] it nears 1 ever slower.
    pub fn brightness(self, light: Vec3) -> Vec3 {
        let room = 1.0 - KEY;
        let soft = |x: f32| {
            if x <= KEY {
                x
            } else {
                KEY + room * (1.0 - (-(x - KEY) / room).exp())
            }
        };
        if self == Self::HEAD_LIGHT {
            return light;
        }
        Vec3::from_array((light * self.scale).to_array().map(soft))
    }
}

/// For triangles spread over the scene: the light at their centres with nothing in between, and their areas. Triangles
/// without light or area, and those that glow by themselves, are left out.
fn lit_areas(scene: &Scene) -> Vec<(f32, f64)> {
    let mesh = &scene.mesh;
    let stride = mesh.len().div_ceil(SAMPLES).max(1);
    (0..mesh.len() as u32)
        .step_by(stride)
        .filter(|&prim| scene.material(prim).emission.max_element() <= 0.0)
        .filter_map(|prim| {
            let corners = mesh.corners(prim);
            let normal = unit_normal(&corners)?;
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let area = (b - a).cross(c - a).length() * 0.5;
            let centre = ((a + b + c) / 3.0).as_vec3();
            let light: f32 = (scene.lights.iter())
                .map(|light| irradiance(light, centre, normal))
                .sum();
            (light > 0.0 && light.is_finite() && area > 0.0).then_some((light, area))
        })
        .collect()
}

/// Light that a point with a two-sided normal receives, as the brightest of red, green and blue.
fn irradiance(light: &Light, position: Vec3, normal: Vec3) -> f32 {
    let towards = light.position - position;
    let cosine = towards.normalize_or_zero().dot(normal).abs();
    light.intensity.max_element() * cosine / towards.length_squared()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIGHT: Light = Light {
        position: Vec3::new(0.0, 0.0, 2.0),
        intensity: Vec3::splat(4.0),
    };

    fn surface(material: &Material) -> Surface<'_> {
        Surface {
            material,
            point: SurfacePoint::of(&[Vec3::ZERO; 3], 0.0, 0.0),
            normal: Vec3::Z,
            to_eye: Vec3::Z,
        }
    }

    #[test]
    fn light_falls_off_with_the_square_of_the_distance() {
        let material = Material::default();
        let near = incoming(&surface(&material), &LIGHT).unwrap();
        assert_eq!(near.reflected, Vec3::splat(0.8));
        let far = Light {
            position: Vec3::new(0.0, 0.0, 4.0),
            ..LIGHT
        };
        let far = incoming(&surface(&material), &far).unwrap();
        assert_eq!(far.reflected, Vec3::splat(0.2));
    }

    #[test]
    fn a_light_behind_the_surface_cannot_matter() {
        let material = Material::default();
        let behind = Light {
            position: Vec3::NEG_Z,
            ..LIGHT
        };
        assert!(incoming(&surface(&material), &behind).is_none());
        let black = Material {
            diffuse: Vec3::ZERO,
            ..Material::default()
        };
        assert!(incoming(&surface(&black), &LIGHT).is_none());
    }

    #[test]
    fn only_illum_2_and_above_has_highlights() {
        let with = |illum| Material {
            specular: Vec3::splat(0.5),
            illum,
            ..Material::default()
        };
        let reflected =
            |material: &Material| incoming(&surface(material), &LIGHT).unwrap().reflected;
        assert_eq!(reflected(&with(1)), Vec3::splat(0.8));
        assert_eq!(reflected(&with(2)), Vec3::splat(1.3));
    }

    #[test]
    fn brightness_rises_with_light_and_never_reaches_beyond_white() {
        let exposure = Exposure {
            scale: 0.5,
            fill: 0.1,
        };
        let brightness = |x: f32| exposure.brightness(Vec3::splat(x)).x;
        assert_eq!(brightness(1.0), 0.5);
        assert!((0..100).all(|i| brightness(i as f32 * 0.05) < brightness((i + 1) as f32 * 0.05)));
        assert!(brightness(1e9) <= 1.0);
    }

    #[test]
    fn brighter_lights_give_the_same_exposed_picture() {
        let mut scene = crate::scene::load("one").unwrap();
        let at = scene.mesh.bounds().centre() + Vec3::ONE;
        let exposed = |scene: &mut Scene, intensity: f32| {
            scene.lights = vec![Light {
                position: at,
                intensity: Vec3::splat(intensity),
            }];
            Exposure::of(scene).scale * intensity
        };
        let (dim, bright) = (exposed(&mut scene, 1.0), exposed(&mut scene, 1024.0));
        assert_eq!(dim, bright);
    }
}
