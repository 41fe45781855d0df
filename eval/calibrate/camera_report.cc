#include "eval/calibrate/camera_report.h"

#include <cmath>

#include "core/format.h"
#include "eval/calibrate/camera_gyro_check.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/files/output_file.h"
#include "eval/report/report_json.h"

namespace alidade {
namespace {

constexpr int kCoordinates = CameraGyroCoordinate::kCount;
constexpr int kDigits = 6;

/// What was found, as changes of the sheet, in the units of NameOfCoordinate.
struct Changes {
  CameraGyroError whole;
  std::array<CameraGyroError, 2> halves;
};

Changes ChangesOf(const CalibratedCamera& camera, const RigCalibration& given) {
  const CameraGyroModel sheet = ModelOfSheet(given);
  Changes changes{CameraGyroOffset(sheet, camera.fit.model), {}};
  for (std::size_t half = 0; half < 2; ++half) {
    changes.halves[half] =
        camera.halves[half] ? CameraGyroOffset(sheet, camera.halves[half]->model) : CameraGyroError::Zero();
  }
  return changes;
}

Json LeverArmJson(const CameraLeverArm& arm) {
  Json json;
  const auto list = [](const Eigen::Vector3d& v) {
    return Json{RoundedJson(v.x(), kDigits), RoundedJson(v.y(), kDigits), RoundedJson(v.z(), kDigits)};
  };
  json["p_BC_m"] = list(arm.p_BC);
  json["std_m"] = list(arm.deviations);
  json["first_half_m"] = list(arm.halves[0]);
  json["second_half_m"] = list(arm.halves[1]);
  return json;
}

}  // namespace

std::string CalibratedCameraTable(const CalibratedCamera& camera, const RigCalibration& given,
                                  double rate_hz) {
  const Changes changes = ChangesOf(camera, given);
  std::string text = Format(
      "%d pairs of images, %d views, %.2f px from the epipolar lines, %.0f %% outliers; variances %.1f times "
      "those of independent errors\n\n%-26s %-6s %11s %11s",
      camera.fit.pairs, camera.fit.views, camera.fit.residual_px, 100 * camera.fit.outliers,
      camera.fit.inflation, "change of the sheet", "unit", "found", "+-");
  const bool halves = camera.halves[0] && camera.halves[1];
  text += halves ? Format(" %11s %11s\n", "first half", "second half") : "\n";
  for (int c = 0; c < kCoordinates; ++c) {
    const CoordinateName name = NameOfCoordinate(c);
    if (camera.fit.deviations[c] > 0) {
      text += Format("%-26s %-6s %11.4f %11.4f", name.name, name.unit, name.scale * changes.whole[c],
                     name.scale * camera.fit.deviations[c]);
      text += halves ? Format(" %11.4f %11.4f\n", name.scale * changes.halves[0][c],
                              name.scale * changes.halves[1][c])
                     : "\n";
    }
  }
  if (halves) {
    text += Format("\nlargest difference of the halves: %.1f standard deviations (%s)\n", camera.halves_sigma,
                   camera.halves_coordinate.c_str());
  }
  if (camera.lever_arm) {
    constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
    text += "\n";
    for (int axis = 0; axis < 3; ++axis) {
      text += Format("%-26s %-6s %11.2f %11.2f %11.2f %11.2f\n",
                     Format("lever arm, body %s", kAxes[static_cast<std::size_t>(axis)]).c_str(), "cm",
                     100 * camera.lever_arm->p_BC[axis], 100 * camera.lever_arm->deviations[axis],
                     100 * camera.lever_arm->halves[0][axis], 100 * camera.lever_arm->halves[1][axis]);
    }
  }
  text += "\nsheet:\n" + CameraSensorYaml(camera.rig, rate_hz);
  for (const std::string& remark : camera.remarks) {
    text += "note: " + remark + "\n";
  }
  return text;
}

Status WriteCalibratedCamera(const CalibratedCamera& camera, const RigCalibration& given,
                             const std::string& dataset, double rate_hz, const std::string& folder) {
  const Changes changes = ChangesOf(camera, given);
  Json json;
  json["dataset"] = dataset;
  json["pairs"] = camera.fit.pairs;
  json["views"] = camera.fit.views;
  json["residual_px"] = RoundedJson(camera.fit.residual_px, kDigits);
  json["outliers"] = RoundedJson(camera.fit.outliers, kDigits);
  json["variance_inflation"] = RoundedJson(camera.fit.inflation, kDigits);
  json["changes"] = Json::object();
  for (int c = 0; c < kCoordinates; ++c) {
    const CoordinateName name = NameOfCoordinate(c);
    if (camera.fit.deviations[c] == 0) {
      continue;
    }
    Json entry;
    entry["unit"] = name.unit;
    entry["value"] = RoundedJson(name.scale * changes.whole[c], kDigits);
    entry["std"] = RoundedJson(name.scale * camera.fit.deviations[c], kDigits);
    if (camera.halves[0] && camera.halves[1]) {
      entry["first_half"] = RoundedJson(name.scale * changes.halves[0][c], kDigits);
      entry["second_half"] = RoundedJson(name.scale * changes.halves[1][c], kDigits);
    }
    json["changes"][name.key] = entry;
  }
  json["halves_sigma"] = RoundedJson(camera.halves_sigma, kDigits);
  if (camera.lever_arm) {
    json["lever_arm"] = LeverArmJson(*camera.lever_arm);
  }
  json["remarks"] = camera.remarks;
  ALIDADE_RETURN_IF_ERROR(
      WriteFileAtomically(folder + "/mav0/cam0/sensor.yaml", CameraSensorYaml(camera.rig, rate_hz)));
  return WriteFileAtomically(folder + "/calibrate.json", json.dump(2) + "\n");
}

}  // namespace alidade
