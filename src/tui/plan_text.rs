//! Lines of the plan as texts: how lists, counts, threads and samples are written and read.

use crate::lab::{self, MAX_THREADS, NRule};
use crate::trace::MAX_RAYS;

/// Most samples of a run; beyond it the interval no longer shrinks by anything that matters.
pub const MAX_SAMPLES: usize = 100_000;

/// Splits a list at its commas. A number after a spec with sizes is one more of them: `soup:1000,0.5, teapot`
/// are two specs.
#[must_use]
pub fn split_specs(text: &str) -> Vec<String> {
    let mut specs: Vec<String> = Vec::new();
    for part in text.split(',').map(str::trim).filter(|p| !p.is_empty()) {
        match specs.last_mut() {
            Some(last) if takes_more(last) && part.parse::<f64>().is_ok() => {
                last.push(',');
                last.push_str(part);
            }
            _ => specs.push(part.to_owned()),
        }
    }
    specs
}

/// Whether a number after `spec` belongs to it: sizes follow a `:`, parameters have names.
fn takes_more(spec: &str) -> bool {
    spec.contains(':') && !spec.contains('=')
}

/// The shortest text that stands for `n`: a range where the geometric series gives just these values.
#[must_use]
pub fn n_text(n: &[NRule]) -> String {
    let fixed: Vec<u32> = n
        .iter()
        .filter_map(|rule| match rule {
            NRule::Fixed(n) => Some(*n),
            NRule::Auto => None,
        })
        .collect();
    let auto = if fixed.len() < n.len() { ", auto" } else { "" };
    if let (Some(first), Some(last)) = (fixed.first(), fixed.last()) {
        let range = format!("{first}..{last}{auto}");
        if fixed.len() > 1 && lab::parse_n_list(&range).is_ok_and(|list| list == n) {
            return range;
        }
    }
    let words: Vec<String> = n
        .iter()
        .map(|rule| match rule {
            NRule::Fixed(n) => n.to_string(),
            NRule::Auto => "auto".to_owned(),
        })
        .collect();
    words.join(", ")
}

/// 65536 as `64k`, where that is exact.
#[must_use]
pub fn count_text(count: usize) -> String {
    if count > 0 && count.is_multiple_of(1024) {
        format!("{}k", count / 1024)
    } else {
        count.to_string()
    }
}

/// Reads `65536`, `64k` (1024 each) or `1M` (1024² each).
///
/// # Errors
/// No number, 0, or more rays than a set may have; a sentence.
pub fn count(text: &str) -> Result<usize, String> {
    let (digits, unit) = match text.strip_suffix(['k', 'K']) {
        Some(digits) => (digits, 1024),
        None => match text.strip_suffix(['m', 'M']) {
            Some(digits) => (digits, 1024 * 1024),
            None => (text, 1),
        },
    };
    digits
        .trim()
        .parse::<usize>()
        .ok()
        .and_then(|x| x.checked_mul(unit))
        .filter(|x| (1..=MAX_RAYS).contains(x))
        .ok_or_else(|| format!("'{text}' is no number of rays; write 1 to {MAX_RAYS}, e.g. 64k"))
}

/// Reads `1, 2, max`; a count that is named twice comes once.
///
/// # Errors
/// A word that is no number of threads; a sentence.
pub fn threads(text: &str) -> Result<Vec<usize>, String> {
    let max = lab::cores();
    let mut list = Vec::new();
    for word in text.split(',').map(str::trim) {
        let threads = match word {
            "max" => Some(max),
            _ => word.parse().ok(),
        };
        match threads.filter(|x| (1..=MAX_THREADS).contains(x)) {
            Some(x) if list.contains(&x) => {}
            Some(x) => list.push(x),
            None => {
                return Err(format!(
                    "'{word}' is no number of threads; write 1 to {MAX_THREADS}, or max (here {max})"
                ));
            }
        }
    }
    Ok(list)
}

/// Reads `5..30` as fewest and most, or `10` for exactly ten.
///
/// # Errors
/// No numbers, 0, a range that goes down, or too many; a sentence.
pub fn samples(text: &str) -> Result<(usize, usize), String> {
    let (min, max) = text.split_once("..").unwrap_or((text, text));
    match (min.trim().parse::<usize>(), max.trim().parse::<usize>()) {
        (Ok(min), Ok(max)) if (1..=max).contains(&min) && max <= MAX_SAMPLES => Ok((min, max)),
        _ => Err(format!(
            "'{text}' is no number of samples; write fewest..most, e.g. 5..30, up to {MAX_SAMPLES}"
        )),
    }
}

/// Reads `0, 1e4`; a number that is named twice comes once.
///
/// # Errors
/// A word that is no finite number, or less than `least`; a sentence.
pub fn numbers(text: &str, least: f64) -> Result<Vec<f64>, String> {
    let mut list = Vec::new();
    for word in text.split(',').map(str::trim) {
        let number = word.parse::<f64>().ok();
        match number.filter(|x| x.is_finite() && *x >= least) {
            Some(x) if list.contains(&x) => {}
            Some(x) => list.push(x),
            None => {
                let bound = if least > 0.0 { "above 0" } else { "from 0 on" };
                return Err(format!("'{word}' is no number {bound}; write e.g. 1e4"));
            }
        }
    }
    Ok(list)
}

/// Numbers as [`numbers`] reads them: `0, 1e4`.
#[must_use]
pub fn numbers_text(list: &[f64]) -> String {
    let text = list.iter().map(|&x| {
        if x == 0.0 || (1e-2..1e4).contains(&x) {
            format!("{x}")
        } else {
            format!("{x:e}")
        }
    });
    text.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_stay_with_their_scene() {
        assert_eq!(
            split_specs("soup:1000,0.5, teapot ,,plane:8"),
            ["soup:1000,0.5", "teapot", "plane:8"]
        );
        assert_eq!(split_specs("grid:overlap=sat, 5").len(), 2);
    }
}
