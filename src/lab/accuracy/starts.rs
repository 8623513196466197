//! Rules that place the start of a secondary ray: which of them keep it off the triangle that it leaves.
//!
//! ```text
//!          dir /
//!    n ^      /         naive: o + t·d, wherever rounding put it, above the plane or below
//!      |     ●          the others: some way along n, or some way along dir
//!   ═══╪════x═════
//! ```

use serde::{Deserialize, Serialize};

use crate::geometry::{Hit, Ray, SurfacePoint, Vec3};

/// A rule that places the start of a secondary ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StartRule {
    /// The point o + t·d as it was rounded.
    Naive,
    /// The same point, moved by 1e-4 along the normal: a length without regard to the scene's.
    Normal,
    /// The same point, and hits before t = 1e-4 do not count.
    TMin,
    /// The point of the barycentric weights, moved along the normal by steps of the last place (C. Wächter and
    /// N. Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems ch. 6, 2019).
    Integer,
    /// The point of the barycentric weights, moved along the normal by its error bound: [`SurfacePoint`].
    ErrorBound,
}

/// What [`StartRule::Normal`] and [`StartRule::TMin`] keep away.
const FIXED: f32 = 1e-4;

impl StartRule {
    /// All rules.
    pub const ALL: [Self; 5] = [
        Self::Naive,
        Self::Normal,
        Self::TMin,
        Self::Integer,
        Self::ErrorBound,
    ];

    /// What a column of a table is called.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Naive => "naive",
            Self::Normal => "n·1e-4",
            Self::TMin => "t_min 1e-4",
            Self::Integer => "integer",
            Self::ErrorBound => "bound",
        }
    }

    /// The ray along the unit vector `dir` from where `ray` met the triangle; `normal` is of unit length and on the
    /// side that `dir` points to.
    pub(super) fn leave(
        self,
        ray: &Ray,
        hit: &Hit,
        corners: &[Vec3; 3],
        normal: Vec3,
        dir: Vec3,
    ) -> Ray {
        let on_surface = SurfacePoint::of(corners, hit.u, hit.v);
        let origin = match self {
            Self::Naive | Self::TMin => ray.at(hit.t),
            Self::Normal => ray.at(hit.t) + normal * FIXED,
            Self::Integer => by_integers(on_surface.position, normal),
            Self::ErrorBound => on_surface.start(normal, dir),
        };
        Ray {
            t_min: if self == Self::TMin { FIXED } else { 0.0 },
            ..Ray::new(origin, dir)
        }
    }
}

/// Wächter and Binder's offset: up to 256 steps of the last place along each axis, and a small length near 0.
fn by_integers(p: Vec3, normal: Vec3) -> Vec3 {
    let moved = |x: f32, n: f32| {
        if x.abs() < 1.0 / 32.0 {
            return x + n / 65_536.0;
        }
        let steps = (256.0 * n) as i32;
        let bits = x.to_bits() as i32;
        f32::from_bits((if x < 0.0 { bits - steps } else { bits + steps }) as u32)
    };
    Vec3::new(
        moved(p.x, normal.x),
        moved(p.y, normal.y),
        moved(p.z, normal.z),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_but_the_naive_rule_start_on_the_side_of_the_normal_or_begin_later() {
        let corners = [Vec3::new(1.0, 1.0, 1.0), Vec3::X, Vec3::Y];
        let ray = Ray::new(Vec3::splat(3.0), Vec3::NEG_ONE);
        let hit = Hit {
            t: 2.5,
            u: 0.25,
            v: 0.25,
            prim: 0,
        };
        let normal = crate::geometry::unit_normal(&corners).unwrap();
        let normal = if normal.z < 0.0 { -normal } else { normal };
        let leave = |rule: StartRule| rule.leave(&ray, &hit, &corners, normal, normal);
        let height = |rule| (leave(rule).origin - corners[0]).dot(normal);
        assert_eq!(leave(StartRule::Naive).origin, Vec3::splat(0.5));
        assert_eq!(leave(StartRule::TMin).t_min, 1e-4);
        assert!((height(StartRule::Normal) - height(StartRule::Naive) - 1e-4).abs() < 1e-6);
        assert!(height(StartRule::Integer) > 0.0 && height(StartRule::ErrorBound) > 0.0);
    }

    #[test]
    fn integer_steps_go_outwards_on_both_sides_of_zero_and_near_it() {
        for x in [7.0, -7.0, 0.01, -0.01, 0.0] {
            let moved = by_integers(Vec3::splat(x), Vec3::X);
            assert!(moved.x > x && moved.y == x, "{x}");
            assert!(by_integers(Vec3::splat(x), Vec3::NEG_X).x < x);
        }
    }
}
