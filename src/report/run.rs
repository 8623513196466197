//! From what was measured to what is reported.

use crate::accel;
use crate::kernel;
use crate::lab::{AccuracyRecord, NRule, RunRecord};
use crate::registry::{Params, Value};
use crate::stats::Summary;

use super::Run;

impl From<&RunRecord> for Run {
    /// The record with its samples summarised. The bootstrap is seeded by the run's own seed, so the same record gives
    /// the same run.
    fn from(record: &RunRecord) -> Self {
        let config = &record.config;
        let mut params = config.accel.params.clone();
        let own_test = accel::entry(&config.accel.name)
            .ok()
            .and_then(|entry| entry.own_test(&config.accel.params));
        // Where a peer's own test decided, the kernel's parameters decided nothing.
        let kernel_params = own_test.is_none().then_some(&config.kernel.params);
        for (key, value) in kernel_params.into_iter().flat_map(Params::iter) {
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
        if let Some(picked) = &record.picked {
            params.insert("picked", Value::Text(picked.clone()));
        }
        Self {
            id: record.id.clone(),
            scene: config.scene.clone(),
            triangles: record.triangles,
            accel: config.accel.name.clone(),
            params,
            n: record.n,
            kernel: own_test.unwrap_or(&config.kernel.name).to_owned(),
            beside_kernel: own_test.map(|_| {
                let specs = kernel::entry(&config.kernel).map_or(&[][..], |entry| entry.params);
                config.kernel.label(specs)
            }),
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
            wrong_answers: record.wrong_answers,
            sweep: None,
            accuracy: None,
            warnings: record.warnings.clone(),
        }
    }
}

impl From<&AccuracyRecord> for Run {
    /// As of a sweep's record, with what the oracle found.
    fn from(record: &AccuracyRecord) -> Self {
        Self {
            accuracy: Some(record.accuracy),
            ..Self::from(&record.run)
        }
    }
}
