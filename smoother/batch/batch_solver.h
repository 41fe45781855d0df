#pragma once

#include <atomic>

#include "core/estimator_config.h"
#include "smoother/batch/batch_sequence.h"
#include "smoother/batch/sequence_covariance.h"

namespace alidade {

/// How the batch estimate was found.
struct BatchReport {
  int solves = 0;
  int iterations = 0;  ///< of all solves
  double final_cost = 0;
  TrackSelection selection;
  SequenceCovariance covariance;
  bool stopped = false;
};

/// The maximum-a-posteriori estimate of all states and landmarks of the sequence, in place: prior, IMU, rest
/// and every observation that the gate lets pass. Ceres, Levenberg-Marquardt on inverse depths, SuiteSparse's
/// Cholesky factorisation of the reduced camera system, one thread, no time limit: equal input, equal bits.
///
///   1. A solve with a robust kernel on all tracks with a depth.
///   2. Gate (BatchSequence::Select), preintegration at the new biases, solve with the configured kernel;
///      again while the gate changes its mind, at most kGateRounds times.
///   3. The same with the tracks held, until the distance to the minimum (SequenceCovariance::
///      newton_decrement) is below config.batch.tolerance_sigma.
///
/// `stop` (may be null) is polled once an iteration. kDiverged: a solve failed, or the tolerance is not met
/// after kMaxSolves solves.
Result<BatchReport> SolveBatch(const EstimatorConfig& config, const std::atomic<bool>* stop,
                               BatchSequence* sequence);

}  // namespace alidade
