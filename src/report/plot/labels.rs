//! Places labels in a column beside the ends of their lines, apart from each other and as near as they can be.
//!
//! ```text
//!   ends of lines      labels
//!       ----.
//!            `------- grid
//!       ------------- bvh
//!       ----.
//!            `------- kd-tree
//! ```
//!
//! Least squares under a fixed order: labels in the order of their wishes, at least one pitch apart. With the pitch
//! taken off, that is isotonic regression, which pooling adjacent violators solves exactly.

/// The places of labels that would like to be at `wishes`, at least `pitch` apart and within `top..=bottom` as far as
/// the column is long enough. Equal wishes keep their order. No wish is NaN.
pub(super) fn spread(wishes: &[f64], pitch: f64, top: f64, bottom: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wishes.len()).collect();
    order.sort_by(|&a, &b| wishes[a].total_cmp(&wishes[b]));
    // Pools of neighbours that touch: sum of reduced wishes, and how many.
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (rank, &i) in order.iter().enumerate() {
        let mut pool = (wishes[i] - rank as f64 * pitch, 1);
        while let Some(&(sum, count)) = pools.last() {
            if sum / count as f64 <= pool.0 / pool.1 as f64 {
                break;
            }
            pools.pop();
            pool = (sum + pool.0, count + pool.1);
        }
        pools.push(pool);
    }
    // Clamping an isotonic solution to bounds gives the solution within them.
    let last = bottom - pitch * wishes.len().saturating_sub(1) as f64;
    let reduced = pools
        .iter()
        .flat_map(|&(sum, count)| std::iter::repeat_n(sum / count as f64, count));
    let mut places = vec![0.0; wishes.len()];
    for ((rank, &i), y) in order.iter().enumerate().zip(reduced) {
        places[i] = y.min(last).max(top) + rank as f64 * pitch;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_with_room_stay_where_they_wish() {
        assert_eq!(spread(&[50.0, 10.0], 14.0, 0.0, 100.0), [50.0, 10.0]);
    }

    #[test]
    fn labels_that_would_touch_move_apart_equally() {
        assert_eq!(spread(&[50.0, 50.0], 14.0, 0.0, 100.0), [43.0, 57.0]);
    }

    #[test]
    fn a_column_of_many_is_never_closer_than_the_pitch_nor_outside() {
        let wishes: Vec<f64> = (0..20).map(|i| 150.0 + (i * 37 % 11) as f64).collect();
        let mut places = spread(&wishes, 14.0, 0.0, 300.0);
        places.sort_by(f64::total_cmp);
        assert!(places[0] >= 0.0 && places[19] <= 300.0);
        assert!(places.windows(2).all(|w| w[1] - w[0] >= 14.0 - 1e-9));
    }

    #[test]
    fn order_follows_the_wishes() {
        let places = spread(&[30.0, 31.0, 29.0], 14.0, 0.0, 100.0);
        assert!(places[2] < places[0] && places[0] < places[1]);
    }
}
