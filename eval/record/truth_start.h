#pragma once

#include <string>

#include "core/init_config.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// kInput: the truth has no velocity or no bias columns, so that no run can start from it.
Status CheckTruthForStart(const Trajectory& truth);

/// SHA-256 (hex) of what StartFromTruth may take of the truth; empty when init.method is another or there is
/// no truth.
[[nodiscard]] std::string DigestOfStartTruth(const InitConfig& config, const Trajectory* truth);

/// The start of init.method truth: truth at `stamp_ns` with the prior of `config`, moved off the truth by an
/// error drawn from that prior (unless config.perturb_truth is off), so that the very first NEES is a
/// chi-square sample.
///
/// The error theta_W (rad, in W: tilt about x and y, yaw about z), dp, dv, dbg, dba has the prior's
/// deviations; the estimate is R^ = Exp(-theta_W) R, x^ = x - dx; in the canonical chart phi = R^^T theta_W,
/// so P_phi = R^^T diag(tilt, tilt, yaw)^2 R^. Equal seeds give equal draws. Errors: those of
/// CheckTruthForStart and InterpolateTruth.
Result<NavEstimate> StartFromTruth(const InitConfig& config, const Trajectory& truth, TimeNs stamp_ns,
                                   unsigned seed);

}  // namespace alidade
