#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>
#include <vector>

#include "core/filter_config.h"
#include "core/lie.h"
#include "core/status.h"
#include "filter/prepared_rows.h"

namespace alidade {

/// Covariance kept as an upper-triangular factor, P = S S^T: symmetric and positive semi-definite by
/// construction, whatever is done to it. The error is ordered [leading blocks newest first, core (15), blocks
/// newest first, constants]. Upper triangularity makes a row depend on the noise of its own and later rows: a
/// leading block, a linear function of what follows it plus its own noise, is added without touching the
/// rest, and without leading blocks propagation and cloning touch a corner only. Storage is allocated once.
class SquareRootCovariance {
 public:
  static constexpr int kCore = 15;

  /// `capacity`: largest dimension; `max_leading` of it may be leading blocks. precision: of the products and
  /// factorisations of Prepare, Factor and Commit; what is kept is in double precision.
  explicit SquareRootCovariance(int capacity, int max_leading = 0,
                                UpdatePrecision precision = UpdatePrecision::kDouble);

  /// Restarts with the core block alone. kInput: not symmetric positive semi-definite to rounding.
  Status Reset(const Matrix15d& covariance);

  /// core <- phi core + noise_root n, n ~ N(0, I_15); cross terms follow.
  void Propagate(const Matrix15d& phi, const Matrix15d& noise_root);

  /// The six rows [first, first + 6) of a leading block <- phi times them + w, w ~ N(0, q).
  void PropagateLeading(int first, const Matrix6d& phi, const Matrix6d& q);

  /// Restarts with P = root root^T, whose first `leading` rows are a leading block. root: at least as many
  /// columns as rows.
  void Assign(int leading, const Eigen::Ref<const Eigen::MatrixXd>& root);

  /// Inserts a copy of the error rows [first, first + size) of the core block directly after the core block.
  void CloneCore(int first, int size);

  /// Appends constants with independent errors at the very end, where clones never come.
  void AddTrailing(const Eigen::Ref<const Eigen::VectorXd>& deviations);

  /// Rows [target, target + 6) += gain times the rows from `source` on, which lie behind them: one a column.
  void AddToRows(int target, const Eigen::Ref<const Eigen::Matrix<double, 6, Eigen::Dynamic>>& gain,
                 int source);

  /// Inserts a block f = gain x + root n at the very front; x: the core and all that follows it, n ~ N(0,
  /// I_3) independent of everything. root: upper triangular.
  void AddLeading(const Eigen::Matrix3d& root, const Eigen::Ref<const Eigen::MatrixXd>& gain);

  /// Rows [target, target + 3) of a leading block += m times the rows [source, source + 3), which lie behind
  /// the leading blocks.
  void AddToLeading(int target, const Eigen::Matrix3d& m, int source);

  /// Maps the error x to x + column (row . x).
  void Shear(const Eigen::Ref<const Eigen::VectorXd>& column, const Eigen::Ref<const Eigen::VectorXd>& row);

  /// Marginalises the rows [first, first + size), which lie outside the core block.
  void Remove(int first, int size);

  /// Kalman update with unit-noise rows H over the whole error (rows x dimension()) and innovation y =
  /// measured - predicted. Prepare computes A = H S, in place; rows may then be gated or re-weighted before
  /// Apply.
  ///
  /// The rows from `sparse_from` on are handled apart (both in Prepare and Apply): few of their entries are
  /// not zero, but these reach leading blocks, which the rows before need not pay for. -1: no such rows.
  [[nodiscard]] PreparedRows Prepare(Eigen::Ref<Eigen::MatrixXd> rows, Eigen::Ref<Eigen::VectorXd> innovation,
                                     int sparse_from = -1);
  /// y^T (A A^T + I)^-1 y of the rows [first, first + count) alone; NaN when one is not finite.
  [[nodiscard]] double NormalizedInnovationSquared(const PreparedRows& prepared, int first, int count,
                                                   double noise_variance = 1);
  /// With A A^T + noise_variance I = L L^T of the same rows: maps <- L^-1 maps, innovation = L^-1 y. False,
  /// with nothing written, when a number is not finite.
  [[nodiscard]] bool Whiten(const PreparedRows& prepared, int first, int count, double noise_variance,
                            Eigen::Ref<Eigen::MatrixXd> maps, Eigen::Ref<Eigen::VectorXd> innovation);
  /// M = I + A^T A = U^T U; S <- S U^-1; correction = S U^-T A^T y. nis (nullptr skips): y^T (A A^T + I)^-1
  /// y, the normalised innovation squared. log_det (nullptr skips): log det(A A^T + I) = log det M, so that
  /// -(nis + log_det + rows log 2 pi) / 2 is the rows' log-likelihood. False, with nothing changed, when a
  /// row is not finite, or so large that rounding leaves nothing of the identity in M.
  bool Apply(const PreparedRows& prepared, Eigen::Ref<Eigen::VectorXd> correction, double* nis,
             double* log_det = nullptr);

  /// The halves of Apply. Factor leaves S as it is; Solution then gives the correction S w, and the square of
  /// the norm of H times it; Commit updates S and gives the same correction. Each needs Factor directly
  /// before it.
  bool Factor(const PreparedRows& prepared, double* nis, double* log_det = nullptr);
  double Solution(Eigen::Ref<Eigen::VectorXd> correction);
  /// After Solution: w.
  [[nodiscard]] auto WhitenedSolution() const { return whitened_.head(dimension_); }
  /// After Solution: the square of the step S (w - from), in deviations of the covariance that Commit would
  /// leave.
  double SquaredStep(const Eigen::Ref<const Eigen::VectorXd>& from);
  void Commit(Eigen::Ref<Eigen::VectorXd> correction);

  /// Kalman update with unit-noise rows that see the errors [first, first + rows.cols()) alone, as Prepare
  /// and Apply. The work grows with their number times dimension() squared: for rows much fewer than the
  /// error. False when a row is not finite (nothing is changed), or when S and the rows are too
  /// far apart in size for double precision (S is spent). `constants`: the same rows over the last
  /// constants.cols() errors, where they see these too.
  bool UpdateByBlock(int first, const Eigen::Ref<const Eigen::MatrixXd>& rows,
                     const Eigen::Ref<const Eigen::VectorXd>& y, Eigen::Ref<Eigen::VectorXd> correction,
                     double* nis, const Eigen::Ref<const Eigen::MatrixXd>& constants = Eigen::MatrixXd());

  /// Whether the updates to come may be in single precision, where that was asked for at the beginning.
  void AllowSingle(bool allow) { single_allowed_ = allow; }

  [[nodiscard]] int dimension() const { return dimension_; }
  /// Rows before the core block.
  [[nodiscard]] int leading() const { return leading_; }
  [[nodiscard]] int capacity() const { return static_cast<int>(factor_.rows()); }
  /// The factor, dimension() x dimension(), upper triangular.
  [[nodiscard]] auto factor() const { return factor_.block(origin_, origin_, dimension_, dimension_); }
  [[nodiscard]] Matrix15d CoreCovariance() const;
  /// Covariance of the rows [row, row + 6) with [column, column + 6).
  [[nodiscard]] Matrix6d PoseBlock(int row, int column) const;
  /// Covariance of the rows [first, first + size).
  [[nodiscard]] Eigen::MatrixXd Block(int first, int size) const;
  /// The whole covariance; for tests and reports, not for a hot path.
  [[nodiscard]] Eigen::MatrixXd Covariance() const;
  [[nodiscard]] bool AllFinite() const;

 private:
  /// L of Whiten in gate_, L^-1 y in gated_.
  bool FactorInnovation(const PreparedRows& prepared, int first, int count, double noise_variance);
  [[nodiscard]] auto Part(Eigen::Index row, Eigen::Index col, Eigen::Index rows, Eigen::Index cols) {
    return factor_.block(origin_ + row, origin_ + col, rows, cols);
  }
  [[nodiscard]] const double* Data(int row, int col) const { return &factor_(origin_ + row, origin_ + col); }
  [[nodiscard]] double* Data(int row, int col) { return &factor_(origin_ + row, origin_ + col); }
  /// The rows [first, first + kSize) <- phi times them + w, w ~ N(0, noise_root noise_root^T).
  template <int kSize>
  void PropagateBlock(int first, const Eigen::Matrix<double, kSize, kSize>& phi,
                      const Eigen::Matrix<double, kSize, kSize>& noise_root);
  void RemoveLeading(int first, int size);
  void PrepareSparse(Eigen::Ref<Eigen::MatrixXd> rows_in_place);
  /// The first columns of A that are not zero, in the rows before `sparse_from` and in those from there on.
  struct SeenColumns {
    int dense;
    int sparse;
    int sparse_from;
    [[nodiscard]] int first() const { return std::min(dense, sparse); }
  };
  /// U of I + A^T A over the columns from seen.first() on, in the upper left of `information`. rows: A from
  /// that column on. False where it is not finite, not positive definite, or the diagonal of A^T A is larger
  /// than `largest`.
  template <typename Scalar>
  bool FactorInformation(const Scalar* rows, int lda, const SeenColumns& seen, int count, Scalar largest,
                         Eigen::Matrix<Scalar, -1, -1>* information);
  /// The same in single_information_, and in information_ what it gives.
  bool FactorInSingle(const Eigen::Ref<const Eigen::MatrixXd>& rows, const SeenColumns& seen);
  /// The last `active` columns of the rows, and the part of S from row and column `first` on, in single
  /// precision.
  Eigen::Ref<Eigen::MatrixXf> SingleRows(const Eigen::Ref<const Eigen::MatrixXd>& rows, Eigen::Index active);
  float* SingleFactor(int first);
  [[nodiscard]] bool UsesSingle() const { return precision_ == UpdatePrecision::kSingle && single_allowed_; }
  /// S <- S U^-1 for the columns from `first` on; overwrites U above its diagonal blocks.
  void DivideByInformationRoot(int first);

  int dimension_ = 0;
  int leading_ = 0;
  int max_leading_ = 0;
  int origin_ = 0;  ///< the factor's place in factor_: leading blocks grow towards the upper left
  Eigen::MatrixXd factor_;
  Eigen::MatrixXd information_;  // scratch of Apply
  Eigen::MatrixXd corner_;       // scratch of Propagate and CloneCore
  Eigen::VectorXd projected_;
  Eigen::VectorXd whitened_;                     // see WhitenedSolution; scratch of Shear
  Eigen::VectorXd step_;                         // scratch of SquaredStep
  int factored_ = 0;                             // first column of S that Factor's rows see
  std::vector<std::pair<int, double>> entries_;  // scratch of PrepareSparse: column and value
  std::vector<size_t> row_ends_;
  Eigen::VectorXd reflection_;
  UpdatePrecision precision_;
  bool single_allowed_ = true;
  bool in_single_ = false;  // whether U is in single_information_
  Eigen::MatrixXf single_factor_;
  Eigen::MatrixXf single_information_;
  Eigen::MatrixXf single_rows_;
  Eigen::MatrixXd gate_;  // scratch of FactorInnovation
  Eigen::VectorXd gated_;
};

}  // namespace alidade
