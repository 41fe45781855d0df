#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "eval/comparison/comparison.h"

namespace alidade::test {

/// A run on a figure of eight whose errors have the claimed deviation times `honesty` (1: consistent).
inline CellSeries SyntheticSeries(int frames, double sigma_m, double honesty, double backend_ms,
                                  unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  CellSeries series;
  Vector6d walk = Vector6d::Zero();
  for (int i = 0; i < frames; ++i) {
    const double t = 0.1 * i;
    const double u = 2 * std::numbers::pi * t / 60;
    const Eigen::Vector3d truth(20 * std::sin(u), 10 * std::sin(2 * u), 1.5 + 0.5 * std::cos(3 * u));
    const double grown = std::sqrt(1 + 0.02 * i);
    Vector6d sigma;
    Vector6d noise;
    for (int k = 0; k < 6; ++k) {
      sigma(k) = (k < 3 ? 0.1 : 1.0) * sigma_m * grown;
      noise(k) = normal(random);
    }
    walk = 0.98 * walk + std::sqrt(1 - 0.98 * 0.98) * noise;
    const Vector6d error = honesty * walk.cwiseProduct(sigma);
    series.time_s.push_back(t);
    series.truth_position.push_back(truth);
    series.position.push_back(truth - error.tail<3>());
    series.error.push_back(error);
    series.sigma.push_back(sigma);
    series.nees_pose.push_back(error.cwiseQuotient(sigma).squaredNorm());
    series.backend_ms.push_back(backend_ms * std::exp(0.3 * normal(random)));
    series.features_used.push_back(std::round(40 + 8 * normal(random)));
    series.tracks_in.push_back(std::round(150 + 3 * normal(random)));
    series.nis_ratio.push_back(std::exp(0.2 * normal(random)));
  }
  return series;
}

inline CellResult SyntheticCell(const std::string& estimator, const std::string& sequence, unsigned seed,
                                double sigma_m, double honesty, double backend_ms, int frames) {
  CellResult cell;
  cell.estimator = estimator;
  cell.backend = backend_ms > 10 ? "smoother" : "filter";
  cell.sequence = sequence;
  cell.seed = seed;
  cell.status = "ok";
  cell.input_digest = "5f1c" + std::to_string(seed) + std::string(sequence.size(), 'a') + "0b7e";
  cell.frames = frames;
  cell.duration_s = 0.1 * (frames - 1);
  cell.path_m = 12.5 * *cell.duration_s / 10;
  cell.align = "posyaw";
  cell.series = SyntheticSeries(frames, sigma_m, honesty, backend_ms, seed * 31 + estimator.size());
  double squares = 0;
  double nees = 0;
  for (int i = 0; i < frames; ++i) {
    squares += cell.series.error[i].tail<3>().squaredNorm();
    nees += cell.series.nees_pose[i];
  }
  cell.rmse_pos_m = std::sqrt(squares / frames);
  cell.rmse_ori_deg = *cell.rmse_pos_m * 2.1;
  cell.ate_pos_m = *cell.rmse_pos_m * 0.6;
  cell.ate_ori_deg = *cell.rmse_ori_deg * 0.5;
  for (const double distance : {5.0, 10.0, 25.0}) {
    RpeResult rpe{distance, 40, 0.02 * sigma_m * distance, 0.05 * sigma_m * distance, {}};
    for (int i = 0; i < 40; ++i) {
      rpe.pos_errors_m.push_back(rpe.pos_rmse_m * (0.3 + 0.04 * i));
    }
    cell.rpe.push_back(rpe);
  }
  cell.nees_pose = nees / frames;
  cell.nees_ori = cell.nees_pos = *cell.nees_pose / 2;
  cell.coverage_3sigma = honesty > 1.2 ? 0.91 : 0.997;
  cell.frontend_ms = 4.4;
  cell.backend_ms = backend_ms;
  cell.backend_ms_p95 = 1.7 * backend_ms;
  cell.completion = 0.98;
  cell.realtime_factor = 100 / (4.4 + backend_ms);
  cell.features_per_frame = 40;
  cell.propagate_ms = 0.1 * backend_ms;
  cell.update_ms = 0.8 * backend_ms;
  cell.innovations = {1.02, 0.94, std::pair(0.71, 1.34)};
  return cell;
}

/// Three estimators on two sequences with two seeds; the last run failed. References to one of ours and to
/// another.
inline Comparison SyntheticComparison(int frames = 600) {
  Comparison comparison;
  comparison.title = "Synthetic: filter & smoother";
  comparison.command = "alidade compare --plan=configs/plans/synthetic.yaml --output=out/synthetic";
  for (const char* sequence : {"figure8", "V1_01_easy"}) {
    const double scale = std::string(sequence) == "figure8" ? 1.0 : 0.5;
    for (unsigned seed : {1U, 2U}) {
      comparison.cells.push_back(
          SyntheticCell("po_invio_multi", sequence, seed, 0.08 * scale, 1.0, 1.8, frames));
      comparison.cells.push_back(SyntheticCell("invio_l5", sequence, seed, 0.12 * scale, 1.6, 1.2, frames));
      comparison.cells.push_back(
          SyntheticCell("vins_mono_class", sequence, seed, 0.06 * scale, 0.8, 31, frames));
    }
  }
  CellResult& failed = comparison.cells.back();
  CellResult kept;
  kept.estimator = failed.estimator;
  kept.backend = failed.backend;
  kept.sequence = failed.sequence;
  kept.seed = failed.seed;
  kept.input_digest = failed.input_digest;
  kept.status = "failed";
  kept.message = "cam0/tracks.csv:12: </script><b>\"torn\" row, expected 4 columns";
  failed = kept;
  comparison.references.push_back(
      {"the paper", "po_invio_multi", "figure8", {{"rmse_pos_m", 0.158}, {"ate_pos_m", 0.11}}});
  comparison.references.push_back({"published", "OpenVINS", "V1_01_easy", {{"ate_pos_m", 0.11}}});
  return comparison;
}

/// Ten estimators on ten sequences of 200 s at 10 Hz, with GNSS.
inline Comparison LargeComparison() {
  Comparison comparison;
  comparison.title = "many";
  for (int sequence = 0; sequence < 10; ++sequence) {
    for (int estimator = 0; estimator < 10; ++estimator) {
      comparison.cells.push_back(SyntheticCell("estimator_" + std::to_string(estimator),
                                               "sequence_" + std::to_string(sequence), 1,
                                               0.02 * (1 + estimator), 1, 2, 2000));
      for (int satellite = 1; satellite <= 30; ++satellite) {
        SkyTrack track;
        track.satellite = "G" + std::to_string(satellite);
        for (int i = 0; i < 24; ++i) {
          track.time_s.push_back(8.3 * i);
          track.azimuth_deg.push_back(12.3 * satellite + 0.1234 * i);
          track.elevation_deg.push_back(10 + 2.5 * satellite + 0.0567 * i);
          track.residual_m.push_back(0.1234 * ((i * satellite) % 7 - 3));
        }
        comparison.cells.back().sky.push_back(track);
      }
    }
  }
  return comparison;
}

}  // namespace alidade::test
