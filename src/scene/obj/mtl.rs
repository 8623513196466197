//! Materials of MTL files.
//!
//! Only statements that colour a triangle reach tobj, each checked: tobj 4.0.5 panics at a colour of fewer than three
//! numbers and drops all materials for one bad statement. A statement that says nothing usable becomes a warning, and
//! its value the default of [`Material`].

use std::path::Path;

use super::clean::shown;
use super::lines::{Failure, Lines, words};
use crate::geometry::Vec3;
use crate::scene::Material;

/// The materials of an MTL file, in its order; `warnings` gets a sentence for each statement that was mended.
pub fn read(text: &[u8], path: &Path, warnings: &mut Vec<String>) -> Vec<Material> {
    let mut cleaned = Vec::new();
    let mut lines = Lines::new(text);
    let mut textures = 0;
    let mut named = false;
    loop {
        let (line, text) = match lines.next() {
            Ok(Some(next)) => next,
            Ok(None) => break,
            Err(Failure::File(reason) | Failure::Text { reason, .. }) => {
                warnings.push(format!("'{}' {reason}.", path.display()));
                break;
            }
            Err(Failure::Io(e)) => {
                warnings.push(format!("'{}' ends early: {e}.", path.display()));
                break;
            }
        };
        let key = shown(words(text).next().unwrap_or_default());
        let rest = shown(&text[key.len().min(text.len())..]).trim().to_owned();
        let mut warn = |what: String| warnings.push(format!("{}:{line}: {what}.", path.display()));
        if key == "newmtl" {
            named = !rest.is_empty();
            if named {
                cleaned.extend(format!("newmtl {rest}\n").bytes());
            } else {
                warn("a material without a name is ignored".to_owned());
            }
        } else if key.starts_with("map_") || key == "bump" || key == "disp" {
            textures += 1;
        } else if named && let Some(statement) = statement(&key, &rest, &mut warn) {
            cleaned.extend(statement.bytes());
        }
    }
    if textures > 0 {
        warnings.push(format!(
            "'{}' names {textures} textures; raylab ignores textures.",
            path.display()
        ));
    }
    match tobj::load_mtl_buf(&mut &cleaned[..]) {
        Ok((materials, _)) => materials.iter().map(material).collect(),
        Err(e) => {
            warnings.push(format!("'{}' has no usable material: {e}.", path.display()));
            Vec::new()
        }
    }
}

/// What a statement's numbers must be.
enum Numbers {
    /// Three, each from 0 to the given.
    Colour(f32),
    /// One, within bounds.
    One(f32, f32),
}

/// A statement as tobj shall read it; `None` where it colours nothing or says nothing usable.
fn statement(key: &str, rest: &str, warn: &mut impl FnMut(String)) -> Option<String> {
    let numbers = match key {
        "Kd" | "Ks" | "Tf" => Numbers::Colour(1.0),
        "Ke" => Numbers::Colour(f32::MAX),
        "Ns" => Numbers::One(0.0, 1e6),
        // 0.001 to 10 by the format's description.
        "Ni" => Numbers::One(0.001, 10.0),
        "d" | "Tr" => Numbers::One(0.0, 1.0),
        "illum" => Numbers::One(0.0, 10.0),
        _ => return None,
    };
    let rest = match rest.strip_prefix("-halo") {
        Some(factor) if key == "d" => {
            warn("'d -halo' is read as plain 'd'".to_owned());
            factor
        }
        _ => rest,
    };
    let (count, lo, hi) = match numbers {
        Numbers::Colour(hi) => (3, 0.0, hi),
        Numbers::One(lo, hi) => (1, lo, hi),
    };
    let read = |word: &str| word.parse::<f32>().ok().filter(|x| x.is_finite());
    let values: Option<Vec<f32>> = rest
        .split_ascii_whitespace()
        .take(count)
        .map(read)
        .collect();
    let Some(values) = values.filter(|v| v.len() == count) else {
        let needs = if count == 1 {
            "a number"
        } else {
            "three numbers"
        };
        warn(format!(
            "'{key} {rest}' needs {needs}; {key} keeps its default"
        ));
        return None;
    };
    // A refraction index outside the format's bounds is no index at all, and so is an illumination model.
    if matches!(key, "Ni" | "illum") && !(lo..=hi).contains(&values[0]) {
        warn(format!(
            "'{key} {rest}' is not from {lo} to {hi}; {key} keeps its default"
        ));
        return None;
    }
    if values.iter().any(|x| !(lo..=hi).contains(x)) {
        warn(format!(
            "'{key} {rest}' is not from {lo} to {hi}; it is moved there"
        ));
    }
    let values: Vec<String> = values
        .iter()
        .map(|x| x.clamp(lo, hi))
        .map(|x| {
            if key == "illum" {
                (x as u8).to_string()
            } else {
                x.to_string()
            }
        })
        .collect();
    Some(format!("{key} {}\n", values.join(" ")))
}

/// A material of ours.
fn material(m: &tobj::Material) -> Material {
    let plain = Material::default();
    let colour = |c: Option<[f32; 3]>, default: Vec3| c.map_or(default, Vec3::from_array);
    let unknown = |key: &str| -> Option<Vec<f32>> {
        let words = m.unknown_param.get(key)?.split(' ');
        words.map(|w| w.parse().ok()).collect()
    };
    let specular = colour(m.specular, plain.specular);
    // Where both are written, `d` holds: exporters disagree on which way round `Tr` is.
    let opacity = m.dissolve.or_else(|| Some(1.0 - unknown("Tr")?.first()?));
    let transmission = unknown("Tf").and_then(|c| <[f32; 3]>::try_from(c).ok());
    Material {
        name: m.name.clone(),
        diffuse: colour(m.diffuse, plain.diffuse),
        specular,
        shininess: m.shininess.unwrap_or(plain.shininess),
        transmission: colour(transmission, plain.transmission),
        refraction_index: m.optical_density.unwrap_or(plain.refraction_index),
        opacity: opacity.unwrap_or(plain.opacity),
        emission: colour(m.emissive, plain.emission),
        // Without a model, a highlight is meant where one has a colour.
        illum: m
            .illumination_model
            .unwrap_or(if specular == Vec3::ZERO { 1 } else { 2 }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> (Vec<Material>, Vec<String>) {
        let mut warnings = Vec::new();
        let materials = read(text.as_bytes(), Path::new("a.mtl"), &mut warnings);
        (materials, warnings)
    }

    #[test]
    fn all_statements_that_colour_a_triangle_are_read() {
        let (materials, warnings) = read_text(
            "newmtl glass\nKa 1 1 1\nKd 0.1 0.2 0.3\nKs 0.4 0.5 0.6\nKe 2 3 4\nNs 90\nNi 1.5\nTr 0.75\nTf 0.98 1 0.98\nillum 7\n",
        );
        assert_eq!(warnings, [""; 0]);
        let expected = Material {
            name: "glass".to_owned(),
            diffuse: Vec3::new(0.1, 0.2, 0.3),
            specular: Vec3::new(0.4, 0.5, 0.6),
            shininess: 90.0,
            transmission: Vec3::new(0.98, 1.0, 0.98),
            refraction_index: 1.5,
            opacity: 0.25,
            emission: Vec3::new(2.0, 3.0, 4.0),
            illum: 7,
        };
        assert_eq!(materials, [expected]);
    }

    #[test]
    fn a_colour_of_fewer_than_three_numbers_is_defaulted_with_a_warning_that_names_the_line() {
        let (materials, warnings) = read_text("newmtl a\nKd 0.5\nKs 0.1 0.2 0.3");
        assert_eq!(materials[0].diffuse, Material::default().diffuse);
        assert_eq!(materials[0].specular, Vec3::new(0.1, 0.2, 0.3));
        assert_eq!(
            warnings,
            ["a.mtl:2: 'Kd 0.5' needs three numbers; Kd keeps its default."]
        );
    }

    #[test]
    fn words_halos_and_spectra_cost_only_their_own_statement() {
        let (materials, warnings) = read_text(
            "newmtl a\nKd xyz\nd -halo 0.5\nKs spectral f.rfl\nNs\nillum x\nNi 0\nnewmtl b\nKd 1 0 0",
        );
        assert_eq!(materials.len(), 2);
        assert_eq!(materials[0].opacity, 0.5);
        assert_eq!(materials[0].refraction_index, 1.0);
        assert_eq!(materials[1].diffuse, Vec3::X);
        assert_eq!(warnings.len(), 6, "{warnings:?}");
    }

    #[test]
    fn numbers_out_of_bounds_and_not_finite_are_mended_with_a_warning() {
        let (materials, warnings) = read_text("newmtl a\nKd 2 -1 0.5\nd nan\nNs inf\nKe 1e400 0 0");
        assert_eq!(materials[0].diffuse, Vec3::new(1.0, 0.0, 0.5));
        assert_eq!((materials[0].opacity, materials[0].shininess), (1.0, 10.0));
        assert_eq!(materials[0].emission, Vec3::ZERO);
        assert_eq!(warnings.len(), 4, "{warnings:?}");
    }

    #[test]
    fn statements_outside_a_material_and_materials_without_a_name_are_ignored() {
        let (materials, warnings) = read_text("Kd 1 0 0\nnewmtl\nKd 0 1 0\nnewmtl c d\nKd 0 0 1");
        assert_eq!(materials.len(), 1);
        assert_eq!(
            (materials[0].name.as_str(), materials[0].diffuse),
            ("c d", Vec3::Z)
        );
        assert_eq!(warnings.len(), 1);
    }

    #[test]
    fn where_opacity_is_written_twice_d_holds() {
        assert_eq!(read_text("newmtl a\nd 1\nTr 1").0[0].opacity, 1.0);
    }

    #[test]
    fn a_highlight_without_a_model_is_one() {
        assert_eq!(read_text("newmtl a\nKs 1 1 1").0[0].illum, 2);
        assert_eq!(read_text("newmtl a\nKd 1 1 1").0[0].illum, 1);
    }
}
