//! Where and how a report is measured: program, compiler, machine, scenes.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use sysinfo::{CpuRefreshKind, RefreshKind, System};

use crate::geometry::lanes::InstructionSet;
use crate::lab::Plan;
use crate::scene::{self, SceneError};

use super::{Provenance, SceneFacts};

/// The commit that the program was built from; empty where it is not known, and in debug builds.
const COMMIT: &str = env!("RAYLAB_COMMIT");

impl Provenance {
    /// Looks at the program, the machine and the scenes of `plan`; `command` is the command line.
    ///
    /// What the system does not tell stays empty.
    ///
    /// # Errors
    /// A scene cannot be loaded.
    pub fn gather(plan: &Plan, command: Vec<String>) -> Result<Self, SceneError> {
        let scenes = plan.scenes.iter().map(|spec| scene_facts(spec));
        Ok(Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: COMMIT.to_owned(),
            dirty: !env!("RAYLAB_DIRTY").is_empty(),
            rustc: env!("RAYLAB_RUSTC").to_owned(),
            target: env!("RAYLAB_TARGET").to_owned(),
            profile: env!("RAYLAB_PROFILE").to_owned(),
            cpu: cpu_model(),
            cores: crate::lab::cores(),
            caches: caches(Path::new("/sys/devices/system/cpu/cpu0/cache")),
            instruction_set: InstructionSet::best().name().to_owned(),
            os: System::long_os_version().unwrap_or_else(|_| std::env::consts::OS.to_owned()),
            load: System::load_average().map_or(-1.0, |load| load.one),
            date: rfc3339(SystemTime::now()),
            command,
            seed: plan.seed,
            scenes: scenes.collect::<Result<_, _>>()?,
        })
    }

    /// Whether figures of both can stand side by side: same program, compiler, CPU and instruction set.
    #[must_use]
    pub fn same_machine(&self, other: &Self) -> bool {
        let parts = |p: &Self| {
            [
                &p.version,
                &p.rustc,
                &p.target,
                &p.profile,
                &p.cpu,
                &p.instruction_set,
            ]
            .map(Clone::clone)
        };
        parts(self) == parts(other) && self.cores == other.cores
    }
}

fn scene_facts(spec: &str) -> Result<SceneFacts, SceneError> {
    let mesh = scene::load(spec)?.mesh;
    Ok(SceneFacts {
        name: spec.to_owned(),
        hash: scene::hash(&mesh),
        triangles: mesh.len() as u64,
        degenerate: mesh.degenerate() as u64,
    })
}

fn cpu_model() -> String {
    let wanted = RefreshKind::nothing().with_cpu(CpuRefreshKind::nothing());
    let system = System::new_with_specifics(wanted);
    let brand = system
        .ok()
        .and_then(|s| Some(s.cpus().first()?.brand().trim().to_owned()));
    brand.unwrap_or_default()
}

/// Sizes in bytes of the data and unified caches that Linux lists in `dir`, from the first level on; empty elsewhere.
fn caches(dir: &Path) -> Vec<u64> {
    let mut caches = Vec::new();
    for index in 0..8 {
        let read = |name: &str| {
            let text = std::fs::read_to_string(dir.join(format!("index{index}/{name}"))).ok()?;
            Some(text.trim().to_owned())
        };
        let (Some(level), Some(kind), Some(size)) = (read("level"), read("type"), read("size"))
        else {
            continue;
        };
        if kind != "Instruction"
            && let (Ok(level), Some(bytes)) = (level.parse::<u32>(), bytes(&size))
        {
            caches.push((level, bytes));
        }
    }
    caches.sort_unstable();
    caches.into_iter().map(|(_, bytes)| bytes).collect()
}

/// `32K` as 32768; `None` of anything else.
fn bytes(text: &str) -> Option<u64> {
    let (digits, factor) = match text.strip_suffix(['K', 'M']) {
        Some(digits) if text.ends_with('K') => (digits, 1 << 10),
        Some(digits) => (digits, 1 << 20),
        None => (text, 1),
    };
    digits.parse::<u64>().ok()?.checked_mul(factor)
}

/// A point in time as `2026-01-31T12:00:00Z`.
///
/// **Source:** the days-to-date algorithm of H. Hinnant, "chrono-Compatible Low-Level Date Algorithms", `civil_from_days`.
fn rfc3339(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let (days, second) = (seconds / 86_400 + 719_468, seconds % 86_400);
    let era = days / 146_097;
    let day_of_era = days % 146_097;
    let year_of_era =
        (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    // Months count from March, so that the leap day is the last of its year.
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 {
        month_from_march + 3
    } else {
        month_from_march - 9
    };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        // From `date -u -d @SECONDS`.
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (1_709_251_200, "2024-03-01T00:00:00Z"),
            (1_798_761_599, "2026-12-31T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(rfc3339(UNIX_EPOCH + Duration::from_secs(seconds)), text);
        }
    }

    #[test]
    fn caches_are_read_from_the_first_level_on_without_that_of_instructions() {
        let dir = tempfile::tempdir().unwrap();
        let caches_on_disk = [
            ("3", "Unified", "33M"),
            ("1", "Instruction", "32K"),
            ("1", "Data", "48K"),
            ("2", "Unified", "x"),
        ];
        for (index, (level, kind, size)) in caches_on_disk.into_iter().enumerate() {
            let dir = dir.path().join(format!("index{index}"));
            std::fs::create_dir(&dir).unwrap();
            for (name, text) in [("level", level), ("type", kind), ("size", size)] {
                std::fs::write(dir.join(name), format!("{text}\n")).unwrap();
            }
        }
        assert_eq!(caches(dir.path()), [48 << 10, 33 << 20]);
        assert!(caches(Path::new("no/such/folder")).is_empty());
    }

    #[test]
    fn a_gathered_provenance_names_program_and_scenes() {
        let plan = Plan {
            scenes: vec!["one".to_owned()],
            ..Plan::default()
        };
        let gathered = Provenance::gather(&plan, vec!["raylab".to_owned()]).unwrap();
        assert_eq!(gathered.version, env!("CARGO_PKG_VERSION"));
        assert!(gathered.rustc.starts_with("rustc ") && gathered.cores > 0);
        assert_eq!(
            (gathered.scenes.len(), gathered.scenes[0].triangles),
            (1, 1)
        );
        assert_eq!(gathered.scenes[0].hash.len(), 64);
        assert!(gathered.same_machine(&gathered.clone()));
        let unknown = Plan {
            scenes: vec!["teapt".to_owned()],
            ..plan
        };
        assert!(Provenance::gather(&unknown, Vec::new()).is_err());
    }
}
