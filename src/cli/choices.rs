//! Lists and choices as written on the command line.

use std::collections::BTreeSet;

use crate::accel;
use crate::kernel;
use crate::lab;
use crate::registry::{Choice, ChoiceError, ParamSpec};

use super::Failure;

/// Splits comma-separated lists, each possibly given several times.
///
/// A part that begins like a number belongs to the item before it where that one has a size, since sizes have commas of
/// their own: `soup:1000,0.5,teapot` is `soup:1000,0.5` and `teapot`.
pub fn split_list(texts: &[String]) -> Vec<String> {
    let mut items: Vec<String> = Vec::new();
    for text in texts {
        let first_of_text = items.len();
        for part in text.split(',').map(str::trim).filter(|p| !p.is_empty()) {
            let numeric = part.starts_with(|c: char| c.is_ascii_digit() || c == '.');
            match items[first_of_text..].last_mut() {
                Some(sized) if numeric && takes_more(sized) => {
                    sized.push(',');
                    sized.push_str(part);
                }
                _ => items.push(part.to_owned()),
            }
        }
    }
    items
}

/// Whether an item's size may go on after a comma.
fn takes_more(item: &str) -> bool {
    item.contains(':') && !item.contains('=')
}

/// Reads `1,2,max`; `max` is the number of cores, duplicates go.
pub fn thread_counts(text: &str) -> Result<Vec<usize>, Failure> {
    let counts: BTreeSet<usize> = text
        .split(',')
        .map(|t| thread_count(t.trim()))
        .collect::<Result<_, _>>()?;
    Ok(counts.into_iter().collect())
}

/// Reads a number from 1 to 1024, or `max` for the number of cores.
pub fn thread_count(text: &str) -> Result<usize, Failure> {
    if text == "max" {
        return Ok(lab::cores());
    }
    text.parse()
        .ok()
        .filter(|n| (1..=1024).contains(n))
        .ok_or_else(|| {
            Failure::Usage(format!(
                "'{text}' is not a thread count; write 1 to 1024, or max"
            ))
        })
}

/// Reads accelerators and kernels, then multiplies them by the axes of `--set`.
///
/// An axis applies to every accelerator and kernel that has the parameter; one that nobody has is an error.
pub fn with_axes(
    accels: &[String],
    kernels: &[String],
    axes: &[String],
) -> Result<(Vec<Choice>, Vec<Choice>), Failure> {
    let mut accels: Vec<Choice> = accels
        .iter()
        .map(|a| accel::parse(a))
        .collect::<Result<_, _>>()?;
    let mut kernels: Vec<Choice> = kernels
        .iter()
        .map(|k| kernel::parse(k))
        .collect::<Result<_, _>>()?;
    for axis in axes {
        let (key, values) = axis
            .split_once('=')
            .ok_or_else(|| ChoiceError::NotKeyValue(axis.clone()))?;
        let values: Vec<&str> = values.split(',').map(str::trim).collect();
        let used_by_accels = multiply(&mut accels, accel_params, key, &values)?;
        let used_by_kernels = multiply(&mut kernels, kernel_params, key, &values)?;
        if !used_by_accels && !used_by_kernels {
            return Err(Failure::Usage(format!(
                "none of the chosen accelerators and kernels has a parameter '{key}'; see `raylab list accels`"
            )));
        }
    }
    Ok((accels, kernels))
}

fn accel_params(choice: &Choice) -> &'static [ParamSpec] {
    accel::entry(&choice.name).map_or(&[], |e| e.params)
}

fn kernel_params(choice: &Choice) -> &'static [ParamSpec] {
    kernel::entry(choice).map_or(&[], |e| e.params)
}

/// Replaces each choice that has parameter `key` by one choice a value; says whether any had it.
fn multiply(
    choices: &mut Vec<Choice>,
    params: fn(&Choice) -> &'static [ParamSpec],
    key: &str,
    values: &[&str],
) -> Result<bool, ChoiceError> {
    let mut used = false;
    let mut product = Vec::with_capacity(choices.len());
    for choice in choices.drain(..) {
        let specs = params(&choice);
        if specs.iter().all(|s| s.name != key) {
            product.push(choice);
            continue;
        }
        used = true;
        for value in values {
            let mut varied = choice.clone();
            varied.params.set(specs, key, value)?;
            product.push(varied);
        }
    }
    product.dedup();
    *choices = product;
    Ok(used)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(text: &str) -> Vec<String> {
        split_list(&[text.to_owned()])
    }

    #[test]
    fn a_number_after_a_comma_belongs_to_the_size_before_it() {
        assert_eq!(split("soup:1000,0.5,teapot"), ["soup:1000,0.5", "teapot"]);
        assert_eq!(split("teapot,caballito"), ["teapot", "caballito"]);
        assert_eq!(split("sphereflake:3,2, one"), ["sphereflake:3,2", "one"]);
    }

    #[test]
    fn a_number_after_a_parameter_is_its_own_item() {
        assert_eq!(split("grid:overlap=sat,bvh"), ["grid:overlap=sat", "bvh"]);
    }

    #[test]
    fn lists_given_twice_are_joined() {
        let texts = ["teapot".to_owned(), "one,empty".to_owned()];
        assert_eq!(split_list(&texts), ["teapot", "one", "empty"]);
    }

    #[test]
    fn thread_counts_are_sorted_and_unique() {
        assert_eq!(thread_counts("2,1,2").unwrap(), [1, 2]);
        assert!(thread_counts("0").is_err());
        assert!(
            thread_counts("many")
                .unwrap_err()
                .to_string()
                .contains("max")
        );
    }

    #[test]
    fn an_axis_that_nobody_has_is_an_error() {
        let error = with_axes(
            &["brute".to_owned()],
            &["moller-trumbore".to_owned()],
            &["colour=red".to_owned()],
        );
        assert!(error.unwrap_err().to_string().contains("'colour'"));
    }
}
