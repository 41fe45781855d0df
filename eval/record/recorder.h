#pragma once

#include <string>

#include "core/estimator_config.h"
#include "core/status.h"
#include "eval/record/run_result.h"

namespace alidade {

/// What a run was made from: with equal identities the outputs are equal.
struct RunIdentity {
  EstimatorConfig config;
  std::string dataset;         ///< name of the sequence
  std::string dataset_digest;  ///< SHA-256 of its files, or of the simulation's configuration and seed
  std::string input_digest;    ///< SHA-256 of the measurement log
  unsigned seed = 1;
  size_t imu_samples = 0;
  size_t frames = 0;
  bool audited = false;           ///< the run carries the observability audit
  std::string truth_digest = {};  ///< DigestOfStartTruth; empty: the run takes nothing from a truth
};

/// Digest of the resolved configuration.
[[nodiscard]] std::string DigestOf(const EstimatorConfig& config);

/// Writes trajectory.tum, states.csv, covariance.csv, timing.csv, status.csv, for an audited run
/// observability.csv, and, last, run.json into `folder` (formats: docs/formats.md). Equal runs give equal
/// bytes in all but timing.csv and the object `times` of run.json. A run.json that was there is removed
/// first, so that a folder with one is always complete. Errors: kOutput.
Status WriteRun(const RunIdentity& identity, const RunResult& result, const std::string& folder);

}  // namespace alidade
