#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <variant>
#include <vector>

#include "core/time.h"
#include "eval/identify/noise_source.h"
#include "filter/filter_observer.h"

namespace alidade {

/// What a filter did to its error, as a linear system with the innovations that it met. Everything that a
/// filter decides (which rows, where they are linearised, what the gate refuses) is fixed in it; what is left
/// open is how large the noises are.
///
/// The error is that of the recorded estimates, xi. A filter with other noises corrects it otherwise: its own
/// estimate of xi, the offset d, takes part in each step, and its innovation is y - H d.
struct LinearSystem {
  /// The error is anew N(0, root root^T), of which the first `leading` rows lie before the core.
  struct Restart {
    int leading = 0;
    Eigen::MatrixXd root;
  };
  /// core <- phi core + sum w_j, w_j ~ N(0, q_j) for each of the IMU's noises. 15 x 15.
  struct Propagation {
    Eigen::MatrixXd phi;
    std::array<Eigen::MatrixXd, kImuNoiseSources> q;
  };
  struct ClockPropagation {
    Matrix6d phi, q;
  };
  struct Cloning {
    int first = 0, size = 0;
  };
  struct Removal {
    int first = 0, size = 0;
  };
  /// xi <- xi + column (row . xi).
  struct Shear {
    Eigen::VectorXd column, row;
  };
  /// y = H xi + n, n ~ N(0, I), H zero before the column `first`. More rows than columns are rotated into as
  /// many, which leaves `discarded_rows` innovations of pure noise with the squared norm `discarded`.
  struct Update {
    RowSource source = RowSource::kVision;
    int first = 0;
    Eigen::MatrixXd rows;
    Eigen::VectorXd innovation;
    int discarded_rows = 0;
    double discarded = 0;
    Eigen::VectorXd correction;  ///< by which the recorded filter corrected its state
  };
  struct FrameEnd {
    TimeNs stamp_ns = 0;
  };
  using Step =
      std::variant<Restart, Propagation, ClockPropagation, Cloning, Removal, Shear, Update, FrameEnd>;

  std::vector<Step> steps;
  int capacity = 0;  ///< largest dimension of the error
  int max_leading = 0;
  std::size_t frames = 0;
  std::array<std::size_t, 4> rows = {};  ///< of the updates by RowSource
};

}  // namespace alidade
