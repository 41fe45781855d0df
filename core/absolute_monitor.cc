#include "core/absolute_monitor.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace alidade {

void AbsoluteMonitor::AddCorrection(const AbsoluteComparison& of_another) {
  history_.push_back(of_another);
  while (SecondsBetween(history_.front().stamp_ns, of_another.stamp_ns) > kWindowsS.back()) {
    history_.pop_front();
  }
}

void AbsoluteMonitor::Add(const AbsoluteComparison& comparison) {
  AddCorrection(comparison);
  const TimeNs now_ns = comparison.stamp_ns;
  contradiction_.reset();
  sigmas_ = 0;
  Eigen::Vector3d distance = comparison.left;
  Eigen::Matrix3d covariance = 2 * comparison.left_covariance;
  auto next = history_.rbegin();
  for (std::size_t i = 0; i < kWindowsS.size(); ++i) {
    for (; next != history_.rend() && SecondsBetween(next->stamp_ns, now_ns) <= kWindowsS[i]; ++next) {
      distance += next->change;
      covariance += next->change_covariance;
    }
    const double sigmas = std::sqrt(std::max(0.0, distance.dot(covariance.ldlt().solve(distance))));
    sigmas_ = std::max(sigmas_, sigmas);
    Run& run = runs_[i];
    if (!(sigmas >= kMaxSigmas)) {
      run.count = 0;
      continue;
    }
    run.begin_ns = run.count == 0 ? now_ns : run.begin_ns;
    ++run.count;
    const bool lasts = run.count >= kLeastRun && SecondsBetween(run.begin_ns, now_ns) >= kLeastRunS;
    if (lasts && (!contradiction_ || sigmas > contradiction_->sigmas)) {
      contradiction_ = {distance.norm(), sigmas, SecondsBetween(std::prev(next)->stamp_ns, now_ns)};
    }
  }
}

}  // namespace alidade
