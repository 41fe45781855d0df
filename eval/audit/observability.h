#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/error_convention.h"
#include "core/time.h"
#include "filter/filter_observer.h"

namespace alidade {

/// A singular value counts as zero below this share of the largest one (see ObservabilityAudit for the
/// scaling): well above rounding, well below what a wrong linearisation leaks.
inline constexpr double kObservabilityTolerance = 1e-8;

/// The information of all updates up to a frame on the initial error.
struct ObservabilityRecord {
  TimeNs stamp_ns = 0;
  int rank = 0;               ///< of the stacked O = [H_k Phi_k,0] over the initial core error; at most 15
  double yaw_leak = 0;        ///< N^T (sum O^T O) N along yaw [1/rad^2]; zero for a correct filter
  double position_leak = 0;   ///< the same along the worst horizontal or vertical shift [1/m^2]
  double yaw_gain = 0;        ///< information about yaw when all other directions are unknown [1/rad^2]
  double null_angle_rad = 0;  ///< largest principal angle between the four weakest directions and theory
};

/// The four unobservable directions of visual-inertial odometry, as errors of `convention` at `nav`: yaw
/// about gravity (column 0) and the three global shifts (1-3); 15 x 4. In right-invariant errors this is the
/// first fifteen rows of the paper's eq. 4-9, whatever `nav`; the others are transformed at `nav`.
[[nodiscard]] Eigen::Matrix<double, 15, 4> UnobservableDirections(ErrorConvention convention,
                                                                  const NavState& nav);

/// Audits the Jacobians a filter really uses. Every clone's error is kept as a map of the initial core error
/// (that of the frame it was cloned at); rows of updates, whitened, become rows of O over the initial error.
/// Landmarks in the state are unknowns of their own and are eliminated when they leave. O is kept as its
/// triangular factor, so that nothing is squared.
///
/// The receiver clock is an unknown of every GNSS epoch anew: what ties the clocks of two epochs is left out,
/// so that rank owes nothing to it. Once aligned, rank 15 is right and the leaks are information.
///
/// Rank and angle are of the factor with its columns scaled: column j by the root sum of squares of
/// (|H| |Phi|)_j, which no cancellation shrinks, so that a value of rounding size is rounding. The
/// propagation of noise plays no role in O: it shows what is observable, not how well.
class ObservabilityAudit : public FilterObserver {
 public:
  void OnReset(const FilterState& state) override;
  void OnPropagate(const Matrix15d& phi, const Matrix15d& q) override;
  void OnClone(int first, int size) override;
  void OnAddLandmark(int first, const Eigen::MatrixXd& rows) override;
  void OnAddToLandmark(int landmark, const Eigen::Matrix3d& m, int source) override;
  void OnRemove(int first, int size) override;
  void OnAlign(const Eigen::MatrixXd& turn, bool has_clock) override;
  void OnShear(const Eigen::VectorXd& column, const Eigen::VectorXd& row) override;
  void OnUpdate(const FilterState& state, const FilterRows& rows) override;
  void OnFrame(const FilterState& state) override;

  /// One a frame.
  [[nodiscard]] const std::vector<ObservabilityRecord>& records() const { return records_; }
  /// Upper triangular R with R^T R = sum O^T O over the initial core error, landmarks eliminated.
  [[nodiscard]] Matrix15d Factor() const { return factor_.bottomRightCorner<15, 15>(); }
  /// Singular values of the scaled factor over the largest, descending.
  [[nodiscard]] Vector15d RelativeSingularValues() const;
  [[nodiscard]] const Eigen::Matrix<double, 15, 4>& theory() const { return theory_; }

 private:
  void AddRows(const Eigen::MatrixXd& jacobian);
  void InsertRows(int first, int size);
  void EliminateLandmark(size_t index);
  [[nodiscard]] Vector15d ColumnScale() const;
  [[nodiscard]] double YawGain(const Vector15d& scale) const;

  Eigen::Matrix<double, 15, 4> theory_ = Eigen::Matrix<double, 15, 4>::Zero();
  Eigen::MatrixXd map_;     ///< error now = map_ * initial core error; zero rows for landmarks and clock
  int core_ = 0;            ///< first row of the core
  bool has_clock_ = false;  ///< in the six rows before the core
  std::vector<int> landmark_firsts_;  ///< rows of the landmarks, in the order of factor_'s columns
  Eigen::MatrixXd factor_;            ///< over [landmarks | initial core error]
  Vector15d scale_squared_ = Vector15d::Zero();
  std::vector<ObservabilityRecord> records_;
};

}  // namespace alidade
