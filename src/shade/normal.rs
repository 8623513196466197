//! The channel `normal`: the direction of each pixel's triangle, on the side that faces the eye.
//!
//! Red, green and blue grow with x, y and z, as in normal maps: a surface that faces +z is light blue.

use crate::geometry::{Hit, Ray, Vec3, unit_normal};
use crate::scene::Mesh;

use super::channel::{Channel, Painter};
use super::image::to_srgb;

pub(super) const CHANNEL: Channel = Channel {
    name: "normal",
    about: "Direction of each triangle's normal on the side that faces the eye: x red, y green, z blue.",
    paint: |view| {
        let view = *view;
        let background = to_srgb(view.scene.background);
        Painter::Colours {
            tile: Box::new(move |rays, counts| {
                counts.primary += rays.len() as u64;
                let mut hits = vec![Hit::MISS; rays.len()];
                view.accel.closest(rays, &mut hits);
                let colour = |(ray, hit): (&Ray, &Hit)| {
                    if !hit.is_hit() {
                        return background;
                    }
                    counts.hits += 1;
                    encode(facing_normal(&view.scene.mesh, hit.prim, ray.dir))
                };
                rays.iter().zip(&hits).map(colour).collect()
            }),
            found: "geometric normals".to_owned(),
        }
    },
};

/// The unit normal of a triangle on the side that `dir` comes from; against `dir` where the triangle has no area.
pub(super) fn facing_normal(mesh: &Mesh, prim: u32, dir: Vec3) -> Vec3 {
    match unit_normal(&mesh.corners(prim)) {
        Some(normal) if normal.dot(dir) > 0.0 => -normal,
        Some(normal) => normal,
        None => -dir,
    }
}

/// −1 becomes 0 and 1 becomes 255.
fn encode(normal: Vec3) -> [u8; 3] {
    normal.to_array().map(|x| (127.5 * x + 128.0) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_faces_the_ray_whatever_the_winding() {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = Mesh::new(corners, vec![[0, 1, 2], [0, 2, 1]]).unwrap();
        for prim in 0..2 {
            assert_eq!(facing_normal(&mesh, prim, Vec3::NEG_Z), Vec3::Z);
            assert_eq!(facing_normal(&mesh, prim, Vec3::Z), Vec3::NEG_Z);
        }
        assert_eq!(encode(Vec3::Z), [128, 128, 255]);
        assert_eq!(encode(Vec3::NEG_X), [0, 128, 128]);
    }
}
