#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/preintegration.h"

namespace alidade {

/// How far corrections have moved the window of clones away from the IMU between them: for a clone k between
/// two others, the change of velocity there that the IMU does not explain,
///
///   e_k = (p_{k+1} - p_k - R_k alpha_b) / T_b - (p_k - p_{k-1} - R_{k-1} alpha_a) / T_a - R_{k-1} beta_a
///         - g (T_a + T_b) / 2      [m/s, in W]
///
/// with the intervals a before and b after it (core/imu_increment.h). It is summed up over corrections, each
/// to first order: evaluated at the states it would hold the squares of corrections as well, which are larger
/// than the noise of a good IMU.
class ImuStrain {
 public:
  /// Of at most `max_clones` clones; 0: nothing is computed.
  explicit ImuStrain(int max_clones);

  [[nodiscard]] bool active() const { return capacity_ > 0; }
  void Reset();
  /// Follows the state over an interval.
  void Propagate(const Preintegration& interval);
  /// The present state is cloned.
  void AddClone();
  /// A clone leaves, counted from the oldest, which is not the newest; the intervals on its sides become one.
  void RemoveClone(size_t index);
  /// Of the correction to come, that of one clone: (phi, dp) in the canonical chart at R_WB. It must be set
  /// for all of them, and then Correct called.
  void SetClone(size_t index, const Eigen::Matrix3d& R_WB, const Vector6d& correction);
  /// velocity: dv of the newest state; bias: (dbg, dba).
  void Correct(const Eigen::Vector3d& velocity, const Vector6d& bias);
  /// W turns by R.
  void Turn(const Eigen::Matrix3d& R);

  /// ScaleGradient() counts what comes after; the second of the newest interval alone.
  void Mark();
  void MarkNewest();
  /// The cost's gradient along the scale of the window that corrections since the marks have caused: the sum
  /// of d e^T C^-1 e, C the covariance of e by the IMU's noise. 0 where e is larger than that noise can make
  /// it, now or at the marks: then it is of the neglected squares.
  [[nodiscard]] double ScaleGradient();
  /// e^T C^-1 e, and its degrees of freedom.
  [[nodiscard]] double NormalizedSquare() { return NormalizedSquare(&Node::strain); }
  [[nodiscard]] int Freedom() const;
  /// Whether e is larger than the IMU's noise can make it.
  [[nodiscard]] bool ExceedsNoise() { return NormalizedSquare() > Freedom(); }
  /// e of clone `index`; of the newest one, that of the velocity after it.
  [[nodiscard]] const Eigen::Vector3d& strain(size_t index) const { return nodes_[index].strain; }

 private:
  struct Node {
    ImuIncrement since;  ///< from the clone before to this one
    Eigen::Matrix3d R_WB = Eigen::Matrix3d::Identity();
    Vector6d correction = Vector6d::Zero();
    Eigen::Vector3d strain = Eigen::Vector3d::Zero();
    Eigen::Vector3d marked = Eigen::Vector3d::Zero();
  };
  /// (alpha, beta) of the interval that ends at node `index`, turned into W, change by the corrections.
  [[nodiscard]] Vector6d MotionChange(size_t index, const Vector6d& bias) const;
  /// Covariance of the (alpha, beta) of that interval in W.
  [[nodiscard]] Matrix6d MotionCovariance(size_t index) const;
  /// solved_ <- C^-1 e, by block elimination: only neighbours have an interval in common.
  void Solve(Eigen::Vector3d Node::*e);
  [[nodiscard]] double NormalizedSquare(Eigen::Vector3d Node::*e);

  size_t capacity_;
  bool has_pending_ = false;
  ImuIncrement pending_;  ///< since the newest clone
  std::vector<Node> nodes_;
  std::vector<Eigen::Vector3d> solved_;    // scratch of Solve
  std::vector<Eigen::Matrix3d> inverses_;  // of the eliminated diagonal blocks
  std::vector<Eigen::Matrix3d> couplings_;
};

}  // namespace alidade
