#include "eval/record/recorder_gnss.h"

#include <algorithm>
#include <cmath>

#include "eval/files/output_file.h"
#include "eval/record/satellite_rows.h"
#include "gnss/model/measurement_model.h"
#include "gnss/positioning/position_file.h"

namespace alidade {

bool HasGnss(const RunResult& result) {
  return result.global && result.global->source == Sensor::kGnss;
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

std::string AntennaHeader() {
  return PositionFileHeader({std::string("program   : alidade ") + ALIDADE_VERSION});
}

void AppendAntenna(const RunRecord& record, const GlobalFrame& global, std::string* text) {
  if (!record.clock) {
    return;
  }
  const EnuFrame& enu = *global.enu;
  const NavEstimate& e = record.estimate;
  SinglePointSolution row;
  row.stamp_ns = row.tag_ns = e.stamp_ns - SecondsToNs(global.time_offset_s);
  Eigen::Matrix<double, 3, 15> antenna;
  row.position_E = AntennaMount{enu, global.p_BA}.Position(e.nav, &antenna);
  const Eigen::Matrix<double, 3, 6> to_ecef = antenna.leftCols<6>();
  row.position_covariance_E = to_ecef * e.covariance.topLeftCorner<6, 6>() * to_ecef.transpose();
  row.has_velocity = true;
  row.velocity_E = enu.R_EN * e.nav.v_WB;
  row.used = record.statistics.satellites_used;
  AppendPosition(row, text);
}

std::string SatelliteTable(const RunResult& result) {
  std::string text = SatelliteHeader();
  for (const GnssResiduals& epoch : result.gnss_residuals) {
    text += SatelliteRows(epoch);
  }
  return text;
}

}  // namespace alidade
