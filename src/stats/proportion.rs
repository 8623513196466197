//! How large a rate can be of which a few cases, or none, were seen.
//!
//! **Source:** C. Clopper and E. Pearson, "The Use of Confidence or Fiducial Limits Illustrated in the Case of the
//! Binomial", 1934; the binomial's tail as an incomplete beta function by its continued fraction (W. Press et al.,
//! "Numerical Recipes", 3rd ed., §6.4).

/// The upper 95 % bound of the rate of which `seen` of `rays` were seen (Clopper and Pearson, one-sided): the rate at
/// which that few or fewer would be seen in 5 % of all experiments. 1 where there were no rays.
///
/// For none seen it is 1 − 0.05^(1/rays), which is at most 3 / rays: the rule of three.
#[must_use]
pub fn upper95(seen: u64, rays: u64) -> f64 {
    if rays == 0 || seen >= rays {
        return 1.0;
    }
    if seen == 0 {
        return -(0.05_f64.ln() / rays as f64).exp_m1();
    }
    let (k, n) = (seen as f64, rays as f64);
    let (mut lo, mut hi) = (k / n, 1.0);
    // Each step halves the interval; 1e-12 of itself is far below what three digits show.
    while hi - lo > 1e-12 * hi {
        let p = f64::midpoint(lo, hi);
        if p <= lo || p >= hi {
            break;
        }
        // P(X <= k) falls as p rises.
        if incomplete_beta(n - k, k + 1.0, 1.0 - p) > 0.05 {
            lo = p;
        } else {
            hi = p;
        }
    }
    hi
}

/// The regularised incomplete beta function `I_x(a, b)` for 0 < x < 1 and positive a, b.
fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    let front = ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (-x).ln_1p();
    // The fraction converges fast on this side of the mean; the other side is its mirror image.
    if x < (a + 1.0) / (a + b + 2.0) {
        front.exp() * continued_fraction(a, b, x) / a
    } else {
        1.0 - front.exp() * continued_fraction(b, a, 1.0 - x) / b
    }
}

/// Lentz's evaluation of the fraction; about √max(a, b) steps.
fn continued_fraction(a: f64, b: f64, x: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let away_from_zero = |v: f64| if v.abs() < TINY { TINY } else { v };
    let mut c = 1.0;
    let mut d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut h = d;
    for m in 1..100_000 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut change = 1.0;
        for term in [even, odd] {
            d = 1.0 / away_from_zero(1.0 + term * d);
            c = away_from_zero(1.0 + term / c);
            change = c * d;
            h *= change;
        }
        if (change - 1.0_f64).abs() < 1e-14 {
            break;
        }
    }
    h
}

/// ln Γ(x) for x >= 1, by Stirling's series after a shift to x >= 10.
fn ln_gamma(x: f64) -> f64 {
    let (mut x, mut shift) = (x, 0.0);
    while x < 10.0 {
        shift -= x.ln();
        x += 1.0;
    }
    let r = 1.0 / (x * x);
    let series = (1.0 / 12.0 - r * (1.0 / 360.0 - r * (1.0 / 1260.0 - r / 1680.0))) / x;
    shift + (x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_those_of_the_published_tables() {
        // One-sided 95 % limits of the binomial, e.g. qbeta(0.95, k + 1, n - k) in R.
        for (seen, rays, expected) in [
            (0, 10, 0.258_866),
            (1, 10, 0.394_163),
            (5, 10, 0.777_559),
            (9, 10, 0.994_884),
            (2, 100, 0.061_620),
        ] {
            let bound = upper95(seen, rays);
            assert!((bound - expected).abs() < 2e-5, "{seen} of {rays}: {bound}");
        }
    }

    #[test]
    fn none_seen_is_the_rule_of_three_and_no_rays_say_nothing() {
        let bound = upper95(0, 1_000_000);
        assert!(bound < 3e-6 && bound > 2.99e-6, "{bound}");
        assert_eq!(upper95(0, 0), 1.0);
        assert_eq!(upper95(7, 7), 1.0);
    }

    #[test]
    fn many_rays_give_a_bound_that_is_the_normal_one() {
        let (seen, rays) = (200_000, 10_000_000);
        let rate = 0.02;
        let normal = rate + 1.645 * (rate * (1.0 - rate) / rays as f64).sqrt();
        assert!((upper95(seen, rays) / normal - 1.0).abs() < 1e-4);
    }
}
