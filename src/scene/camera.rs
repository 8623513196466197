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
    /// Vertical field of view in degrees.
    pub fov_deg: f32,
}

impl Camera {
    /// A view of all of `bounds` from the front, a little from the right and above.
    #[must_use]
    pub fn framing(bounds: Aabb, up: Vec3) -> Self {
        let fov_deg: f32 = 38.0;
        let (centre, radius) = if bounds.is_empty() {
            (Vec3::ZERO, 1.0)
        } else {
            (
                bounds.centre(),
                (bounds.extent().length() * 0.5).max(f32::MIN_POSITIVE),
            )
        };
        // For y up: from +z; for z up: from -y.
        let front = if up.z.abs() > up.y.abs() {
            Vec3::NEG_Y
        } else {
            Vec3::Z
        };
        let right = front.cross(up).normalize_or_zero() * -1.0;
        let towards = (front + right * 0.55 + up * 0.45).normalize();
        // The sphere around the box touches the sides of the picture.
        let distance = radius / (fov_deg.to_radians() * 0.5).sin();
        Self {
            eye: centre + towards * distance,
            at: centre,
            up,
            fov_deg,
        }
    }

    /// The ray through the point (`x`, `y`) of a picture of `width` by `height` pixels; (0, 0) is its upper left corner,
    /// so pixel (i, j) has its centre at (i + 0.5, j + 0.5). The direction has unit length.
    #[must_use]
    pub fn ray(&self, x: f32, y: f32, width: u32, height: u32) -> Ray {
        let (right, up, forward) = self.frame();
        let half = (self.fov_deg.to_radians() * 0.5).tan();
        let aspect = width as f32 / height as f32;
        let sx = (2.0 * x / width as f32 - 1.0) * half * aspect;
        let sy = (1.0 - 2.0 * y / height as f32) * half;
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
