//! A plane through a ray, and what it cuts: the ray lies level in it, and its `t` grows to the right.
//!
//! ```text
//!   across                 ,----- a triangle's cut
//!      |      +------+    /
//!      |      |   +--+---/+      boxes of visited places
//!   ray --[---+---+--+--●-+------------> along, t
//!      |      |   +--+-/--+
//!      |      +------+
//! ```
//!
//! A plane holds the ray and one axis of the scene, made perpendicular to it. All coordinates are `f64` relative to the
//! ray's origin, so that a cut far from the scene's origin is as sharp as one near it.

use crate::geometry::{DVec2, DVec3, Ray, Vec3};

/// A straight cut: two points, x along the ray and y across it, in units of length from the ray's origin.
pub type Segment = [DVec2; 2];

/// The axis that a plane holds beside the ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plane {
    /// The scene's x axis.
    X,
    /// The scene's y axis.
    Y,
    /// The scene's z axis.
    Z,
}

impl Plane {
    /// All axes.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Its letter.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        }
    }

    /// Its place in [`Plane::ALL`].
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }

    /// The planes of a ray, the one whose axis is most across it first; an axis along the ray spans none and is left out.
    #[must_use]
    pub fn across(ray: &Ray) -> Vec<Self> {
        let dir = ray.dir.as_dvec3().to_array().map(f64::abs);
        let mut planes = Self::ALL.to_vec();
        planes.sort_by(|a, b| dir[a.index()].total_cmp(&dir[b.index()]));
        planes.retain(|plane| Frame::new(ray, *plane).is_some());
        planes
    }
}

/// The coordinates of a plane through a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    origin: DVec3,
    along: DVec3,
    across: DVec3,
    normal: DVec3,
    /// Length of the ray's direction: what a `t` of 1 is long.
    pub unit: f64,
}

/// The sine below which an axis counts as along the ray: the plane would be made of rounding errors.
const LEAST_SINE: f64 = 1e-6;

impl Frame {
    /// The plane that holds a valid ray and the axis; `None` where the axis lies along the ray.
    #[must_use]
    pub fn new(ray: &Ray, plane: Plane) -> Option<Self> {
        let dir = ray.dir.as_dvec3();
        // Scaled first: the square of a tiny direction would vanish.
        let largest = dir.abs().max_element();
        let along = (dir / largest).normalize();
        let axis = DVec3::AXES[plane.index()];
        let across = axis - along * axis.dot(along);
        let sine = across.length();
        (sine > LEAST_SINE).then(|| {
            let across = across / sine;
            Self {
                origin: ray.origin.as_dvec3(),
                along,
                across,
                normal: along.cross(across),
                unit: (dir / largest).length() * largest,
            }
        })
    }

    /// A point in the plane's coordinates, and its distance from the plane.
    fn place(&self, point: Vec3) -> (DVec2, f64) {
        let p = point.as_dvec3() - self.origin;
        let flat = DVec2::new(p.dot(self.along), p.dot(self.across));
        (flat, p.dot(self.normal))
    }

    /// How far along the ray a point is.
    #[must_use]
    pub fn along(&self, point: Vec3) -> f64 {
        self.place(point).0.x
    }

    /// Where the plane cuts a triangle: nothing, a segment, or the three edges of one that lies in the plane.
    #[must_use]
    pub fn cut(&self, corners: &[Vec3; 3]) -> Vec<Segment> {
        let placed = corners.map(|corner| self.place(corner));
        let edges = [(0, 1), (1, 2), (2, 0)];
        if placed.iter().all(|(_, height)| *height == 0.0) {
            return edges.map(|(a, b)| [placed[a].0, placed[b].0]).to_vec();
        }
        let crossings = edges
            .iter()
            .filter_map(|&(a, b)| crossing(placed[a], placed[b]));
        let ends = crossings.fold(Vec::new(), |mut ends: Vec<DVec2>, point| {
            if !ends.contains(&point) {
                ends.push(point);
            }
            ends
        });
        match ends.as_slice() {
            [] => Vec::new(),
            [only] => vec![[*only, *only]],
            [a, b, ..] => vec![[*a, *b]],
        }
    }

    /// Where the plane cuts a box: the corners of a convex polygon in their order around it; fewer than three where it
    /// only touches.
    #[must_use]
    pub fn cut_box(&self, [min, max]: [[f32; 3]; 2]) -> Vec<DVec2> {
        let corner = |i: usize| {
            let pick = |axis: usize| if i >> axis & 1 == 1 { max } else { min }[axis];
            self.place(Vec3::new(pick(0), pick(1), pick(2)))
        };
        let corners: [_; 8] = std::array::from_fn(corner);
        let mut points: Vec<DVec2> = Vec::new();
        for i in 0..8 {
            for axis in (0..3).filter(|axis| i >> axis & 1 == 0) {
                points.extend(crossing(corners[i], corners[i | 1 << axis]));
            }
        }
        let middle = points.iter().copied().sum::<DVec2>() / points.len().max(1) as f64;
        let angle = |p: &DVec2| (p.y - middle.y).atan2(p.x - middle.x);
        points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        points.dedup();
        points
    }
}

/// Where an edge from one side of the plane to the other, or to the plane itself, passes it.
fn crossing((a, up): (DVec2, f64), (b, down): (DVec2, f64)) -> Option<DVec2> {
    if up == 0.0 {
        return Some(a);
    }
    if down == 0.0 {
        return Some(b);
    }
    // Tiny heights multiply to zero; their signs do not.
    (up.is_sign_negative() != down.is_sign_negative()).then(|| a + (b - a) * (up / (up - down)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(dir: Vec3) -> Ray {
        Ray::new(Vec3::new(-1.0, 0.5, 0.25), dir)
    }

    #[test]
    fn the_axis_most_across_comes_first_and_one_along_the_ray_never() {
        let level = Plane::across(&ray(Vec3::new(1.0, 0.2, 0.0)));
        assert_eq!(level, [Plane::Z, Plane::Y, Plane::X]);
        assert_eq!(Plane::across(&ray(Vec3::X)), [Plane::Y, Plane::Z]);
    }

    #[test]
    fn lengths_along_the_ray_are_t_times_the_length_of_its_direction() {
        for scale in [1e-37, 1.0, 1e37] {
            let ray = ray(Vec3::new(0.0, 3.0, 4.0) * scale);
            let frame = Frame::new(&ray, Plane::X).unwrap();
            assert!((frame.unit / (5.0 * f64::from(scale)) - 1.0).abs() < 1e-6);
            assert_eq!(frame.along(ray.origin), 0.0);
        }
    }

    #[test]
    fn a_triangle_across_the_plane_is_cut_where_the_ray_meets_it() {
        let corners = [
            Vec3::new(2.0, -3.0, -3.0),
            Vec3::new(2.0, 3.0, -3.0),
            Vec3::new(2.0, 0.0, 5.0),
        ];
        let frame = Frame::new(&ray(Vec3::X), Plane::Y).unwrap();
        let cut = frame.cut(&corners);
        let [[a, b]] = cut.as_slice() else {
            panic!("{cut:?}");
        };
        assert_eq!((a.x, b.x), (3.0, 3.0));
        assert!(a.y.min(b.y) < 0.0 && a.y.max(b.y) > 0.0);
        let beside = corners.map(|c| c + Vec3::Z * 10.0);
        assert!(frame.cut(&beside).is_empty());
    }

    #[test]
    fn a_triangle_in_the_plane_is_drawn_by_its_edges() {
        let frame = Frame::new(&Ray::new(Vec3::ZERO, Vec3::X), Plane::Y).unwrap();
        assert_eq!(frame.cut(&[Vec3::ZERO, Vec3::X, Vec3::Y]).len(), 3);
    }

    #[test]
    fn a_box_is_cut_in_a_polygon_that_the_ray_passes_from_entry_to_exit() {
        let frame = Frame::new(&ray(Vec3::X), Plane::Z).unwrap();
        let cut = frame.cut_box([[0.0; 3], [1.0; 3]]);
        assert_eq!(cut.len(), 4);
        let xs: Vec<f64> = cut.iter().map(|p| p.x).collect();
        assert_eq!(xs.iter().copied().fold(f64::INFINITY, f64::min), 1.0);
        assert_eq!(xs.iter().copied().fold(f64::NEG_INFINITY, f64::max), 2.0);
        assert!(frame.cut_box([[0.0, 3.0, 0.0], [1.0, 4.0, 1.0]]).is_empty());
        let slanted = Frame::new(&ray(Vec3::new(1.0, 0.7, 0.4)), Plane::Y).unwrap();
        assert!((3..=6).contains(&slanted.cut_box([[-1.0, 0.0, 0.0], [1.0; 3]]).len()));
    }

    #[test]
    fn a_box_without_thickness_gives_no_number_that_is_none() {
        let frame = Frame::new(&ray(Vec3::X), Plane::Y).unwrap();
        for p in frame.cut_box([[0.0, 0.0, 0.25], [1.0, 1.0, 0.25]]) {
            assert!(p.is_finite());
        }
    }
}
