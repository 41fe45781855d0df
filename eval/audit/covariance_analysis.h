#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "core/time.h"
#include "filter/filter_observer.h"

namespace alidade {

/// Covariance of the newest pose that a filter reports against that of its error, after one frame.
struct CovarianceRecord {
  TimeNs stamp_ns = 0;
  double nees_ratio = 0;  ///< tr(P^-1 Sigma) / 6: mean pose NEES over its ideal; 1 is consistent
  double position_m = 0;  ///< root mean square error of position: sqrt(tr Sigma), canonical chart
  double orientation_rad = 0;
};

/// Linear covariance analysis of a filter at work: beside the covariance P that the filter reports, the
/// covariance Sigma of the error that its gains really leave,
///
///   e+ = (I - K H) e - K V n,     K = P H^T (H P H^T + I)^-1,
///
/// where V n is the noise of the rows traced back to the observations. An observation that serves again
/// correlates e with n: the cross-covariance with the noise of every base still in the window is kept
/// (consider states that are never estimated). Everything else about the model is taken as right, so on data
/// without noise, at true states, the ratio shows the double counting alone.
///
/// Of a track's observations its base alone may serve again; another that does is counted in
/// `unmodelled_reuse`. Landmarks in the state are not modelled: the analysis ends where the first one enters.
class CovarianceAnalysis : public FilterObserver {
 public:
  void OnReset(const FilterState& state) override;
  void OnPropagate(const Matrix15d& phi, const Matrix15d& q) override;
  void OnClone(int first, int size) override;
  void OnAddLandmark(int first, const Eigen::MatrixXd& rows) override;
  void OnRemove(int first, int size) override;
  void OnShear(const Eigen::VectorXd& column, const Eigen::VectorXd& row) override;
  void OnUpdate(const FilterState& state, const FilterRows& rows) override;
  void OnFrame(const FilterState& state) override;

  /// One a frame.
  [[nodiscard]] const std::vector<CovarianceRecord>& records() const { return records_; }
  /// Covariance of the actual error, in the order and convention of the filter's.
  [[nodiscard]] const Eigen::MatrixXd& actual() const { return actual_; }
  [[nodiscard]] int unmodelled_reuse() const { return unmodelled_reuse_; }
  [[nodiscard]] bool met_landmark() const { return met_landmark_; }

 private:
  /// A base observation whose noise may enter again; its two columns of cross_ follow its index.
  struct KeptNoise {
    std::int64_t track_id = 0;
    int serial = 0;
  };
  /// Column pair of a kept observation, or -1.
  [[nodiscard]] int FindKept(std::int64_t track_id, int serial) const;
  void Transform(const Eigen::MatrixXd& map);
  void KeepBases(const Eigen::MatrixXd& gain, const FilterRows& rows);

  Eigen::MatrixXd actual_;  ///< Sigma
  Eigen::MatrixXd cross_;   ///< E[e n^T], dimension x 2 kept_.size()
  std::vector<KeptNoise> kept_;
  std::set<std::pair<std::int64_t, int>> used_;  ///< (track, serial) of clones in the window
  int unmodelled_reuse_ = 0;
  bool met_landmark_ = false;
  std::vector<CovarianceRecord> records_;
};

}  // namespace alidade
