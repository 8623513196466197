//! Where light goes on at mirrors and glass: directions and shares.
//!
//! ```text
//!      in \   ^ reflected: R
//!          \ /
//!   -------------------
//!            \
//!             v refracted: 1 − R, none beyond the critical angle
//! ```
//!
//! **Source:** Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., §9.3 (dielectric Fresnel); Schlick, "An
//! inexpensive BRDF model" (1994), for mirrors.
//! **Differs:** every material that transmits has Fresnel's shares, also where MTL's `illum` leaves them out. Whether a
//! ray enters or leaves glass follows from its way so far, not from the winding of triangles.

use crate::geometry::Vec3;
use crate::scene::Material;

/// Whether MTL's `illum` makes the material a mirror, wholly or in part.
pub(super) fn mirrors(material: &Material) -> bool {
    matches!(material.illum, 3..=9) && material.specular.max_element() > 0.0
}

/// Whether MTL's `illum` lets light through the material.
pub(super) fn transmits(material: &Material) -> bool {
    matches!(material.illum, 4 | 6 | 7 | 9) && material.transmission.max_element() > 0.0
}

/// A way on from a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Way {
    /// Unit direction.
    pub dir: Vec3,
    /// Share of the light from there that goes on, linear RGB.
    pub share: Vec3,
}

/// Where a ray goes on: by reflection, by refraction.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Ways {
    /// Back from the surface.
    pub reflected: Option<Way>,
    /// Through it.
    pub refracted: Option<Way>,
}

/// Where a ray with unit `dir` goes on from a surface whose unit `normal` faces it; `inside` says whether it runs within
/// the material.
pub(super) fn ways(material: &Material, normal: Vec3, dir: Vec3, inside: bool) -> Ways {
    let cosine = (-normal.dot(dir)).clamp(0.0, 1.0);
    let mirrored = (dir + normal * (2.0 * cosine)).normalize_or(normal);
    let reflected = |share: Vec3| Way {
        dir: mirrored,
        share,
    };
    if transmits(material) {
        // How many times slower light is behind the surface than before it.
        let index = match material.refraction_index.max(f32::MIN_POSITIVE) {
            index if inside => 1.0 / index,
            index => index,
        };
        let (share, behind) = dielectric(cosine, index);
        let refracted = behind.map(|behind| Way {
            dir: (dir / index + normal * (cosine / index - behind)).normalize_or(dir),
            share: material.transmission * (1.0 - share),
        });
        return Ways {
            reflected: Some(reflected(material.specular * share)),
            refracted,
        };
    }
    if !mirrors(material) {
        return Ways::default();
    }
    // Model 3 reflects its colour from all sides, the others more at a grazing angle.
    let grazing = if material.illum == 3 {
        0.0
    } else {
        (1.0 - cosine).powi(5)
    };
    let share = material.specular + (Vec3::ONE - material.specular) * grazing;
    Ways {
        reflected: Some(reflected(share)),
        refracted: None,
    }
}

/// The share of unpolarised light that a surface reflects, and the cosine behind it: `None` beyond the critical angle,
/// where all is reflected.
fn dielectric(cosine: f32, index: f32) -> (f32, Option<f32>) {
    let sine_squared = (1.0 - cosine * cosine) / (index * index);
    if sine_squared >= 1.0 {
        return (1.0, None);
    }
    let behind = (1.0 - sine_squared).sqrt();
    let parallel = (index * cosine - behind) / (index * cosine + behind);
    let perpendicular = (cosine - index * behind) / (cosine + index * behind);
    let share = 0.5 * (parallel * parallel + perpendicular * perpendicular);
    // At cosine 0 both quotients are 0 / 0 only for an index of 1, which reflects nothing.
    (if share.is_nan() { 0.0 } else { share }, Some(behind))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glass() -> Material {
        Material {
            specular: Vec3::ONE,
            refraction_index: 1.5,
            illum: 7,
            ..Material::default()
        }
    }

    fn slanted(degrees: f32) -> Vec3 {
        let angle = degrees.to_radians();
        Vec3::new(angle.sin(), 0.0, -angle.cos())
    }

    #[test]
    fn glass_seen_face_on_reflects_four_hundredths_and_does_not_bend() {
        let ways = ways(&glass(), Vec3::Z, Vec3::NEG_Z, false);
        let (reflected, refracted) = (ways.reflected.unwrap(), ways.refracted.unwrap());
        assert!((reflected.share.x - 0.04).abs() < 1e-6);
        assert!((refracted.share.x - 0.96).abs() < 1e-6);
        assert_eq!((reflected.dir, refracted.dir), (Vec3::Z, Vec3::NEG_Z));
    }

    #[test]
    fn refraction_obeys_snell_and_is_undone_on_the_way_out() {
        let dir = slanted(40.0);
        let within = ways(&glass(), Vec3::Z, dir, false).refracted.unwrap().dir;
        assert!((within.x - dir.x / 1.5).abs() < 1e-6);
        let outside = ways(&glass(), Vec3::Z, within, true).refracted.unwrap().dir;
        assert!(outside.distance(dir) < 1e-6);
    }

    #[test]
    fn beyond_the_critical_angle_all_light_is_reflected() {
        // The sine of the critical angle is 1 / 1.5: 41.8 degrees.
        let below = ways(&glass(), Vec3::Z, slanted(41.5), true);
        assert!(below.refracted.is_some());
        let beyond = ways(&glass(), Vec3::Z, slanted(42.5), true);
        assert_eq!(beyond.refracted, None);
        assert_eq!(beyond.reflected.unwrap().share, Vec3::ONE);
    }

    #[test]
    fn shares_never_add_up_to_more_than_all_light() {
        for inside in [false, true] {
            for degrees in 0..=90 {
                let ways = ways(&glass(), Vec3::Z, slanted(degrees as f32), inside);
                let share = |way: Option<Way>| way.map_or(0.0, |w| w.share.x);
                let sum = share(ways.reflected) + share(ways.refracted);
                assert!((sum - 1.0).abs() < 1e-5, "{degrees}: {sum}");
            }
        }
    }

    #[test]
    fn a_mirror_reflects_and_a_matte_surface_sends_nothing_on() {
        let mirror = Material {
            specular: Vec3::splat(0.9),
            illum: 3,
            ..Material::default()
        };
        let way = ways(&mirror, Vec3::Z, slanted(30.0), false)
            .reflected
            .unwrap();
        assert_eq!(way.share, Vec3::splat(0.9));
        assert!(
            way.dir
                .distance(Vec3::new(0.5, 0.0, 30.0_f32.to_radians().cos()))
                < 1e-6
        );
        assert_eq!(
            ways(&Material::default(), Vec3::Z, Vec3::NEG_Z, false),
            Ways::default()
        );
    }
}
