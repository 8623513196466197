//! A pinhole camera.

use crate::geometry::{Aabb, Ray, Vec3};

/// Where the picture is taken from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Where rays start.
    pub eye: Vec3,
    /// What the middle of the picture shows.
    pub at: Vec3,
    /// Upwards in the picture; need not be perpendicular to the view.
    pub up: Vec3,
    /// Field of view in degrees across the smaller side of the picture: the vertical one, unless it stands upright.
    pub fov_deg: f32,
}

impl Camera {
    /// A view of all of `bounds` from the front, a little from the right and above: the nearest one in which the box
    /// fits into a square picture. The empty box, and a point, are seen from distance 1.
    #[must_use]
    pub fn framing(bounds: Aabb, up: Vec3) -> Self {
        let fov_deg: f32 = 38.0;
        // For y up: from +z; for z up: from -y.
        let front = if up.z.abs() > up.y.abs() {
            Vec3::NEG_Y
        } else {
            Vec3::Z
        };
        let right = front.cross(up).normalize_or_zero() * -1.0;
        let towards = (front + right * 0.55 + up * 0.45).normalize();
        let at = if bounds.is_empty() {
            Vec3::ZERO
        } else {
            bounds.centre()
        };
        let camera = Self {
            eye: at + towards,
            at,
            up,
            fov_deg,
        };
        // A corner is in the picture when its distance from the axis of view is at most `half` of its depth; a little
        // space stays at the sides.
        let half = (fov_deg.to_radians() * 0.5).tan() / 1.05;
        let (x, y, z) = camera.frame();
        let fits = |corner: Vec3| {
            let from_middle = corner - at;
            let aside = from_middle.dot(x).abs().max(from_middle.dot(y).abs());
            aside / half - from_middle.dot(z)
        };
        let distance = if bounds.is_empty() {
            0.0
        } else {
            bounds.corners().into_iter().map(fits).fold(0.0, f32::max)
        };
        let distance = if distance > 0.0 { distance } else { 1.0 };
        Self {
            eye: at + towards * distance,
            ..camera
        }
    }

    /// The ray through the point (`x`, `y`) of a picture of `width` by `height` pixels; (0, 0) is its upper left corner,
    /// so pixel (i, j) has its centre at (i + 0.5, j + 0.5). The direction has unit length.
    #[must_use]
    pub fn ray(&self, x: f32, y: f32, width: u32, height: u32) -> Ray {
        let (right, up, forward) = self.frame();
        // The field of view spans the smaller side, so that what fits a square picture fits every picture.
        let (wide, high) = (width as f32, height as f32);
        let scale = (self.fov_deg.to_radians() * 0.5).tan() / wide.min(high);
        let sx = (2.0 * x - wide) * scale;
        let sy = (high - 2.0 * y) * scale;
        Ray::new(self.eye, (forward + right * sx + up * sy).normalize())
    }

    /// Right, up and forward, each of unit length and perpendicular to the others.
    ///
    /// Defined for every camera: where `up` is parallel to the view or the view has no length, another axis serves.
    #[must_use]
    pub fn frame(&self) -> (Vec3, Vec3, Vec3) {
        let forward = (self.at - self.eye).try_normalize().unwrap_or(Vec3::NEG_Z);
        let right = forward
            .cross(self.up)
            .try_normalize()
            .unwrap_or_else(|| forward.any_orthonormal_vector());
        (right, right.cross(forward), forward)
    }

    /// The camera turned around what it looks at, by angles in radians, and moved to `zoom` times its distance.
    #[must_use]
    pub fn orbited(&self, azimuth: f32, elevation: f32, zoom: f32) -> Self {
        let up = self.up.try_normalize().unwrap_or(Vec3::Y);
        let offset = self.eye - self.at;
        let height = offset.dot(up);
        let flat = offset - up * height;
        let radius = offset.length().max(f32::MIN_POSITIVE);
        let level = flat
            .try_normalize()
            .unwrap_or_else(|| up.any_orthonormal_vector());
        // Kept short of the poles, where the picture would flip over.
        let limit = std::f32::consts::FRAC_PI_2 - 0.02;
        let angle = ((height / radius).clamp(-1.0, 1.0).asin() + elevation).clamp(-limit, limit);
        let turned = level * azimuth.cos() + up.cross(level) * azimuth.sin();
        Self {
            eye: self.at + (turned * angle.cos() + up * angle.sin()) * radius * zoom,
            ..*self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn framing_shows_all_corners_of_a_box_and_wastes_little_room() {
        let boxes = [
            [Vec3::ZERO, Vec3::ONE],
            [Vec3::new(-1.0, 0.0, 5.0), Vec3::new(1.0, 20.0, 6.0)],
            [Vec3::splat(1e5), Vec3::new(1.001e5, 1.002e5, 1e5)],
            [Vec3::ZERO, Vec3::splat(1e-12)],
        ];
        for (corners, up) in boxes.into_iter().flat_map(|b| [(b, Vec3::Y), (b, Vec3::Z)]) {
            let bounds = Aabb::of_points(corners);
            let camera = Camera::framing(bounds, up);
            let (x, y, z) = camera.frame();
            let half = (camera.fov_deg.to_radians() * 0.5).tan();
            let place = |corner: Vec3| {
                let p = corner - camera.eye;
                p.dot(x).abs().max(p.dot(y).abs()) / (p.dot(z) * half)
            };
            let most = bounds.corners().into_iter().map(place).fold(0.0, f32::max);
            assert!((0.9..1.0).contains(&most), "{corners:?}: {most}");
        }
    }

    #[test]
    fn an_empty_box_and_a_point_have_a_camera() {
        for bounds in [Aabb::EMPTY, Aabb::of_points([Vec3::ONE])] {
            let camera = Camera::framing(bounds, Vec3::Y);
            assert!((camera.eye - camera.at).length() > 0.9);
        }
    }
}
