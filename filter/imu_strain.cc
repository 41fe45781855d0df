#include "filter/imu_strain.h"

#include <Eigen/LU>

#include "core/check.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

// Rows of alpha in the error of an ImuIncrement; beta follows.
constexpr int kAlpha = 3;

}  // namespace

ImuStrain::ImuStrain(int max_clones) : capacity_(static_cast<size_t>(max_clones)) {
  nodes_.reserve(capacity_);
  solved_.resize(capacity_);
  inverses_.resize(capacity_);
  couplings_.resize(capacity_);
}

void ImuStrain::Reset() {
  nodes_.clear();
  has_pending_ = false;
}

void ImuStrain::Propagate(const Preintegration& interval) {
  if (!active()) {
    return;
  }
  const ImuIncrement next{interval.motion(), interval.bias_jacobian(), interval.covariance()};
  if (has_pending_) {
    pending_.Append(next);
  } else {
    pending_ = next;
    has_pending_ = true;
  }
}

void ImuStrain::AddClone() {
  if (!active()) {
    return;
  }
  nodes_.push_back({});
  if (has_pending_) {
    nodes_.back().since = pending_;
  }
  has_pending_ = false;
}

void ImuStrain::RemoveClone(size_t index) {
  if (!active()) {
    return;
  }
  CHECK_LT(index + 1, nodes_.size()) << "the newest clone stays";
  if (index > 0) {
    Node& left = nodes_[index];
    Node& next = nodes_[index + 1];
    const double before_s = left.since.motion.duration_s;
    const double after_s = next.since.motion.duration_s;
    const Vector3d share = left.strain / (before_s + after_s);
    nodes_[index - 1].strain += after_s * share;
    next.strain += before_s * share;
    left.since.Append(next.since);
    next.since = left.since;
  }
  nodes_.erase(nodes_.begin() + static_cast<std::ptrdiff_t>(index));
}

void ImuStrain::SetClone(size_t index, const Matrix3d& R_WB, const Vector6d& correction) {
  nodes_[index].R_WB = R_WB;
  nodes_[index].correction = correction;
}

Vector6d ImuStrain::MotionChange(size_t index, const Vector6d& bias) const {
  const Node& from = nodes_[index - 1];
  const ImuIncrement& since = nodes_[index].since;
  const Vector3d phi = from.correction.head<3>();
  const Vector6d of_bias = since.bias_jacobian.middleRows<6>(kAlpha) * bias;
  Vector6d change;
  change << from.R_WB * (phi.cross(since.motion.alpha) + of_bias.head<3>()),
      from.R_WB * (phi.cross(since.motion.beta) + of_bias.tail<3>());
  return change;
}

void ImuStrain::Correct(const Vector3d& velocity, const Vector6d& bias) {
  Vector3d end = Vector3d::Zero();  // of the interval before the node: its velocity there by the IMU
  for (size_t k = 1; k < nodes_.size(); ++k) {
    const Vector6d change = MotionChange(k, bias);
    const Vector3d mean =
        (nodes_[k].correction.tail<3>() - nodes_[k - 1].correction.tail<3>() - change.head<3>()) /
        nodes_[k].since.motion.duration_s;
    if (k > 1) {
      nodes_[k - 1].strain += mean - end;
    }
    end = mean + change.tail<3>();
  }
  if (nodes_.size() > 1) {
    nodes_.back().strain += velocity - end;
  }
}

void ImuStrain::Turn(const Matrix3d& R) {
  for (Node& node : nodes_) {
    node.strain = R * node.strain;
    node.R_WB = R * node.R_WB;
  }
}

void ImuStrain::Mark() {
  for (Node& node : nodes_) {
    node.marked = node.strain;
  }
}

void ImuStrain::MarkNewest() {
  if (Freedom() > 0) {
    Node& node = nodes_[nodes_.size() - 2];
    node.marked = node.strain;
  }
}

int ImuStrain::Freedom() const {
  return nodes_.size() > 2 ? 3 * (static_cast<int>(nodes_.size()) - 2) : 0;
}

Matrix6d ImuStrain::MotionCovariance(size_t index) const {
  const Matrix3d& R = nodes_[index - 1].R_WB;
  const Matrix6d in_body = nodes_[index].since.covariance.block<6, 6>(kAlpha, kAlpha);
  Matrix6d turned;
  for (int row = 0; row < 6; row += 3) {
    for (int column = 0; column < 6; column += 3) {
      turned.block<3, 3>(row, column) = R * in_body.block<3, 3>(row, column) * R.transpose();
    }
  }
  return turned;
}

void ImuStrain::Solve(Vector3d Node::*e) {
  const size_t last = nodes_.size() - 2;
  Matrix6d before = MotionCovariance(1);
  double before_s = nodes_[1].since.motion.duration_s;
  for (size_t k = 1; k <= last; ++k) {
    const Matrix6d after = MotionCovariance(k + 1);
    const double after_s = nodes_[k + 1].since.motion.duration_s;
    const Matrix3d cross = before.topRightCorner<3, 3>() / before_s;
    Matrix3d diagonal = after.topLeftCorner<3, 3>() / (after_s * after_s) +
                        before.topLeftCorner<3, 3>() / (before_s * before_s) +
                        before.bottomRightCorner<3, 3>() - cross - cross.transpose();
    solved_[k] = nodes_[k].*e;
    if (k > 1) {
      // The interval before it is also in e of the node before.
      couplings_[k] = cross.transpose() - before.topLeftCorner<3, 3>() / (before_s * before_s);
      const Matrix3d gain = couplings_[k] * inverses_[k - 1];
      diagonal -= gain * couplings_[k].transpose();
      solved_[k] -= gain * solved_[k - 1];
    }
    inverses_[k] = diagonal.inverse();
    before = after;
    before_s = after_s;
  }
  for (size_t k = last; k >= 1; --k) {
    if (k < last) {
      solved_[k] -= couplings_[k + 1].transpose() * solved_[k + 1];
    }
    solved_[k] = (inverses_[k] * solved_[k]).eval();
  }
}

double ImuStrain::NormalizedSquare(Vector3d Node::*e) {
  if (Freedom() == 0) {
    return 0;
  }
  Solve(e);
  double sum = 0;
  for (size_t k = 1; k + 1 < nodes_.size(); ++k) {
    sum += (nodes_[k].*e).dot(solved_[k]);
  }
  return sum;
}

double ImuStrain::ScaleGradient() {
  if (!(NormalizedSquare(&Node::marked) < Freedom()) || !(NormalizedSquare() < Freedom())) {
    return 0;
  }
  double sum = 0;
  for (size_t k = 1; k + 1 < nodes_.size(); ++k) {
    sum += (nodes_[k].strain - nodes_[k].marked).dot(solved_[k]);
  }
  return sum;
}

}  // namespace alidade
