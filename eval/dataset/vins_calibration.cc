#include "eval/dataset/vins_calibration.h"

#include <algorithm>

#include "eval/dataset/calibration_text.h"

namespace alidade {
namespace {

constexpr char kLensSuffix[] = "_calib";

}  // namespace

std::string VinsLensKey(const std::string& camera) {
  return camera + kLensSuffix;
}

bool NamesVinsLens(const YAML::Node& root) {
  return std::any_of(root.begin(), root.end(), [](const auto& entry) {
    const std::string key = FlowText(entry.first);
    return key.starts_with("cam") && key.ends_with(kLensSuffix);
  });
}

std::string TranslateVinsImu(const YAML::Node& root) {
  return CalibrationLine("gyroscope_noise_density", FlowText(root["gyr_n"])) +
         CalibrationLine("gyroscope_random_walk", FlowText(root["gyr_w"])) +
         CalibrationLine("accelerometer_noise_density", FlowText(root["acc_n"])) +
         CalibrationLine("accelerometer_random_walk", FlowText(root["acc_w"]));
}

Result<std::string> TranslateVinsCamera(const std::string& path, const YAML::Node& root) {
  const std::string type = FlowText(root["model_type"]);
  const YAML::Node projection = root["projection_parameters"];
  const YAML::Node distortion = root["distortion_parameters"];
  Result<std::string> intrinsics = Status::Input("");
  Result<std::string> coefficients = Status::Input("");
  std::string model;
  if (type == "PINHOLE") {
    model = "radial-tangential";
    intrinsics = FlowListOf(path, projection, {"fx", "fy", "cx", "cy"});
    coefficients = FlowListOf(path, distortion, {"k1", "k2", "p1", "p2"});
  } else if (type == "MEI") {
    model = "mei";
    intrinsics = FlowListOf(path, projection, {"gamma1", "gamma2", "u0", "v0"});
    const Result<std::string> mirror = FlowListOf(path, root["mirror_parameters"], {"xi"});
    const Result<std::string> lens = FlowListOf(path, distortion, {"k1", "k2", "p1", "p2"});
    ALIDADE_RETURN_IF_ERROR(mirror.status());
    ALIDADE_RETURN_IF_ERROR(lens.status());
    coefficients = mirror->substr(0, mirror->size() - 1) + ", " + lens->substr(1);
  } else if (type == "KANNALA_BRANDT") {
    model = "equidistant";
    intrinsics = FlowListOf(path, projection, {"mu", "mv", "u0", "v0"});
    coefficients = FlowListOf(path, projection, {"k2", "k3", "k4", "k5"});
  } else {
    return Status::Input(path + ": model_type: found '" + type +
                         "', expected PINHOLE, MEI or KANNALA_BRANDT");
  }
  ALIDADE_RETURN_IF_ERROR(intrinsics.status());
  ALIDADE_RETURN_IF_ERROR(coefficients.status());
  const Result<std::string> resolution = FlowListOf(path, root, {"image_width", "image_height"});
  ALIDADE_RETURN_IF_ERROR(resolution.status());
  return CalibrationLine("resolution", *resolution) + CalibrationLine("intrinsics", *intrinsics) +
         CalibrationLine("distortion_model", model) +
         CalibrationLine("distortion_coefficients", *coefficients);
}

VinsExtrinsics TranslateVinsExtrinsics(const YAML::Node& root, const std::string& camera) {
  const std::string body_key = "body_T_" + camera;
  const YAML::Node rotation = root["extrinsicRotation"];
  const YAML::Node translation = root["extrinsicTranslation"];
  VinsExtrinsics found;
  if (root[body_key].IsDefined()) {
    found.extrinsics = CalibrationLine("body_T_cam0", FlowText(root[body_key]));
  } else if (IsYamlMap(rotation) && IsYamlMap(translation) && rotation["data"].IsDefined() &&
             translation["data"].IsDefined() && rotation["data"].size() == 9 &&
             translation["data"].size() == 3) {
    std::string rows;
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 3; ++column) {
        rows += FlowText(rotation["data"][3 * row + column]) + ", ";
      }
      rows += FlowText(translation["data"][row]) + ", ";
    }
    found.extrinsics = CalibrationLine("body_T_cam0", "[" + rows + "0, 0, 0, 1]");
  }
  if (!found.extrinsics.empty() && root["td"].IsDefined()) {
    found.offset = CalibrationLine("time_offset_s", FlowText(root["td"]));
  }
  return found;
}

}  // namespace alidade
