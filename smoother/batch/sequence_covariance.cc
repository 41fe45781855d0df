#include "smoother/batch/sequence_covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "smoother/batch/sequence_order.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Indices = std::vector<Index>;

constexpr Index kState = kStateColumns;
constexpr Index kPoint = kLandmarkColumns;
/// A landmark seen once has no depth, which leaves its front singular. Information [m^2] on its inverse
/// depth: a standard deviation of 1000 per metre is no information.
constexpr double kNoDepthInformation = 1e-6;

/// Joint information of the landmarks in sight, then what is the frame's own: clock and state.
struct Front {
  std::vector<int> landmarks;  ///< in the order of their columns
  MatrixXd hessian;            ///< lower triangle
  VectorXd gradient;

  [[nodiscard]] Index own() const { return kPoint * static_cast<Index>(landmarks.size()); }
};

/// What one elimination leaves behind for the way back.
struct Elimination {
  Indices eliminated;  ///< columns of the front
  Indices kept;        ///< columns of the front that live on in the next one, same order
  MatrixXd gain;       ///< G, (kept + the next frame's own) x eliminated
  MatrixXd inverse;    ///< A_EE^-1
};

/// Block of the symmetric matrix whose lower triangle is given.
MatrixXd Gather(const MatrixXd& hessian, const Indices& rows, const Indices& columns) {
  MatrixXd block(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  for (size_t j = 0; j < columns.size(); ++j) {
    for (size_t i = 0; i < rows.size(); ++i) {
      block(static_cast<Index>(i), static_cast<Index>(j)) =
          hessian(std::max(rows[i], columns[j]), std::min(rows[i], columns[j]));
    }
  }
  return block;
}

class SequenceFactorization {
 public:
  SequenceFactorization(const SequenceProblem& problem, bool with_covariance, bool with_filtered)
      : problem_(problem),
        order_(problem),
        with_covariance_(with_covariance),
        with_filtered_(with_filtered) {}

  Result<SequenceCovariance> Execute() {
    for (size_t k = 0; k < problem_.frames.size(); ++k) {
      if (k == 0) {
        Begin();
      } else {
        ALIDADE_RETURN_IF_ERROR(Advance(k));
      }
      ALIDADE_RETURN_IF_ERROR(AddMeasurements(k));
      if (with_filtered_) {
        ALIDADE_RETURN_IF_ERROR(AddFilteredCovariance(k));
      }
    }
    MatrixXd covariance;
    ALIDADE_RETURN_IF_ERROR(InvertLast(&covariance));
    if (with_covariance_) {
      GoBack(std::move(covariance));
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] Status Singular(size_t frame) const {
    return Status::Diverged("batch: information at " + FormatSeconds(problem_.frames[frame]->stamp_ns) +
                            " s is not positive definite");
  }

  /// Columns of a frame's own: its clock in an aligned sequence, its state.
  void AddOwn(size_t k, ColumnMap* columns) const {
    if (problem_.frames[k]->clock) {
      columns->AddClock(static_cast<int>(k));
    }
    columns->AddState(static_cast<int>(k));
  }
  [[nodiscard]] Index OwnSize(size_t k) const {
    ColumnMap columns;
    AddOwn(k, &columns);
    return columns.size();
  }

  static Status Add(const std::vector<const WindowTerm*>& terms, const ColumnMap& columns, MatrixXd* hessian,
                    VectorXd* gradient) {
    LinearTerm linear;
    for (const WindowTerm* term : terms) {
      ALIDADE_RETURN_IF_ERROR(term->Linearize(&linear));
      linear.AddTo(columns, hessian, gradient);
    }
    return Status::Ok();
  }

  void Begin() {
    front_.hessian = MatrixXd::Zero(OwnSize(0), OwnSize(0));
    front_.gradient = VectorXd::Zero(OwnSize(0));
  }

  /// From the front of frame k-1 to that of frame k, without frame k's own measurements.
  Status Advance(size_t k) {
    Elimination step;
    const std::vector<int> survivors = Split(k - 1, &step);
    const Index kept = static_cast<Index>(step.kept.size());
    ColumnMap both;
    AddOwn(k - 1, &both);
    const Index before = both.size();
    AddOwn(k, &both);
    const Index own = both.size() - before;
    MatrixXd link = MatrixXd::Zero(both.size(), both.size());
    VectorXd link_gradient = VectorXd::Zero(both.size());
    ALIDADE_RETURN_IF_ERROR(Add(order_.between[k], both, &link, &link_gradient));

    MatrixXd eliminated = Gather(front_.hessian, step.eliminated, step.eliminated);
    eliminated.topLeftCorner(before, before) += link.topLeftCorner(before, before);
    const Eigen::LLT<MatrixXd> factor(eliminated);
    if (factor.info() != Eigen::Success || !eliminated.allFinite()) {
      return Singular(k - 1);
    }
    VectorXd gradient = front_.gradient(step.eliminated);
    gradient.head(before) += link_gradient.head(before);
    const Index size = kept + own;
    MatrixXd coupling = MatrixXd::Zero(size, eliminated.rows());
    coupling.topRows(kept) = Gather(front_.hessian, step.kept, step.eliminated);
    coupling.bottomLeftCorner(own, before) = link.bottomLeftCorner(own, before);

    Front next;
    next.landmarks = survivors;
    next.hessian.resize(size, size);
    next.hessian.topLeftCorner(kept, kept) = Gather(front_.hessian, step.kept, step.kept);
    next.hessian.bottomLeftCorner(own, kept).setZero();
    next.hessian.bottomRightCorner(own, own) = link.bottomRightCorner(own, own);
    next.gradient.resize(size);
    next.gradient << front_.gradient(step.kept), link_gradient.tail(own);
    // Rows U = coupling L^-T: A_SS - U U^T.
    const MatrixXd scaled = factor.matrixL().solve(coupling.transpose());
    const VectorXd y = factor.matrixL().solve(gradient);
    next.hessian.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose(), -1);
    next.gradient.noalias() -= scaled.transpose() * y;
    result_.newton_decrement += y.squaredNorm();
    front_ = std::move(next);
    if (with_covariance_) {
      step.gain = factor.matrixU().solve(scaled).transpose();
      step.inverse = factor.solve(MatrixXd::Identity(eliminated.rows(), eliminated.rows()));
      eliminations_.push_back(std::move(step));
    }
    return Status::Ok();
  }

  /// Columns of the front that go and that stay after frame k, the frame's own first to go. Returns the
  /// landmarks that stay.
  std::vector<int> Split(size_t k, Elimination* step) const {
    std::vector<int> survivors;
    for (Index i = front_.own(); i < front_.hessian.rows(); ++i) {
      step->eliminated.push_back(i);
    }
    for (size_t slot = 0; slot < front_.landmarks.size(); ++slot) {
      const int landmark = front_.landmarks[slot];
      const bool ended = order_.last_frame[static_cast<size_t>(landmark)] == static_cast<int>(k);
      for (Index i = 0; i < kPoint; ++i) {
        (ended ? step->eliminated : step->kept).push_back(kPoint * static_cast<Index>(slot) + i);
      }
      if (!ended) {
        survivors.push_back(landmark);
      }
    }
    return survivors;
  }

  /// Makes room for the landmarks that begin in frame k, between the others and the frame's own.
  void OpenLandmarks(size_t k) {
    const Index before = front_.own();
    const Index own = front_.hessian.rows() - before;
    const Index added = kPoint * static_cast<Index>(order_.begins[k].size());
    if (added == 0) {
      return;
    }
    MatrixXd hessian = MatrixXd::Zero(before + added + own, before + added + own);
    hessian.topLeftCorner(before, before) = front_.hessian.topLeftCorner(before, before);
    hessian.bottomLeftCorner(own, before) = front_.hessian.bottomLeftCorner(own, before);
    hessian.bottomRightCorner(own, own) = front_.hessian.bottomRightCorner(own, own);
    VectorXd gradient(before + added + own);
    gradient << front_.gradient.head(before), VectorXd::Zero(added), front_.gradient.tail(own);
    front_.hessian = std::move(hessian);
    front_.gradient = std::move(gradient);
    front_.landmarks.insert(front_.landmarks.end(), order_.begins[k].begin(), order_.begins[k].end());
  }

  Status AddMeasurements(size_t k) {
    OpenLandmarks(k);
    ColumnMap columns;
    for (const int landmark : front_.landmarks) {
      columns.AddLandmark(landmark);
    }
    AddOwn(k, &columns);
    return Add(order_.at[k], columns, &front_.hessian, &front_.gradient);
  }

  Status AddFilteredCovariance(size_t k) {
    MatrixXd hessian = front_.hessian;
    for (Index depth = kPoint - 1; depth < front_.own(); depth += kPoint) {
      hessian(depth, depth) += kNoDepthInformation;
    }
    const Eigen::LLT<Eigen::Ref<MatrixXd>> factor(hessian);
    if (factor.info() != Eigen::Success) {
      return Singular(k);
    }
    const Matrix15d corner = hessian.bottomRightCorner<kState, kState>().triangularView<Eigen::Lower>();
    const Matrix15d inverse = corner.triangularView<Eigen::Lower>().solve(Matrix15d::Identity());
    result_.filtered.push_back(inverse.transpose() * inverse);
    return Status::Ok();
  }

  Status InvertLast(MatrixXd* covariance) {
    const Eigen::LLT<MatrixXd> factor(front_.hessian);
    if (factor.info() != Eigen::Success || !front_.gradient.allFinite()) {
      return Singular(problem_.frames.size() - 1);
    }
    result_.newton_decrement += factor.matrixL().solve(front_.gradient).squaredNorm();
    *covariance = factor.solve(MatrixXd::Identity(front_.hessian.rows(), front_.hessian.rows()));
    return Status::Ok();
  }

  void GoBack(MatrixXd covariance) {
    result_.smoothed.resize(problem_.frames.size());
    result_.smoothed.back() = covariance.bottomRightCorner<kState, kState>();
    for (size_t k = eliminations_.size(); k-- > 0;) {
      Elimination& step = eliminations_[k];
      // Of the later front: the landmarks that came from this one, and its own.
      const Index kept = static_cast<Index>(step.kept.size());
      const Index own_later = OwnSize(k + 1);
      const Index later = covariance.rows() - own_later;
      MatrixXd common(kept + own_later, kept + own_later);
      common.topLeftCorner(kept, kept) = covariance.topLeftCorner(kept, kept);
      common.bottomLeftCorner(own_later, kept) = covariance.block(later, 0, own_later, kept);
      common.topRightCorner(kept, own_later) = covariance.block(0, later, kept, own_later);
      common.bottomRightCorner(own_later, own_later) = covariance.bottomRightCorner(own_later, own_later);
      const MatrixXd cross = -common * step.gain;
      const MatrixXd own = step.inverse - step.gain.transpose() * cross;
      const Index size = kept + own.rows();
      covariance.resize(size, size);
      covariance(step.kept, step.kept) = common.topLeftCorner(kept, kept);
      covariance(step.kept, step.eliminated) = cross.topRows(kept);
      covariance(step.eliminated, step.kept) = cross.topRows(kept).transpose();
      covariance(step.eliminated, step.eliminated) = 0.5 * (own + own.transpose());
      result_.smoothed[k] = covariance.bottomRightCorner<kState, kState>();
      step = {};  // the memory is wanted back
    }
  }

  const SequenceProblem& problem_;
  SequenceOrder order_;
  bool with_covariance_, with_filtered_;
  Front front_;
  std::vector<Elimination> eliminations_;  ///< from frame k to k+1
  SequenceCovariance result_;
};

}  // namespace

Result<SequenceCovariance> ComputeSequenceCovariance(const SequenceProblem& problem, bool with_covariance,
                                                     bool with_filtered) {
  return SequenceFactorization(problem, with_covariance, with_filtered).Execute();
}

}  // namespace alidade
