#include "eval/record/calibration_record.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "eval/files/csv_text.h"

namespace alidade {
namespace {

constexpr const char* kIntrinsicNames[] = {"fu", "fv", "cu", "cv", "k_0", "k_1", "k_2", "k_3"};

void Append(const std::string& name, std::string* columns) {
  *columns += "," + name;
}
void Append(double value, std::string* fields) {
  *fields += "," + CsvNumber(value);
}

}  // namespace

CalibrationError CompareCalibrations(const CameraCalibration& estimate, const CameraCalibration& truth) {
  return {so3::Log(estimate.T_BC.rotation.transpose() * truth.T_BC.rotation).norm(),
          (estimate.T_BC.translation - truth.T_BC.translation).norm(),
          std::abs(estimate.time_offset_s - truth.time_offset_s),
          (estimate.camera.intrinsics() - truth.camera.intrinsics()).head<2>().cwiseAbs().maxCoeff(),
          std::abs(estimate.line_delay_s.value_or(0) - truth.line_delay_s.value_or(0))};
}

std::string CalibrationColumns(const CalibrationEstimate& estimate) {
  const CalibrationLayout& layout = estimate.layout;
  std::string columns;
  if (layout.extrinsics() >= 0) {
    columns += ",q_w,q_x,q_y,q_z,p_x,p_y,p_z";
  }
  if (layout.time_offset() >= 0) {
    columns += ",time_offset_s";
  }
  if (layout.line_delay() >= 0) {
    columns += ",line_delay_s";
  }
  for (int i = 0; layout.intrinsics() >= 0 && i < layout.intrinsics_size(); ++i) {
    Append(kIntrinsicNames[i], &columns);
  }
  if (layout.extrinsics() >= 0) {
    columns += ",std_phi_x,std_phi_y,std_phi_z,std_p_x,std_p_y,std_p_z";
  }
  if (layout.time_offset() >= 0) {
    columns += ",std_time_offset_s";
  }
  if (layout.line_delay() >= 0) {
    columns += ",std_line_delay_s";
  }
  for (int i = 0; layout.intrinsics() >= 0 && i < layout.intrinsics_size(); ++i) {
    Append(std::string("std_") + kIntrinsicNames[i], &columns);
  }
  return columns;
}

std::string CalibrationFields(const CalibrationEstimate& estimate) {
  const CalibrationLayout& layout = estimate.layout;
  const CameraCalibration& mean = estimate.mean;
  std::string fields;
  if (layout.extrinsics() >= 0) {
    const Eigen::Quaterniond q(mean.T_BC.rotation);
    const double sign = q.w() < 0 ? -1 : 1;
    for (const double value : {q.w(), q.x(), q.y(), q.z()}) {
      Append(sign * value, &fields);
    }
    for (const double value : mean.T_BC.translation) {
      Append(value, &fields);
    }
  }
  if (layout.time_offset() >= 0) {
    Append(mean.time_offset_s, &fields);
  }
  if (layout.line_delay() >= 0) {
    Append(mean.line_delay_s.value_or(0), &fields);
  }
  for (int i = 0; layout.intrinsics() >= 0 && i < layout.intrinsics_size(); ++i) {
    Append(i < 4 ? mean.camera.intrinsics()[i] : mean.camera.coefficients()[i - 4], &fields);
  }
  for (const double deviation : estimate.deviations) {
    Append(deviation, &fields);
  }
  return fields;
}

}  // namespace alidade
