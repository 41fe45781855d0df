#pragma once

#include <vector>

#include "core/check.h"
#include "core/filter_config.h"
#include "core/landmark_solver.h"
#include "core/scene_depth.h"
#include "core/vision_config.h"
#include "filter/filter_state.h"
#include "filter/track_memory.h"
#include "filter/track_store.h"

namespace alidade {

/// How one track fared in an update.
enum class TrackOutcome {
  kReady,       ///< linearised, rows appended
  kWaiting,     ///< parallax too small yet
  kDegenerate,  ///< behind a camera, out of the depth range, or no parallax at all
};

/// Turns tracks into whitened, landmark-free rows over the filter's error: depth by the configured strategy,
/// linearisation, elimination to 2N-3 rows (core/landmark_reduction.h), chained through extrinsics and error
/// convention.
class FeatureUpdate {
 public:
  /// calibration_size: of the state's CalibrationLayout.
  FeatureUpdate(const FilterConfig& filter, const VisionConfig& vision, int max_clones,
                int calibration_size = 0);

  /// Whether traces() is kept.
  void SetTracing(bool tracing) { tracing_ = tracing; }
  void Begin(const FilterState& state);
  /// Appends the rows of a track that all of its views define, when its depth is known to the given relative
  /// standard deviation, VisionConfig's without one.
  TrackOutcome Append(const FilterState& state, const Track& track) {
    return Append(state, track, vision_.max_relative_depth_deviation);
  }
  TrackOutcome Append(const FilterState& state, const Track& track, double max_depth_deviation) {
    return AppendViews(state, track, {.max_depth_deviation = max_depth_deviation});
  }
  /// The same when its depth is known well enough for a memory to start.
  TrackOutcome AppendToRemember(const FilterState& state, const Track& track);
  /// The same for a track that becomes a SLAM feature: linearised at the Gauss-Newton solution, with the
  /// three remaining rows in `landmark_rows`. kWaiting, with nothing appended, while its depth is not known
  /// to slam_max_depth_deviation and, where tracks are remembered, well enough for a memory to start.
  TrackOutcome AppendLandmark(const FilterState& state, const Track& track, LandmarkRows* landmark_rows) {
    return AppendViews(state, track,
                       {.max_depth_deviation = filter_.slam_max_depth_deviation,
                        .to_remember = filter_.track_memory != TrackMemoryPolicy::kNone,
                        .landmark_rows = landmark_rows});
  }
  /// Of a track whose outcome was kDegenerate: FindOutliersOfConsensus.
  bool FindOutliers(const FilterState& state, const Track& track, std::vector<int>* outlying);
  /// How the noise of the observations enters the rows of a block that all views of `track` defined: 2N - 3 x
  /// 2N, over the whitened observations. Valid until the next track is linearised.
  [[nodiscard]] Eigen::Ref<Eigen::MatrixXd> NoiseMaps(const FilterState& state, const Track& track,
                                                      size_t block);
  /// Appends the two rows that the newest view of a remembered track adds.
  TrackOutcome AppendRemembered(const FilterState& state, const Track& track);

  /// Rows of one appended track.
  struct Block {
    int first = 0;
    int rows = 0;
  };
  /// The trace of the block just added, when it holds the two whitened rows of a track's newest observation.
  void TraceNewestObservation(const Track& track) {
    if (tracing_) {
      traces_.push_back(
          {blocks_.back().first, 2, track.id, {track.views.back().serial}, Eigen::Matrix2d::Identity()});
    }
  }
  /// Appends `rows` zero rows, for the caller to fill, and an empty successor.
  Block AddBlock(int rows);
  [[nodiscard]] const std::vector<Block>& blocks() const { return blocks_; }
  /// One a block, when tracing.
  [[nodiscard]] const std::vector<TracedBlock>& traces() const { return traces_; }
  /// What the track of a block keeps once its rows were applied with the given robust weight; call before
  /// the state is corrected. `nis`: normalised innovation squared of the rows. A memory ends when its point
  /// does not stand still (TrackMemory::Drifts).
  void Remember(const FilterState& state, size_t block, double weight, double nis, Track* track);
  [[nodiscard]] const TrackMemoryKeeper& keeper() const { return keeper_; }
  /// Of the tracks that all their views define, while it is learnt.
  [[nodiscard]] const SceneDepth& scene_depth() const { return scene_depth_; }
  void LearnSceneDepth(bool learn) { learn_scene_depth_ = learn; }
  void ForgetSceneDepth() { scene_depth_.Clear(); }
  [[nodiscard]] int rows() const { return rows_; }
  /// rows() x error dimension; H of y = H xi + n, n ~ N(0, I). Until Prepare.
  [[nodiscard]] Eigen::Ref<Eigen::MatrixXd> jacobian() {
    CHECK(!prepared_) << "the rows are prepared";
    return jacobian_.topLeftCorner(rows_, dimension_);
  }
  /// y = measured - predicted. Until Prepare.
  [[nodiscard]] Eigen::Ref<Eigen::VectorXd> innovation() {
    CHECK(!prepared_) << "the rows are prepared";
    return innovation_.head(rows_);
  }
  /// Hands the rows over to be applied; those from `sparse_from` on are of landmarks of the state.
  [[nodiscard]] PreparedRows Prepare(int sparse_from, SquareRootCovariance* covariance) {
    PreparedRows prepared = covariance->Prepare(jacobian(), innovation(), sparse_from);
    prepared_ = true;
    return prepared;
  }

 private:
  bool GatherViews(const FilterState& state, const Track& track);
  struct Purpose {
    double max_depth_deviation = 0;  ///< relative
    bool to_remember = false;
    LandmarkRows* landmark_rows = nullptr;  ///< of a SLAM feature
  };
  TrackOutcome AppendViews(const FilterState& state, const Track& track, const Purpose& purpose);
  /// The depth needs a relative deviation below the given one.
  TrackOutcome Triangulate(double max_relative_deviation, bool refine, Eigen::Vector3d* p_W) const;
  /// Linearises every view at p_W, in the scratch of the track. False behind one of them.
  bool Linearize(const FilterState& state, const Eigen::Vector3d& p_W);
  /// The three rows that elimination left over.
  void RetainRows(const FilterState& state, const Track& track, const Eigen::Vector3d& p_W,
                  LandmarkRows* rows) const;
  void Reserve(int additional_rows);
  /// Of the track at hand: six a view and the calibration's.
  [[nodiscard]] Eigen::Index StateColumns() const {
    return 6 * static_cast<Eigen::Index>(clones_.size()) + calibration_;
  }
  /// The trace of the block that Append just added; `noise` holds its 2N - 3 rows.
  void Trace(const Track& track, const Eigen::Ref<const Eigen::MatrixXd>& noise);
  /// What the block that Append just added leaves over, into its successor.
  void StartMemory(const FilterState& state, const Eigen::Ref<const Eigen::MatrixXd>& clone_rows,
                   const Eigen::Vector3d& p_W);

  FilterConfig filter_;
  VisionConfig vision_;
  double drift_limit_;  ///< of TrackMemory::Drifts
  int rows_ = 0;
  int dimension_ = 0;
  bool prepared_ = false;         ///< the rows have been handed over
  Eigen::Index calibration_ = 0;  ///< size of the calibration's error
  std::vector<Block> blocks_;
  bool tracing_ = false;
  std::vector<TracedBlock> traces_;
  TrackMemoryKeeper keeper_;
  SceneDepth scene_depth_;
  bool learn_scene_depth_ = false;
  std::vector<TrackMemory> successors_;  ///< of the blocks; grows, never shrinks
  std::vector<Eigen::Vector3d> points_;  ///< of the blocks: landmark of the linearisation
  Eigen::MatrixXd jacobian_;
  Eigen::VectorXd innovation_;
  // Scratch of one track.
  std::vector<Pose> poses_;
  std::vector<NormalizedObservation> observations_;
  std::vector<int> offsets_;
  std::vector<int> clones_;
  // Rows of the views, two each, in the upper part: residual, over p_W, over six columns a view and, after
  // them, the calibration's.
  Eigen::VectorXd residual_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> point_jacobian_;
  Eigen::MatrixXd track_jacobian_;
};

}  // namespace alidade
