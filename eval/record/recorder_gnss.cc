#include "eval/record/recorder_gnss.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/numbers.h"
#include "eval/files/output_file.h"
#include "gnss/positioning/position_file.h"

namespace alidade {

bool HasGnss(const RunResult& result) {
  return result.global && result.global->source == GlobalFrame::Source::kGnss;
}

std::string ClockColumns() {
  return ",clock_m,drift_mps,bias_E_m,bias_C_m,bias_J_m,bias_R_m,clock_std_m,drift_std_mps";
}

std::string ClockFields(const RunRecord& record) {
  constexpr std::size_t kColumns = 8;
  if (!record.clock) {
    return std::string(kColumns, ',');
  }
  std::string text;
  for (const double value : record.clock->mean) {
    text += "," + ShortestDouble(value);
  }
  for (const int i : {ClockState::kClock, ClockState::kDrift}) {
    text += "," + ShortestDouble(std::sqrt(std::max(record.clock->covariance(i, i), 0.0)));
  }
  return text;
}

std::string AntennaPositions(const RunResult& result, double time_offset_s) {
  const EnuFrame& enu = *result.global->enu;
  std::vector<SinglePointSolution> rows;
  for (const RunRecord& record : result.records) {
    if (!record.clock) {
      continue;
    }
    const NavEstimate& e = record.estimate;
    SinglePointSolution row;
    row.stamp_ns = row.tag_ns = e.stamp_ns - SecondsToNs(time_offset_s);
    row.position_E = enu.ToEcef(e.nav.p_WB + e.nav.R_WB * result.global->p_BA);
    Eigen::Matrix<double, 3, 6> antenna;
    antenna << -e.nav.R_WB * Skew(result.global->p_BA), Eigen::Matrix3d::Identity();
    const Eigen::Matrix<double, 3, 6> to_ecef = enu.R_EN * antenna;
    row.position_covariance_E = to_ecef * e.covariance.topLeftCorner<6, 6>() * to_ecef.transpose();
    row.has_velocity = true;
    row.velocity_E = enu.R_EN * e.nav.v_WB;
    row.used = record.statistics.satellites_used;
    rows.push_back(row);
  }
  return FormatPositionFile(rows, {std::string("program   : alidade ") + ALIDADE_VERSION});
}

std::string SatelliteTable(const RunResult& result) {
  std::string text =
      "timestamp_ns,satellite,azimuth_deg,elevation_deg,residual_m,deviation_m,used,rate_residual_mps,"
      "rate_used\n";
  for (const GnssResiduals& epoch : result.gnss_residuals) {
    for (const SatelliteResidual& s : epoch.satellites) {
      text +=
          std::to_string(epoch.stamp_ns) + "," + ToString(s.satellite) +
          Format(",%.2f,%.2f,%.4f,%.4f,%d,", s.direction.azimuth_rad * kDegreesPerRadian,
                 s.direction.elevation_rad * kDegreesPerRadian, s.residual_m, s.deviation_m, s.used ? 1 : 0) +
          (s.range_rate_residual_mps ? Format("%.5f", *s.range_rate_residual_mps) : "") +
          (s.range_rate_used ? ",1\n" : ",0\n");
    }
  }
  return text;
}

}  // namespace alidade
