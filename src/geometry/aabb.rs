//! Axis-aligned boxes.

use super::Vec3;

/// A closed axis-aligned box; [`Aabb::EMPTY`] contains nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box that contains nothing: growing it by a point gives that point.
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The smallest box around `points`; [`Aabb::EMPTY`] when there are none.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::grown)
    }

    /// The smallest box around `self` and `point`.
    #[must_use]
    pub fn grown(self, point: Vec3) -> Self {
        Self {
            min: self.min.min(point),
            max: self.max.max(point),
        }
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// What both contain; empty where they are disjoint.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        }
    }

    /// Whether the box contains no point.
    #[must_use]
    pub fn is_empty(self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Edge lengths; zero for the empty box.
    #[must_use]
    pub fn extent(self) -> Vec3 {
        (self.max - self.min).max(Vec3::ZERO)
    }

    /// The middle of the box; meaningless for the empty one.
    #[must_use]
    pub fn centre(self) -> Vec3 {
        // Halved first, so that boxes near the largest finite number do not overflow.
        self.min * 0.5 + self.max * 0.5
    }

    /// Half the surface area: xy + yz + zx. Zero for the empty box.
    #[must_use]
    pub fn half_area(self) -> f32 {
        let e = self.extent();
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// The axis (0, 1, 2) of the longest edge; the first of equals.
    #[must_use]
    pub fn longest_axis(self) -> usize {
        let e = self.extent().to_array();
        (1..3).fold(0, |best, a| if e[a] > e[best] { a } else { best })
    }

    /// The largest absolute coordinate: the scale of rounding errors inside the box.
    #[must_use]
    pub fn max_abs(self) -> f32 {
        self.min.abs().max(self.max.abs()).max_element()
    }

    /// The eight corners, x fastest.
    #[must_use]
    pub fn corners(self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, lo: f32, hi: f32| if i >> bit & 1 == 0 { lo } else { hi };
            Vec3::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_of_no_points_is_empty_and_has_no_area() {
        let none = Aabb::of_points([]);
        assert!(none.is_empty());
        assert_eq!(none.half_area(), 0.0);
        assert_eq!(none.extent(), Vec3::ZERO);
    }

    #[test]
    fn a_box_of_one_point_is_not_empty() {
        let one = Aabb::of_points([Vec3::ONE]);
        assert!(!one.is_empty());
        assert_eq!(one.centre(), Vec3::ONE);
    }

    #[test]
    fn disjoint_boxes_intersect_in_the_empty_box() {
        let a = Aabb::of_points([Vec3::ZERO, Vec3::ONE]);
        let b = Aabb::of_points([Vec3::splat(2.0), Vec3::splat(3.0)]);
        assert!(a.intersection(b).is_empty());
        assert_eq!(a.union(b).extent(), Vec3::splat(3.0));
    }
}
