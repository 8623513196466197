//! The judge of the overlap tests: separating axes in `i128`, exact for integer triangles and boxes.

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

use super::Overlap;
use crate::geometry::DVec3;

type Int3 = [i128; 3];

fn minus(a: Int3, b: Int3) -> Int3 {
    std::array::from_fn(|i| a[i] - b[i])
}

fn cross(a: Int3, b: Int3) -> Int3 {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

fn dot(a: Int3, b: Int3) -> i128 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// Whether the closed triangle touches the closed box [`low`, `high`], exactly.
///
/// All axes are tried: the box's, the triangle's normal, the nine products, and, for triangles that are segments,
/// what the products give for them; two convex polytopes are disjoint only if one of these separates them.
pub(super) fn touches(triangle: &[Int3; 3], low: Int3, high: Int3) -> bool {
    let edges: [Int3; 3] = std::array::from_fn(|i| minus(triangle[(i + 1) % 3], triangle[i]));
    let units: [Int3; 3] = std::array::from_fn(|i| std::array::from_fn(|a| i128::from(a == i)));
    let mut axes = units.to_vec();
    axes.push(cross(edges[0], edges[1]));
    axes.extend(edges.iter().flat_map(|&e| units.map(|u| cross(u, e))));
    axes.iter().all(|&axis| {
        let along = triangle.map(|v| dot(v, axis));
        let least: i128 = (0..3)
            .map(|i| axis[i] * if axis[i] > 0 { low[i] } else { high[i] })
            .sum();
        let most: i128 = (0..3)
            .map(|i| axis[i] * if axis[i] > 0 { high[i] } else { low[i] })
            .sum();
        let [a, b, c] = along;
        a.min(b).min(c) <= most && a.max(b).max(c) >= least
    })
}

/// Whether `T` with pad 0 says of the integer case what exact arithmetic says.
fn agrees<T: Overlap>(triangle: &[Int3; 3], low: Int3, high: Int3) -> bool {
    let float = |v: Int3| DVec3::from_array(v.map(|x| x as f64));
    let [l, h] = [float(low), float(high)];
    // What the trait asks of its caller.
    let corners = triangle.map(float);
    let box_touches = corners[0].min(corners[1]).min(corners[2]).cmple(h).all()
        && corners[0].max(corners[1]).max(corners[2]).cmpge(l).all();
    let said = box_touches && T::new(corners).touches((l + h) * 0.5, (h - l) * 0.5);
    said == touches(triangle, low, high)
}

/// A coordinate that lies on a plane of the box [-2, 2] or [0, 0] more often than not.
fn coordinate() -> impl Strategy<Value = i128> {
    prop_oneof![Just(-2), Just(2), Just(0), -3..=3_i128, -12..=12_i128]
}

fn corner() -> impl Strategy<Value = Int3> {
    [coordinate(), coordinate(), coordinate()]
}

/// Compares `T` with the judge on 60,000 small-integer cases: triangles on faces, edges and corners of cells, flat
/// cells, planes through a diagonal, slivers, segments and points among them.
pub(super) fn compare<T: Overlap>() {
    let config = Config {
        cases: 60_000,
        failure_persistence: None,
        ..Config::default()
    };
    let flat = prop_oneof![4 => Just([2_i128; 3]), 1 => Just([2, 2, 0]), 1 => Just([0, 2, 0]), 1 => Just([1, 2, 5])];
    let case = ([corner(), corner(), corner()], flat);
    TestRunner::new(config)
        .run(&case, |(triangle, half)| {
            prop_assert!(agrees::<T>(&triangle, half.map(|x| -x), half));
            Ok(())
        })
        .unwrap();
}

#[test]
fn the_judge_knows_touching_from_apart() {
    let cell = ([-2; 3], [2; 3]);
    let at = |x: i128| [[x, -9, -9], [x, 9, -9], [x, 0, 9]];
    assert!(touches(&at(2), cell.0, cell.1));
    assert!(!touches(&at(3), cell.0, cell.1));
    // A corner is touched by the plane x + y + z = 6, and missed by the next.
    let corner = |s: i128| [[3 * s, -s, -s], [-s, 3 * s, -s], [-s, -s, 3 * s]];
    assert!(touches(&corner(6), cell.0, cell.1));
    assert!(!touches(&corner(7), cell.0, cell.1));
}
