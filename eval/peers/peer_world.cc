#include "eval/peers/peer_world.h"

namespace alidade {
namespace {

/// Turns and moves the world of a row; (phi, dp) of the canonical chart: phi stays, it is in the body's axes.
void Transform(const Pose& T_NW, TrajectoryPoint* point) {
  point->nav.R_WB = T_NW.rotation * point->nav.R_WB;
  point->nav.p_WB = T_NW.rotation * point->nav.p_WB + T_NW.translation;
  point->nav.v_WB = T_NW.rotation * point->nav.v_WB;
  Matrix6d turn = Matrix6d::Identity();
  turn.bottomRightCorner<3, 3>() = T_NW.rotation;
  point->covariance = turn * point->covariance * turn.transpose();
}

}  // namespace

PeerWorld::PeerWorld(const std::optional<Eigen::Vector3d>& anchor_E) {
  if (anchor_E) {
    enu_ = EnuFrame::At(*anchor_E);
  }
}

void PeerWorld::Add(const TrajectoryPoint& point, const std::optional<Pose>& T_EW) {
  points_.push_back(point);
  if (!T_EW) {
    return;
  }
  aligned_ns_ = aligned_ns_.value_or(point.stamp_ns);
  if (!enu_) {
    return;
  }
  const Pose T_NW = {enu_->R_EN.transpose() * T_EW->rotation, enu_->FromEcef(T_EW->translation)};
  for (; begin_ < points_.size(); ++begin_) {
    Transform(T_NW, &points_[begin_]);
  }
}

}  // namespace alidade
