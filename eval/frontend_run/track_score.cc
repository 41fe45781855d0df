#include "eval/frontend_run/track_score.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "core/check.h"
#include "core/lie.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::array<int, 8> kAges = {1, 2, 5, 10, 20, 30, 50, 100};

/// Middle of the sorted values at `share`, the lower of two; NaN of none.
double SortedAt(std::vector<double>* values, double share) {
  if (values->empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values->size() - 1));
  std::nth_element(values->begin(), values->begin() + at, values->end());
  return (*values)[static_cast<std::size_t>(at)];
}

ErrorSpread SpreadOf(std::vector<double> errors_px) {
  return {errors_px.size(), SortedAt(&errors_px, 0.5), SortedAt(&errors_px, 0.95)};
}

/// Where a track began.
struct Beginning {
  std::size_t frame = 0;
  std::optional<Vector2d> normalized;  ///< empty: outside the domain of the lens model
  std::optional<Vector3d> p_W;         ///< the surface point seen there
};

struct Life {
  Beginning beginning;
  std::size_t last_frame = 0;
  int observations = 0;
};

/// First-order distance of a pair of bearings from the epipolar constraint, in units of the normalised plane.
double SampsonDistance(const Vector2d& first, const Vector2d& second, const Pose& T_21) {
  const Matrix3d essential = Skew(T_21.translation.normalized()) * T_21.rotation;
  const Vector3d line_2 = essential * first.homogeneous();
  const Vector3d line_1 = essential.transpose() * second.homogeneous();
  const double square = line_2.head<2>().squaredNorm() + line_1.head<2>().squaredNorm();
  return square > 0 ? std::abs(second.homogeneous().dot(line_2)) / std::sqrt(square) : 0;
}

/// Errors of the observations, together and by age.
class ErrorBook {
 public:
  void Add(int age, double error_px) {
    all_.push_back(error_px);
    if (std::find(kAges.begin(), kAges.end(), age) != kAges.end()) {
      by_age_[age].push_back(error_px);
    }
  }
  [[nodiscard]] ErrorSpread All() const { return SpreadOf(all_); }
  [[nodiscard]] ErrorSpread At(int age) const {
    const auto found = by_age_.find(age);
    return SpreadOf(found == by_age_.end() ? std::vector<double>() : found->second);
  }

 private:
  std::vector<double> all_;
  std::map<int, std::vector<double>> by_age_;
};

/// Walks the frames in their order.
class Scorer {
 public:
  Scorer(const CameraModel& camera, const TrackTruth& truth) : camera_(camera), truth_(truth) {}

  void AddFrame(std::size_t index, const TrackFrame& frame) {
    std::array<bool, static_cast<std::size_t>(TrackScore::kColumns * TrackScore::kRows)> covered{};
    for (const TrackObservation& observation : frame.observations) {
      const auto [place, began] = lives_.try_emplace(observation.track_id);
      Life& life = place->second;
      if (began) {
        life.beginning = Begin(index, observation.pixel);
      } else {
        Compare(index, life.beginning, observation.pixel);
      }
      life.last_frame = index;
      ++life.observations;
      covered[Cell(observation.pixel)] = true;
    }
    coverage_ += static_cast<double>(std::count(covered.begin(), covered.end(), true)) /
                 static_cast<double>(covered.size());
  }

  [[nodiscard]] TrackScore Summarize(const std::vector<TrackFrame>& frames) const;

 private:
  [[nodiscard]] std::optional<Pose> PoseOf(std::size_t frame) const {
    return truth_.T_WC.empty() ? std::nullopt : truth_.T_WC[frame];
  }

  [[nodiscard]] std::size_t Cell(const Vector2d& pixel) const {
    const auto index = [](double at, int length, int count) {
      return std::clamp(static_cast<int>(at * count / length), 0, count - 1);
    };
    return static_cast<std::size_t>(index(pixel.y(), camera_.height_px(), TrackScore::kRows) *
                                        TrackScore::kColumns +
                                    index(pixel.x(), camera_.width_px(), TrackScore::kColumns));
  }

  [[nodiscard]] Beginning Begin(std::size_t index, const Vector2d& pixel) const {
    Beginning beginning{.frame = index, .normalized = std::nullopt, .p_W = std::nullopt};
    Vector2d normalized;
    if (!camera_.Unproject(pixel, &normalized)) {
      return beginning;
    }
    beginning.normalized = normalized;
    const std::optional<Pose> T_WC = PoseOf(index);
    if (T_WC.has_value() && truth_.distance) {
      const Vector3d direction_W = T_WC->rotation * normalized.homogeneous().normalized();
      beginning.p_W = T_WC->translation + truth_.distance(T_WC->translation, direction_W) * direction_W;
    }
    return beginning;
  }

  void Compare(std::size_t index, const Beginning& beginning, const Vector2d& pixel) {
    const int age = static_cast<int>(index - beginning.frame);
    ++observations_[age];
    const std::optional<Pose> T_WC = PoseOf(index);
    if (!T_WC.has_value()) {
      return;
    }
    Vector2d expected;
    if (beginning.p_W.has_value() && camera_.Project(T_WC->Inverse() * *beginning.p_W, &expected)) {
      corner_.Add(age, (pixel - expected).norm());
    }
    const std::optional<Pose> T_WC_first = PoseOf(beginning.frame);
    Vector2d normalized;
    if (!T_WC_first.has_value() || !beginning.normalized.has_value() ||
        !camera_.Unproject(pixel, &normalized)) {
      return;
    }
    const Pose T_21 = T_WC->Inverse() * *T_WC_first;
    if (T_21.translation.norm() >= TrackScore::kMinBaselineM) {
      epipolar_.Add(age, camera_.mean_focal_px() * SampsonDistance(*beginning.normalized, normalized, T_21));
    }
  }

  const CameraModel& camera_;
  const TrackTruth& truth_;
  std::map<std::int64_t, Life> lives_;
  std::map<int, std::size_t> observations_;  ///< by age
  double coverage_ = 0;
  ErrorBook epipolar_, corner_;
};

TrackScore Scorer::Summarize(const std::vector<TrackFrame>& frames) const {
  TrackScore score;
  score.frames = static_cast<int>(frames.size());
  score.tracks = lives_.size();
  std::vector<double> lived;
  double total = 0;
  for (const auto& [id, life] : lives_) {
    score.censored += life.last_frame + 1 == frames.size() ? 1 : 0;
    lived.push_back(life.observations);
    total += life.observations;
  }
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  const double at_risk = frames.empty() ? 0 : total - static_cast<double>(frames.back().observations.size());
  score.features_per_frame = frames.empty() ? nothing : total / score.frames;
  score.mean_life = lived.empty() ? nothing : total / static_cast<double>(lived.size());
  score.median_life = SortedAt(&lived, 0.5);
  score.loss_share = at_risk > 0 ? static_cast<double>(score.tracks - score.censored) / at_risk : nothing;
  score.coverage = frames.empty() ? nothing : coverage_ / score.frames;
  score.has_poses = !truth_.T_WC.empty();
  score.has_surface = score.has_poses && truth_.distance;
  score.epipolar = epipolar_.All();
  score.corner = corner_.All();
  for (const int age : kAges) {
    const auto found = observations_.find(age);
    score.ages.push_back(
        {age, found == observations_.end() ? 0 : found->second, epipolar_.At(age), corner_.At(age)});
  }
  return score;
}

}  // namespace

TrackScore ScoreTracks(const std::vector<TrackFrame>& frames, const CameraModel& camera,
                       const TrackTruth& truth, const std::vector<double>& cpu_ms) {
  CHECK(truth.T_WC.empty() || truth.T_WC.size() == frames.size());
  Scorer scorer(camera, truth);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    scorer.AddFrame(i, frames[i]);
  }
  TrackScore score = scorer.Summarize(frames);
  std::vector<double> times_ms = cpu_ms;
  score.cpu_ms = SortedAt(&times_ms, 0.5);
  return score;
}

}  // namespace alidade
