//! Grid resolutions, and lists of them as they are written: `1..256`, `8..64:8`, `8,16,auto`.

use serde::{Deserialize, Serialize};

use crate::accel::MAX_N;

use super::LabError;

/// A grid resolution as asked for; in JSON `"auto"` or a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(from = "Written", into = "Written")]
pub enum NRule {
    /// The predictor chooses.
    Auto,
    /// This one.
    Fixed(u32),
}

/// How [`NRule`] is written in JSON.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Number(u32),
    Word(Word),
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Word {
    Auto,
}

impl From<Written> for NRule {
    fn from(written: Written) -> Self {
        match written {
            Written::Number(n) => Self::Fixed(n),
            Written::Word(Word::Auto) => Self::Auto,
        }
    }
}

impl From<NRule> for Written {
    fn from(rule: NRule) -> Self {
        match rule {
            NRule::Fixed(n) => Self::Number(n),
            NRule::Auto => Self::Word(Word::Auto),
        }
    }
}

/// Reads a list of resolutions: items between commas, each `auto`, a number, `A..B` or `A..B:S`. A resolution that
/// comes twice is kept once.
///
/// `A..B` is a geometric series of about two values an octave, both ends included: 1, 2, 3, 4, 6, 8, 11, 16, … ;
/// `A..B:S` goes from A in steps of S and never beyond B.
///
/// # Errors
/// An empty list or item, a number that is none, 0, beyond [`MAX_N`], a range that goes down, a step of 0.
pub fn parse_n_list(text: &str) -> Result<Vec<NRule>, LabError> {
    let mut list = Vec::new();
    for item in text.split(',').map(str::trim) {
        for rule in item_rules(item).map_err(|why| LabError::Resolution {
            item: item.to_owned(),
            why,
        })? {
            if !list.contains(&rule) {
                list.push(rule);
            }
        }
    }
    Ok(list)
}

fn item_rules(item: &str) -> Result<Vec<NRule>, String> {
    if item == "auto" {
        return Ok(vec![NRule::Auto]);
    }
    let Some((first, rest)) = item.split_once("..") else {
        return Ok(vec![NRule::Fixed(resolution(item)?)]);
    };
    let (last, step) = match rest.split_once(':') {
        Some((last, step)) => (last, Some(resolution(step)?)),
        None => (rest, None),
    };
    let (first, last) = (resolution(first)?, resolution(last)?);
    if first > last {
        return Err(format!("{first} is more than {last}"));
    }
    let values = match step {
        Some(step) => (first..=last).step_by(step as usize).collect(),
        None => geometric(first, last),
    };
    Ok(values.into_iter().map(NRule::Fixed).collect())
}

fn resolution(text: &str) -> Result<u32, String> {
    match text.trim().parse::<u32>() {
        Ok(0) => Err("0 cells are no grid".to_owned()),
        Ok(n) if n <= MAX_N => Ok(n),
        Ok(n) => Err(format!("{n} is more than the largest n, {MAX_N}")),
        Err(_) if text.trim().is_empty() => Err("a number is missing".to_owned()),
        Err(_) => Err(format!(
            "'{}' is not a whole number up to {MAX_N}",
            text.trim()
        )),
    }
}

/// About two values an octave from `first` to `last`, both included, ascending.
fn geometric(first: u32, last: u32) -> Vec<u32> {
    let octaves = (f64::from(last) / f64::from(first)).log2();
    let steps = (2.0 * octaves).round().max(1.0);
    let mut values: Vec<u32> = (0..=steps as u32)
        .map(|k| (f64::from(first) * (octaves * f64::from(k) / steps).exp2()).round() as u32)
        .collect();
    values.dedup();
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(text: &str) -> Vec<u32> {
        parse_n_list(text)
            .unwrap()
            .into_iter()
            .map(|rule| match rule {
                NRule::Fixed(n) => n,
                NRule::Auto => 0,
            })
            .collect()
    }

    #[test]
    fn a_range_is_two_values_an_octave_with_both_ends() {
        assert_eq!(
            list("1..128"),
            [1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64, 91, 128]
        );
        assert_eq!(list("10..100"), [10, 14, 19, 27, 37, 52, 72, 100]);
        assert_eq!(list("5..5"), [5]);
        assert_eq!(list("5..6"), [5, 6]);
    }

    #[test]
    fn a_step_goes_on_until_the_end() {
        assert_eq!(list("8..32:8"), [8, 16, 24, 32]);
        assert_eq!(list("8..31:8"), [8, 16, 24]);
    }

    #[test]
    fn items_join_and_repeats_are_left_out() {
        assert_eq!(list("8, 16,auto,8"), [8, 16, 0]);
        assert_eq!(list("1..4,3,64"), [1, 2, 3, 4, 64]);
    }

    #[test]
    fn what_is_no_resolution_is_named() {
        for (text, part) in [
            ("", "missing"),
            ("8,,9", "missing"),
            ("0", "0 cells"),
            ("1..", "missing"),
            ("1..9999", "9999 is more than the largest n"),
            ("99999999999", "not a whole number"),
            ("-3", "'-3' is not a whole number"),
            ("9..3", "9 is more than 3"),
            ("1..8:0", "0 cells"),
            ("gird", "'gird'"),
        ] {
            let why = parse_n_list(text).unwrap_err().to_string();
            assert!(why.contains(part), "{text}: {why}");
        }
    }

    #[test]
    fn resolutions_are_numbers_and_a_word_in_json() {
        let list = vec![NRule::Fixed(8), NRule::Auto];
        let text = serde_json::to_string(&list).unwrap();
        assert_eq!(text, r#"[8,"auto"]"#);
        assert_eq!(serde_json::from_str::<Vec<NRule>>(&text).unwrap(), list);
        assert!(serde_json::from_str::<NRule>("\"atuo\"").is_err());
    }
}
