#include "eval/simulation/image_exposure.h"

#include <algorithm>
#include <cmath>

#include "core/lie.h"

namespace alidade {
namespace {

constexpr int kIntervals = 64;

}  // namespace

ImageExposure::ImageExposure(const std::function<Pose(double)>& T_WC_after, double line_delay_s,
                             int height_px)
    : rows_between_(static_cast<double>(height_px) / kIntervals) {
  for (int k = 0; k <= kIntervals; ++k) {
    poses_.push_back(T_WC_after(line_delay_s * (k * rows_between_ - 0.5 * height_px)));
  }
}

Pose ImageExposure::CameraAt(double row) const {
  if (at_once()) {
    return poses_.front();
  }
  const double place = std::clamp(row / rows_between_, 0.0, static_cast<double>(kIntervals));
  const auto before = static_cast<std::size_t>(std::min(std::floor(place), kIntervals - 1.0));
  const Pose& a = poses_[before];
  const Pose& b = poses_[before + 1];
  const double share = place - static_cast<double>(before);
  const Eigen::Vector3d turn = so3::Log(a.rotation.transpose() * b.rotation);
  return {a.rotation * so3::Exp(Eigen::Vector3d(share * turn)),
          a.translation + share * (b.translation - a.translation)};
}

}  // namespace alidade
