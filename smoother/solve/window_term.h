#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/status.h"
#include "smoother/factors/reduced_cost.h"
#include "smoother/window/column_map.h"

namespace alidade {

class WindowProblem;

/// The columns of one unknown among those of a term.
struct TermPart {
  Unknown of;
  Eigen::Index first = 0;
  Eigen::Index width = 0;  ///< the leading coordinates of the unknown
};

/// A term linearised at the present states: whitened rows |r + J x|^2, or, where landmarks have been
/// eliminated, normal equations.
struct LinearTerm {
  /// What the columns of a frame are over.
  enum class Chart {
    kCanonical,
    kPrior,  ///< the errors that a LinearPrior is over: rows of a prior, which keep their Jacobian
  };
  Chart chart = Chart::kCanonical;
  std::vector<TermPart> parts;
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd residual;
  Eigen::MatrixXd hessian;   ///< lower triangle; empty where rows are given
  Eigen::VectorXd gradient;  ///< with hessian

  /// Rows of these parts, zero, over the canonical chart.
  void ResizeRows(const std::vector<TermPart>& of, Eigen::Index rows);
  /// Normal equations of these parts.
  void SetInformation(const std::vector<TermPart>& of, NormalEquations equations);
  /// Replaces normal equations by rows of a square root (SquareRootRows).
  void MakeRows();
  /// Adds its information to normal equations over `columns`, of which lower triangles count. Its entries
  /// of coordinates that have no columns must be zero.
  void AddTo(const ColumnMap& columns, Eigen::MatrixXd* hessian, Eigen::VectorXd* gradient) const;
};

/// Information about some of a window's unknowns that can be linearised: all that marginalisation needs.
class InformationTerm {
 public:
  virtual ~InformationTerm() = default;

  /// The unknowns that it concerns.
  [[nodiscard]] const std::vector<TermPart>& parts() const { return parts_; }
  /// At the present states; Jacobians at first estimates where frames have such. kDiverged: undefined there.
  virtual Status Linearize(LinearTerm* linear) const = 0;

 protected:
  InformationTerm() = default;
  /// Columns after those there are; none for a width of 0.
  void AddPart(const Unknown& of, Eigen::Index width);
  [[nodiscard]] Eigen::Index columns() const;

 private:
  std::vector<TermPart> parts_;
};

/// One term of a window's least squares: the information of a sensor, a track or the prior about some of the
/// unknowns. It is put into Ceres, counted in the covariance, marginalised with its oldest frame and solved
/// in the batch through this interface alone. A sensor is a factor (smoother/manifold/lifted_cost.h) and the
/// line of AddSensorTerms (smoother/solve/sensor_terms.h) that makes a FactorTerm of it.
class WindowTerm : public InformationTerm {
 public:
  /// Adds its residual block; the term must outlive the problem.
  virtual void AddTo(WindowProblem* problem) = 0;
};

using WindowTerms = std::vector<std::unique_ptr<WindowTerm>>;

}  // namespace alidade
