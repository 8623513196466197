//! From what was measured to what is reported.

use crate::lab::{NRule, RunRecord};
use crate::registry::Value;
use crate::stats::Summary;

use super::Run;

impl From<&RunRecord> for Run {
    /// The record with its samples summarised. The bootstrap is seeded by the run's own seed, so the same record gives
    /// the same run.
    fn from(record: &RunRecord) -> Self {
        let config = &record.config;
        let mut params = config.accel.params.clone();
        for (key, value) in config.kernel.params.iter() {
            // A kernel's parameter of the same name as one of the accelerator keeps both.
            let taken = params.iter().any(|(name, _)| name == key);
            let key = if taken {
                format!("kernel.{key}")
            } else {
                key.to_owned()
            };
            params.insert(&key, value.clone());
        }
        if config.n == Some(NRule::Auto) {
            params.insert("n_rule", Value::Text("auto".to_owned()));
        }
        Self {
            id: record.id.clone(),
            scene: config.scene.clone(),
            triangles: record.triangles,
            accel: config.accel.name.clone(),
            params,
            n: record.n,
            kernel: config.kernel.name.clone(),
            rays: config.rays.clone(),
            ray_count: record.ray_count,
            threads: config.threads,
            build_ms: Summary::of(&record.build_ms, config.seed),
            memory_bytes: record.memory_bytes,
            mrays_per_s: Summary::of(&record.mrays_per_s, config.seed),
            stopped_by: record.stopped_by,
            per_ray: record.per_ray,
            structure: record.structure,
            predicted: record.predicted,
            checksum: record.checksum,
            valid: record.valid,
            checked_rays: record.checked_rays,
            kernel_errors: record.kernel_errors,
            accuracy: None,
            warnings: record.warnings.clone(),
        }
    }
}
