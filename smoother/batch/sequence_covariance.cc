#include "smoother/batch/sequence_covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

#include "smoother/factors/imu_factor.h"
#include "smoother/solve/frame_rows.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Indices = std::vector<Index>;

constexpr Index kState = 15;
constexpr Index kPoint = 3;
/// A landmark seen once has no depth, which leaves its front singular. Information [m^2] on its inverse
/// depth: a standard deviation of 1000 per metre says nothing.
constexpr double kNoDepthInformation = 1e-6;

/// Joint information of the landmarks in sight, then the state.
struct Front {
  std::vector<size_t> tracks;  ///< in the order of their columns
  MatrixXd hessian;            ///< lower triangle
  VectorXd gradient;

  [[nodiscard]] Index state() const { return kPoint * static_cast<Index>(tracks.size()); }
};

/// What one elimination leaves behind for the way back.
struct Elimination {
  Indices eliminated;  ///< columns of the front
  Indices kept;        ///< columns of the front that live on in the next one, same order
  MatrixXd gain;       ///< G, (kept + the next state) x eliminated
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
      : problem_(problem), with_covariance_(with_covariance), with_filtered_(with_filtered) {
    for (const std::unique_ptr<WindowFrame>& frame : problem.frames) {
      geometry_.push_back(MakeGeometry(frame->nav_state(), problem.T_BC));
    }
    begins_.resize(problem.frames.size());
    views_.resize(problem.frames.size());
    for (size_t t = 0; t < problem.tracks.size(); ++t) {
      const std::vector<WindowView>& views = problem.tracks[t]->views;
      begins_[IndexOf(views.front())].push_back(t);
      for (size_t v = 0; v < views.size(); ++v) {
        views_[IndexOf(views[v])].push_back({t, v});
      }
    }
  }

  Result<SequenceCovariance> Execute() {
    AddPrior();
    for (size_t k = 0; k < problem_.frames.size(); ++k) {
      if (k > 0) {
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
  struct View {
    size_t track, view;
  };
  static size_t IndexOf(const WindowView& view) { return static_cast<size_t>(view.frame->index); }

  [[nodiscard]] Status Singular(size_t frame) const {
    return Status::Diverged("batch: information at " + FormatSeconds(problem_.frames[frame]->stamp_ns) +
                            " s is not positive definite");
  }

  void AddPrior() {
    const WindowFrame& first = *problem_.frames.front();
    Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor> nav(problem_.prior->residual.size(), 9);
    Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor> bias(problem_.prior->residual.size(), 6);
    VectorXd residual(problem_.prior->residual.size());
    const std::array<const double*, 2> parameters = {first.nav.data(), first.bias.data()};
    const std::array<double*, 2> jacobians = {nav.data(), bias.data()};
    PriorFactor(problem_.prior).Evaluate(parameters.data(), residual.data(), jacobians.data());
    MatrixXd jacobian(residual.size(), kState);
    jacobian << nav, bias;
    front_.hessian = jacobian.transpose() * jacobian;
    front_.gradient = jacobian.transpose() * residual;
  }

  /// From the front of frame k-1 to that of frame k, without frame k's own measurements.
  Status Advance(size_t k) {
    Elimination step;
    const std::vector<size_t> survivors = Split(k - 1, &step);
    const Index kept = static_cast<Index>(step.kept.size());
    const Index size = kept + kState;
    const ImuRows imu = LinearizeImu(*problem_.frames[k - 1], *problem_.frames[k], problem_.gravity_W);
    MatrixXd eliminated = Gather(front_.hessian, step.eliminated, step.eliminated);
    eliminated.topLeftCorner<kState, kState>() += imu.first.transpose() * imu.first;
    const Eigen::LLT<MatrixXd> factor(eliminated);
    if (factor.info() != Eigen::Success || !eliminated.allFinite()) {
      return Singular(k - 1);
    }
    VectorXd gradient = front_.gradient(step.eliminated);
    gradient.head<kState>() += imu.first.transpose() * imu.residual;
    MatrixXd coupling = MatrixXd::Zero(size, eliminated.rows());
    coupling.topRows(kept) = Gather(front_.hessian, step.kept, step.eliminated);
    coupling.bottomLeftCorner<kState, kState>() = imu.second.transpose() * imu.first;

    Front next;
    next.tracks = survivors;
    next.hessian.resize(size, size);
    next.hessian.topLeftCorner(kept, kept) = Gather(front_.hessian, step.kept, step.kept);
    next.hessian.bottomLeftCorner(kState, kept).setZero();
    next.hessian.bottomRightCorner<kState, kState>() = imu.second.transpose() * imu.second;
    next.gradient.resize(size);
    next.gradient << front_.gradient(step.kept), imu.second.transpose() * imu.residual;
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

  /// Columns of the front that go and that stay after frame k, the state first to go. Returns the tracks that
  /// stay.
  std::vector<size_t> Split(size_t k, Elimination* step) const {
    std::vector<size_t> survivors;
    for (Index i = 0; i < kState; ++i) {
      step->eliminated.push_back(front_.state() + i);
    }
    for (size_t slot = 0; slot < front_.tracks.size(); ++slot) {
      const bool ended = IndexOf(problem_.tracks[front_.tracks[slot]]->views.back()) == k;
      for (Index i = 0; i < kPoint; ++i) {
        (ended ? step->eliminated : step->kept).push_back(kPoint * static_cast<Index>(slot) + i);
      }
      if (!ended) {
        survivors.push_back(front_.tracks[slot]);
      }
    }
    return survivors;
  }

  /// Makes room for the tracks that begin in frame k, between the other landmarks and the state.
  void OpenTracks(size_t k) {
    const Index before = front_.state();
    const Index added = kPoint * static_cast<Index>(begins_[k].size());
    if (added == 0) {
      return;
    }
    MatrixXd hessian = MatrixXd::Zero(before + added + kState, before + added + kState);
    hessian.topLeftCorner(before, before) = front_.hessian.topLeftCorner(before, before);
    hessian.bottomLeftCorner(kState, before) = front_.hessian.bottomLeftCorner(kState, before);
    hessian.bottomRightCorner<kState, kState>() = front_.hessian.bottomRightCorner<kState, kState>();
    VectorXd gradient(before + added + kState);
    gradient << front_.gradient.head(before), VectorXd::Zero(added), front_.gradient.tail<kState>();
    front_.hessian = std::move(hessian);
    front_.gradient = std::move(gradient);
    front_.tracks.insert(front_.tracks.end(), begins_[k].begin(), begins_[k].end());
  }

  Status AddMeasurements(size_t k) {
    OpenTracks(k);
    const WindowFrame& frame = *problem_.frames[k];
    const Index state = front_.state();
    if (frame.rest) {
      RestModel::Jacobian jacobian;
      Vector6d residual;
      frame.rest->Evaluate(frame.nav_state(), frame.imu_bias(), &residual, &jacobian);
      front_.hessian.bottomRightCorner<kState, kState>() += jacobian.transpose() * jacobian;
      front_.gradient.tail<kState>() += jacobian.transpose() * residual;
    }
    for (const View& view : views_[k]) {
      const WindowTrack& track = *problem_.tracks[view.track];
      const Index point = ColumnOf(view.track);
      ViewRows rows;
      if (!LinearizeView(geometry_[IndexOf(track.views.front())], geometry_[k],
                         track.views[view.view].observation, problem_.kernel, track.landmark, &rows)) {
        return Status::Diverged("batch: track " + std::to_string(track.id) + " lies behind the camera at " +
                                FormatSeconds(frame.stamp_ns) + " s");
      }
      MatrixXd& h = front_.hessian;
      h.block<6, 6>(state, state).noalias() += rows.weight * rows.pose.transpose() * rows.pose;
      h.block<6, 3>(state, point).noalias() += rows.weight * rows.pose.transpose() * rows.landmark;
      h.block<3, 3>(point, point).noalias() += rows.weight * rows.landmark.transpose() * rows.landmark;
      front_.gradient.segment<6>(state).noalias() += rows.weight * rows.pose.transpose() * rows.residual;
      front_.gradient.segment<3>(point).noalias() += rows.weight * rows.landmark.transpose() * rows.residual;
    }
    return Status::Ok();
  }

  /// Tracks enter the front in ascending order and keep it.
  [[nodiscard]] Index ColumnOf(size_t track) const {
    const auto found = std::find(front_.tracks.begin(), front_.tracks.end(), track);
    return kPoint * static_cast<Index>(found - front_.tracks.begin());
  }

  Status AddFilteredCovariance(size_t k) {
    MatrixXd hessian = front_.hessian;
    for (Index depth = kPoint - 1; depth < front_.state(); depth += kPoint) {
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
      // Of the later front: the landmarks that came from this one, and its state.
      const Index kept = static_cast<Index>(step.kept.size());
      const Index later = covariance.rows() - kState;
      MatrixXd common(kept + kState, kept + kState);
      common.topLeftCorner(kept, kept) = covariance.topLeftCorner(kept, kept);
      common.bottomLeftCorner(kState, kept) = covariance.block(later, 0, kState, kept);
      common.topRightCorner(kept, kState) = covariance.block(0, later, kept, kState);
      common.bottomRightCorner<kState, kState>() = covariance.bottomRightCorner<kState, kState>();
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
  bool with_covariance_, with_filtered_;
  std::vector<FrameGeometry> geometry_;
  std::vector<std::vector<size_t>> begins_;  ///< tracks by the frame of their first view
  std::vector<std::vector<View>> views_;     ///< observations by frame
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
