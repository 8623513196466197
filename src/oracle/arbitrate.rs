//! The rule that an accelerator never changes a right answer, as code.
//!
//! Brute force is right where its triangle is in the oracle's tie set, or where both miss. There every accelerator with
//! the same kernel must give the same triangle and the same `t`, bit for bit. Where brute force is wrong, the kernel
//! erred, and the answers may differ.

use crate::geometry::{Hit, Ray};

use super::Oracle;

/// What became of one ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Same triangle and same `t`, bit for bit; or both miss.
    Same,
    /// They differ, and brute force is wrong: the kernel errs on this ray.
    KernelError,
    /// They differ, and brute force is right: the accelerator is broken.
    Broken,
}

impl Verdict {
    fn of_different(brute_is_right: bool) -> Self {
        if brute_is_right {
            Self::Broken
        } else {
            Self::KernelError
        }
    }
}

/// Judges `other`'s nearest hit against brute force with the same kernel. The oracle is asked only where they differ.
#[must_use]
pub fn arbitrate(oracle: &Oracle, ray: &Ray, brute: &Hit, other: &Hit) -> Verdict {
    if brute.same_answer(other) {
        Verdict::Same
    } else {
        Verdict::of_different(oracle.truth(ray).allows(brute))
    }
}

/// Judges `other`'s answer whether `ray` is blocked against brute force with the same kernel.
///
/// Brute force is right where the oracle agrees; that it may agree through a phantom, while the kernel leaks the
/// triangle that is really hit, is not looked at.
#[must_use]
pub fn arbitrate_occluded(oracle: &Oracle, ray: &Ray, brute: bool, other: bool) -> Verdict {
    if brute == other {
        Verdict::Same
    } else {
        Verdict::of_different(oracle.occluded(ray) == brute)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::Vec3;
    use crate::scene::Mesh;

    /// Two triangles that share an edge at x = 0, and the ray through a point of the plane z = 0.
    fn setting(x: f32) -> (Oracle, Ray) {
        let vertices = vec![-Vec3::X, Vec3::X, Vec3::Y, -Vec3::Y];
        let mesh = Mesh::new(vertices, vec![[0, 2, 3], [1, 2, 3]]).unwrap();
        let ray = Ray::new(Vec3::new(x, 0.0, -1.0), Vec3::Z);
        (Oracle::new(&Arc::new(mesh)), ray)
    }

    fn hit(prim: u32) -> Hit {
        Hit {
            t: 1.0,
            prim,
            ..Hit::MISS
        }
    }

    #[test]
    fn equal_answers_are_the_same_even_if_wrong() {
        let (oracle, ray) = setting(0.5);
        assert_eq!(arbitrate(&oracle, &ray, &hit(0), &hit(0)), Verdict::Same);
        assert_eq!(
            arbitrate(&oracle, &ray, &Hit::MISS, &Hit::MISS),
            Verdict::Same
        );
    }

    #[test]
    fn another_answer_than_the_right_one_is_broken() {
        let (oracle, ray) = setting(0.5);
        let verdict = |other| arbitrate(&oracle, &ray, &hit(1), &other);
        assert_eq!(verdict(Hit::MISS), Verdict::Broken);
        assert_eq!(verdict(hit(0)), Verdict::Broken);
        let off_by_one_bit = Hit {
            t: 1.0f32.next_up(),
            ..hit(1)
        };
        assert_eq!(verdict(off_by_one_bit), Verdict::Broken);
    }

    #[test]
    fn another_answer_than_a_wrong_one_is_a_kernel_error() {
        let (oracle, ray) = setting(0.5);
        assert_eq!(
            arbitrate(&oracle, &ray, &hit(0), &hit(1)),
            Verdict::KernelError
        );
        assert_eq!(
            arbitrate(&oracle, &ray, &Hit::MISS, &hit(1)),
            Verdict::KernelError
        );
    }

    #[test]
    fn each_member_of_the_tie_set_is_right() {
        let (oracle, ray) = setting(0.0);
        assert_eq!(oracle.truth(&ray).tie_set, [0, 1]);
        assert_eq!(arbitrate(&oracle, &ray, &hit(1), &hit(0)), Verdict::Broken);
        assert_eq!(arbitrate(&oracle, &ray, &hit(0), &hit(1)), Verdict::Broken);
    }

    #[test]
    fn a_wrong_answer_to_whether_a_ray_is_blocked_is_broken_only_where_brute_force_is_right() {
        let (oracle, blocked) = setting(0.5);
        let (_, free) = setting(5.0);
        let verdict = |ray, brute, other| arbitrate_occluded(&oracle, ray, brute, other);
        assert_eq!(verdict(&blocked, true, true), Verdict::Same);
        assert_eq!(verdict(&blocked, true, false), Verdict::Broken);
        assert_eq!(verdict(&blocked, false, true), Verdict::KernelError);
        assert_eq!(verdict(&free, true, false), Verdict::KernelError);
        assert_eq!(verdict(&free, false, true), Verdict::Broken);
    }
}
