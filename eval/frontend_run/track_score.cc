#include "eval/frontend_run/track_score.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "core/lie.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::array<int, 8> kAges = {1, 2, 5, 10, 20, 30, 50, 100};
constexpr std::array<double, 7> kRatios = {0, 1.25, 1.5, 2, 3, 5, 10};

/// Which span of noise_ratio holds it.
std::size_t RatioSpan(double ratio) {
  const auto next = std::upper_bound(kRatios.begin(), kRatios.end(), ratio);
  return static_cast<std::size_t>(std::max(next - kRatios.begin(), std::ptrdiff_t{1}) - 1);
}

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
  ExposureTime time;
  std::optional<Vector2d> normalized;  ///< empty: outside the domain of the lens model
  std::optional<Pose> T_WC;
  std::optional<SurfacePoint> point;  ///< that is seen there
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

/// Errors of the observations, together, by age and by ratio.
class ErrorBook {
 public:
  void Add(int age, double ratio, double error_px) {
    all_.push_back(error_px);
    by_ratio_[RatioSpan(ratio)].push_back(error_px);
    if (std::find(kAges.begin(), kAges.end(), age) != kAges.end()) {
      by_age_[age].push_back(error_px);
    }
  }
  [[nodiscard]] ErrorSpread All() const { return SpreadOf(all_); }
  [[nodiscard]] ErrorSpread InSpan(std::size_t span) const { return SpreadOf(by_ratio_[span]); }
  [[nodiscard]] ErrorSpread At(int age) const {
    const auto found = by_age_.find(age);
    return SpreadOf(found == by_age_.end() ? std::vector<double>() : found->second);
  }

 private:
  std::vector<double> all_;
  std::map<int, std::vector<double>> by_age_;
  std::array<std::vector<double>, kRatios.size()> by_ratio_;
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
        life.beginning = Begin({index, observation.pixel.y()}, observation.pixel);
      } else {
        Compare({index, observation.pixel.y()}, life.beginning, observation);
      }
      moving_ += life.beginning.point.has_value() && life.beginning.point->moving >= 0 ? 1 : 0;
      life.last_frame = index;
      ++life.observations;
      covered[Cell(observation.pixel)] = true;
    }
    coverage_ += static_cast<double>(std::count(covered.begin(), covered.end(), true)) /
                 static_cast<double>(covered.size());
  }

  [[nodiscard]] TrackScore Summarize(const std::vector<TrackFrame>& frames) const;

 private:
  [[nodiscard]] std::optional<Pose> PoseAt(const ExposureTime& time) const {
    return truth_.T_WC ? truth_.T_WC(time) : std::nullopt;
  }

  [[nodiscard]] std::size_t Cell(const Vector2d& pixel) const {
    const auto index = [](double at, int length, int count) {
      return std::clamp(static_cast<int>(at * count / length), 0, count - 1);
    };
    return static_cast<std::size_t>(index(pixel.y(), camera_.height_px(), TrackScore::kRows) *
                                        TrackScore::kColumns +
                                    index(pixel.x(), camera_.width_px(), TrackScore::kColumns));
  }

  [[nodiscard]] Beginning Begin(const ExposureTime& time, const Vector2d& pixel) const {
    Beginning beginning{
        .time = time, .normalized = std::nullopt, .T_WC = std::nullopt, .point = std::nullopt};
    Vector2d normalized;
    if (!camera_.Unproject(pixel, &normalized)) {
      return beginning;
    }
    beginning.normalized = normalized;
    beginning.T_WC = PoseAt(time);
    if (beginning.T_WC.has_value() && truth_.surface) {
      const Vector3d direction_W = beginning.T_WC->rotation * normalized.homogeneous().normalized();
      beginning.point = truth_.surface(time, beginning.T_WC->translation, direction_W);
    }
    return beginning;
  }

  /// Where a frame shows the point; `time` holds about the row, and then the row itself. False: nowhere.
  bool Expect(const Beginning& beginning, ExposureTime time, Vector2d* pixel) const {
    // The row decides when, which decides the row: each round leaves the share of the line delay in the time
    // that the image takes to move by a row, a few per cent.
    constexpr int kRounds = 6;
    constexpr double kSettledPx = 1e-4;
    for (int round = 0; round < kRounds; ++round) {
      const std::optional<Pose> T_WC = PoseAt(time);
      if (!T_WC.has_value()) {
        return false;
      }
      const Vector3d p_W =
          truth_.moved ? truth_.moved(*beginning.point, beginning.time, time) : beginning.point->p_W;
      if (!camera_.Project(T_WC->Inverse() * p_W, pixel)) {
        return false;
      }
      const double change_px = std::abs(pixel->y() - time.row);
      time.row = pixel->y();
      if (change_px < kSettledPx) {
        break;
      }
    }
    return true;
  }

  void Compare(const ExposureTime& time, const Beginning& beginning, const TrackObservation& observation) {
    const Vector2d& pixel = observation.pixel;
    const double ratio = observation.noise_ratio;
    const int age = static_cast<int>(time.frame - beginning.time.frame);
    ++observations_[age];
    ++in_span_[RatioSpan(ratio)];
    Vector2d expected;
    if (beginning.point.has_value() && Expect(beginning, time, &expected)) {
      corner_.Add(age, ratio, (pixel - expected).norm());
    }
    const std::optional<Pose> T_WC = PoseAt(time);
    Vector2d normalized;
    if (!T_WC.has_value() || !beginning.T_WC.has_value() || !camera_.Unproject(pixel, &normalized)) {
      return;
    }
    const Pose T_21 = T_WC->Inverse() * *beginning.T_WC;
    if (T_21.translation.norm() >= TrackScore::kMinBaselineM) {
      epipolar_.Add(age, ratio,
                    camera_.mean_focal_px() * SampsonDistance(*beginning.normalized, normalized, T_21));
    }
  }

  const CameraModel& camera_;
  const TrackTruth& truth_;
  std::map<std::int64_t, Life> lives_;
  std::map<int, std::size_t> observations_;  ///< by age
  std::array<std::size_t, kRatios.size()> in_span_{};
  double coverage_ = 0;
  std::size_t moving_ = 0;  ///< observations of what moves
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
  score.has_poses = static_cast<bool>(truth_.T_WC);
  score.has_surface = score.has_poses && truth_.surface;
  score.moving_share = total > 0 ? static_cast<double>(moving_) / total : nothing;
  score.epipolar = epipolar_.All();
  score.corner = corner_.All();
  for (const int age : kAges) {
    const auto found = observations_.find(age);
    score.ages.push_back(
        {age, found == observations_.end() ? 0 : found->second, epipolar_.At(age), corner_.At(age)});
  }
  for (std::size_t span = 0; span < kRatios.size(); ++span) {
    score.ratios.push_back({kRatios[span], in_span_[span], epipolar_.InSpan(span), corner_.InSpan(span)});
  }
  return score;
}

}  // namespace

TrackScore ScoreTracks(const std::vector<TrackFrame>& frames, const CameraModel& camera,
                       const TrackTruth& truth, const std::vector<double>& cpu_ms) {
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
