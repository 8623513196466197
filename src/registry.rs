//! What every registry row has: a name, a sentence, parameters; and how a choice of one is written and read.
//!
//! A choice is written `name` or `name:key=value:key=value`, e.g. `grid:overlap=sat:mailbox=off`. Parameters that are
//! not written take their defaults, so two spellings of one configuration are the same [`Params`].

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A parameter's value, as it stands in reports.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// A whole number.
    Int(u64),
    /// A finite number.
    Float(f64),
    /// One of a list of words.
    Text(String),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Int(x) => write!(f, "{x}"),
            // Scientific only where plain digits would be long: `1e-5`, but `0.25`.
            Self::Float(x) if *x != 0.0 && (x.abs() < 1e-3 || x.abs() >= 1e6) => write!(f, "{x:e}"),
            Self::Float(x) => write!(f, "{x}"),
            Self::Text(x) => f.write_str(x),
        }
    }
}

/// What a parameter accepts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ParamKind {
    /// One of these words.
    Choice(&'static [&'static str]),
    /// A whole number, bounds inclusive.
    Int {
        /// Least accepted value.
        min: u64,
        /// Greatest accepted value.
        max: u64,
    },
    /// A finite number, bounds inclusive.
    Float {
        /// Least accepted value.
        min: f64,
        /// Greatest accepted value.
        max: f64,
    },
}

/// A parameter of a registry row.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ParamSpec {
    /// Key in `name:key=value`, `--set` and the report's `params`.
    pub name: &'static str,
    /// One sentence.
    pub about: &'static str,
    /// What it accepts.
    pub kind: ParamKind,
    /// The value taken when none is given, as it would be written.
    pub default: &'static str,
}

impl ParamSpec {
    /// Reads a written value.
    ///
    /// # Errors
    /// A value of the wrong kind or out of bounds.
    pub fn parse(&self, text: &str) -> Result<Value, ChoiceError> {
        let bad = |expected: String| ChoiceError::BadValue {
            param: self.name.to_owned(),
            value: text.to_owned(),
            expected,
        };
        match self.kind {
            ParamKind::Choice(words) => {
                if words.contains(&text) {
                    Ok(Value::Text(text.to_owned()))
                } else {
                    Err(bad(format!("one of {}", words.join(", "))))
                }
            }
            ParamKind::Int { min, max } => match text.parse() {
                Ok(x) if (min..=max).contains(&x) => Ok(Value::Int(x)),
                _ => Err(bad(format!("a whole number from {min} to {max}"))),
            },
            ParamKind::Float { min, max } => match text.parse::<f64>() {
                Ok(x) if x >= min && x <= max => Ok(Value::Float(x)),
                _ => Err(bad(format!("a number from {min:e} to {max:e}"))),
            },
        }
    }
}

/// The values of all parameters of one choice, defaults filled in.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Params(BTreeMap<String, Value>);

impl Params {
    /// The defaults of `specs`.
    #[must_use]
    pub fn defaults(specs: &[ParamSpec]) -> Self {
        Self(
            specs
                .iter()
                .filter_map(|s| Some((s.name.to_owned(), s.parse(s.default).ok()?)))
                .collect(),
        )
    }

    /// Sets `name` to a written value.
    ///
    /// # Errors
    /// `specs` has no such parameter, or it does not accept the value.
    pub fn set(&mut self, specs: &[ParamSpec], name: &str, text: &str) -> Result<(), ChoiceError> {
        let spec =
            specs
                .iter()
                .find(|s| s.name == name)
                .ok_or_else(|| ChoiceError::UnknownParam {
                    param: name.to_owned(),
                    known: specs.iter().map(|s| s.name).collect::<Vec<_>>().join(", "),
                })?;
        self.0.insert(name.to_owned(), spec.parse(text)?);
        Ok(())
    }

    /// Adds a value under a key that no row states, e.g. where the parameters of two rows come together.
    pub fn insert(&mut self, name: &str, value: Value) {
        self.0.insert(name.to_owned(), value);
    }

    /// The word that `name` has; empty when it has none.
    #[must_use]
    pub fn text(&self, name: &str) -> &str {
        match self.0.get(name) {
            Some(Value::Text(x)) => x,
            _ => "",
        }
    }

    /// The number that `name` has; `None` when it has none.
    #[must_use]
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.0.get(name)? {
            Value::Int(x) => Some(*x as f64),
            Value::Float(x) => Some(*x),
            Value::Text(_) => None,
        }
    }

    /// All parameters by name.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Value)> {
        self.0.iter().map(|(k, v)| (k.as_str(), v))
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// A row of a registry together with values for its parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    /// The row's name.
    pub name: String,
    /// Values of all its parameters.
    pub params: Params,
}

impl Choice {
    /// Reads `name:key=value:…` against the rows of a registry.
    ///
    /// # Errors
    /// An unknown name (with the nearest known one), parameter or value.
    pub fn parse<'a>(
        what: &'static str,
        text: &str,
        rows: impl IntoIterator<Item = (&'a str, &'a [ParamSpec])>,
    ) -> Result<Self, ChoiceError> {
        let mut parts = text.split(':');
        let name = parts.next().unwrap_or_default().trim();
        let rows: Vec<_> = rows.into_iter().collect();
        let Some((_, specs)) = rows.iter().find(|(row, _)| *row == name) else {
            return Err(ChoiceError::unknown(
                what,
                name,
                rows.iter().map(|(row, _)| *row),
            ));
        };
        let mut params = Params::defaults(specs);
        for part in parts {
            let (key, value) = part
                .split_once('=')
                .ok_or_else(|| ChoiceError::NotKeyValue(part.to_owned()))?;
            params.set(specs, key.trim(), value.trim())?;
        }
        Ok(Self {
            name: name.to_owned(),
            params,
        })
    }

    /// The name with those parameters that differ from the defaults of `specs`: what a person would have written.
    #[must_use]
    pub fn label(&self, specs: &[ParamSpec]) -> String {
        let defaults = Params::defaults(specs);
        let mut label = self.name.clone();
        for (key, value) in self.params.iter() {
            if defaults.0.get(key) != Some(value) {
                label.push(':');
                label.push_str(key);
                label.push('=');
                label.push_str(&value.to_string());
            }
        }
        label
    }
}

/// Why a written choice is not one.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ChoiceError {
    /// No row of that name.
    #[error("unknown {what} '{name}'; {hint}")]
    UnknownName {
        /// Kind of thing: "accelerator", "kernel", …
        what: &'static str,
        /// What was written.
        name: String,
        /// The nearest known name, or all of them.
        hint: String,
    },
    /// The row has no such parameter.
    #[error("no parameter '{param}' here; known: {known}")]
    UnknownParam {
        /// What was written.
        param: String,
        /// The known ones.
        known: String,
    },
    /// A value the parameter does not accept.
    #[error("'{value}' is not a value of '{param}'; it takes {expected}")]
    BadValue {
        /// The parameter.
        param: String,
        /// What was written.
        value: String,
        /// What it accepts.
        expected: String,
    },
    /// A part without `=`.
    #[error("'{0}' is not 'key=value'; write e.g. 'grid:overlap=sat'")]
    NotKeyValue(String),
}

impl ChoiceError {
    /// An unknown-name error that names the nearest of `known`, or lists them where none is near.
    pub fn unknown<'a>(
        what: &'static str,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let known: Vec<&str> = known.into_iter().collect();
        let hint = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean '{near}'?"),
            None => format!("known: {}", known.join(", ")),
        };
        Self::UnknownName {
            what,
            name: name.to_owned(),
            hint,
        }
    }
}

/// The entry of `known` that `name` is most likely a misspelling of; `None` where none is close.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|k| (strsim::jaro_winkler(name, k), k))
        // 0.75: 'gird' finds 'grid' and 'bhv' finds 'bvh', while 'octopus' finds nothing.
        .filter(|(score, _)| *score > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, k)| k)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPECS: &[ParamSpec] = &[
        ParamSpec {
            name: "overlap",
            about: "How overlap is decided.",
            kind: ParamKind::Choice(&["sat", "bbox"]),
            default: "sat",
        },
        ParamSpec {
            name: "eps",
            about: "Tolerance.",
            kind: ParamKind::Float { min: 0.0, max: 1.0 },
            default: "1e-5",
        },
    ];

    fn parse(text: &str) -> Result<Choice, ChoiceError> {
        Choice::parse("accelerator", text, [("grid", SPECS), ("brute", &[][..])])
    }

    #[test]
    fn a_name_alone_takes_the_defaults() {
        assert_eq!(parse("grid"), parse("grid:overlap=sat:eps=1e-5"));
        assert_eq!(parse("grid").unwrap().label(SPECS), "grid");
    }

    #[test]
    fn a_label_names_what_differs_from_the_defaults() {
        assert_eq!(
            parse("grid:eps=0.001:overlap=bbox").unwrap().label(SPECS),
            "grid:eps=0.001:overlap=bbox"
        );
    }

    #[test]
    fn a_misspelt_name_is_answered_with_the_nearest() {
        assert!(
            parse("gird")
                .unwrap_err()
                .to_string()
                .contains("did you mean 'grid'?")
        );
        assert!(
            parse("zzz")
                .unwrap_err()
                .to_string()
                .contains("known: grid, brute")
        );
    }

    #[test]
    fn values_out_of_bounds_and_unknown_keys_are_refused() {
        assert!(matches!(
            parse("grid:eps=2"),
            Err(ChoiceError::BadValue { .. })
        ));
        assert!(matches!(
            parse("grid:eps=nan"),
            Err(ChoiceError::BadValue { .. })
        ));
        assert!(matches!(
            parse("grid:size=2"),
            Err(ChoiceError::UnknownParam { .. })
        ));
        assert!(matches!(
            parse("grid:size"),
            Err(ChoiceError::NotKeyValue(_))
        ));
    }
}
