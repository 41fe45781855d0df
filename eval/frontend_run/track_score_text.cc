#include <cmath>
#include <nlohmann/json.hpp>

#include "core/format.h"
#include "eval/files/csv_text.h"
#include "eval/frontend_run/track_score.h"

namespace alidade {
namespace {

using Json = nlohmann::ordered_json;

Json NumberJson(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json SpreadJson(const ErrorSpread& spread) {
  return {{"count", spread.count},
          {"median_px", NumberJson(spread.median_px)},
          {"p95_px", NumberJson(spread.p95_px)}};
}

std::string SpreadText(const char* name, const ErrorSpread& spread) {
  return spread.count == 0 ? Format("  %s -", name)
                           : Format("  %s %.3f / %.2f px", name, spread.median_px, spread.p95_px);
}

}  // namespace

std::string ScoreJson(const TrackScore& score) {
  Json json = {{"frames", score.frames},
               {"tracks", score.tracks},
               {"censored", score.censored},
               {"features_per_frame", NumberJson(score.features_per_frame)},
               {"mean_life_frames", NumberJson(score.mean_life)},
               {"median_life_frames", NumberJson(score.median_life)},
               {"loss_share", NumberJson(score.loss_share)},
               {"coverage", NumberJson(score.coverage)},
               {"cpu_ms", NumberJson(score.cpu_ms)},
               {"epipolar", score.has_poses ? SpreadJson(score.epipolar) : Json(nullptr)},
               {"corner", score.has_surface ? SpreadJson(score.corner) : Json(nullptr)},
               {"moving_share", score.has_surface ? NumberJson(score.moving_share) : Json(nullptr)},
               {"ages", Json::array()},
               {"noise_ratios", Json::array()}};
  const auto add = [&](const char* name, Json row, const auto& part) {
    row["observations"] = part.observations;
    row["epipolar"] = score.has_poses ? SpreadJson(part.epipolar) : Json(nullptr);
    row["corner"] = score.has_surface ? SpreadJson(part.corner) : Json(nullptr);
    json[name].push_back(std::move(row));
  };
  for (const AgeScore& age : score.ages) {
    add("ages", {{"age", age.age}}, age);
  }
  for (const RatioScore& ratio : score.ratios) {
    add("noise_ratios", {{"from", ratio.from}}, ratio);
  }
  return json.dump(2) + "\n";
}

std::string ScoreCsv(const TrackScore& score) {
  std::string text =
      "age,observations,epipolar_count,epipolar_median_px,epipolar_p95_px,corner_count,corner_median_px,"
      "corner_p95_px\n";
  for (const AgeScore& age : score.ages) {
    text += JoinCsv({std::to_string(age.age), std::to_string(age.observations),
                     std::to_string(age.epipolar.count), CsvNumber(age.epipolar.median_px),
                     CsvNumber(age.epipolar.p95_px), std::to_string(age.corner.count),
                     CsvNumber(age.corner.median_px), CsvNumber(age.corner.p95_px)});
  }
  return text;
}

std::string DescribeScore(const TrackScore& score) {
  std::string text = Format(
      "%zu tracks (%zu alive at the end) in %d frames, %.1f a frame, in %.0f %% of the cells\n"
      "life %.2f frames (median %.0f), loss %.2f %% a frame",
      score.tracks, score.censored, score.frames, score.features_per_frame, 100 * score.coverage,
      score.mean_life, score.median_life, 100 * score.loss_share);
  text += std::isfinite(score.cpu_ms) ? Format(", %.2f ms of CPU a frame\n", score.cpu_ms) : "\n";
  if (score.has_poses) {
    text += "median / 95 %:" + SpreadText("epipolar", score.epipolar) +
            (score.has_surface ? SpreadText("corner", score.corner) : "") +
            (score.moving_share > 0 ? Format("; %.1f %% on what moves", 100 * score.moving_share) : "") +
            "\n";
    const auto add = [&](const std::string& name, const auto& part) {
      text += name + Format(": %6zu observations", part.observations) +
              SpreadText("epipolar", part.epipolar) +
              (score.has_surface ? SpreadText("corner", part.corner) : "") + "\n";
    };
    for (const AgeScore& age : score.ages) {
      add(Format("  age %3d", age.age), age);
    }
    for (const RatioScore& ratio : score.ratios) {
      add(Format("  noise_ratio from %5.2f", ratio.from), ratio);
    }
  }
  return text;
}

}  // namespace alidade
