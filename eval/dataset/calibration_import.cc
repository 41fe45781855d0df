#include "eval/dataset/calibration_import.h"

#include <cmath>
#include <filesystem>

#include "eval/dataset/basalt_calibration.h"
#include "eval/dataset/calibration_text.h"
#include "eval/dataset/vins_calibration.h"
#include "eval/files/strict_yaml.h"
#include "eval/files/suggest.h"

namespace alidade {
namespace {

using Node = YAML::Node;

/// One collection of files on its way to a calibration. Values are written as a sensor.yaml, whose reader
/// holds them against what a sensor may be.
class Importer {
 public:
  explicit Importer(std::string camera) : camera_(std::move(camera)) {}

  Status Add(const std::string& path, int depth = 0) {
    constexpr int kMaxDepth = 3;  // a configuration names files; files that name each other end here
    if (depth > kMaxDepth) {
      return Status::Input(path + ": named by a file that it names itself");
    }
    const Result<Node> parsed = ParseYamlFile(path, StatusCode::kInput);
    ALIDADE_RETURN_IF_ERROR(parsed.status());
    const Node& root = *parsed;
    if (!root.IsMap()) {
      return Unknown(path);
    }
    bool known = false;
    const std::string lens_key = VinsLensKey(camera_);
    for (const std::string& key :
         {std::string("relative_config_imu"), std::string("relative_config_imucam"), lens_key}) {
      if (root[key].IsDefined()) {
        const std::filesystem::path folder = std::filesystem::path(path).parent_path();
        ALIDADE_RETURN_IF_ERROR(Add((folder / FlowText(root[key])).string(), depth + 1));
        known = true;
      }
    }
    if (!root[lens_key].IsDefined() && NamesVinsLens(root)) {
      lensless_place_ = path + ": " + lens_key;
      known = true;
    }
    if (IsYamlMap(root[camera_])) {
      ALIDADE_RETURN_IF_ERROR(AddChainCamera(path, root[camera_]));
      known = true;
    }
    const Node imu = IsYamlMap(root["imu0"]) ? root["imu0"] : root;
    if (imu["gyroscope_noise_density"].IsDefined()) {
      ALIDADE_RETURN_IF_ERROR(AddKalibrImu(path, imu));
      known = true;
    }
    if (root["acc_n"].IsDefined()) {
      AddVinsImu(path, root);
      known = true;
    }
    if (IsYamlMap(root["value0"])) {
      ALIDADE_RETURN_IF_ERROR(AddBasalt(path, root["value0"]));
      known = true;
    }
    if (root["model_type"].IsDefined()) {
      ALIDADE_RETURN_IF_ERROR(AddVinsCamera(path, root));
      known = true;
    }
    known = AddVinsExtrinsics(root) || known;
    return known ? Status::Ok() : Unknown(path);
  }

  Result<ImportedCalibration> Finish(const std::string& path) {
    if (camera_text_.empty() && !lensless_place_.empty()) {
      return Status::Input(lensless_place_ + ": is missing, expected the file with the lens of " + camera_);
    }
    if (!imu_text_.empty()) {
      const Result<ImuSensor> imu = ParseImuSensor(imu_text_, imu_place_ + " as sensor.yaml");
      ALIDADE_RETURN_IF_ERROR(imu.status());
      calibration_.imu = *imu;
    }
    if (!camera_text_.empty()) {
      if (extrinsics_.empty()) {
        return Status::Input(camera_place_ + ": holds no extrinsics, expected T_cam_imu, T_imu_cam, body_T_" +
                             camera_ + " or extrinsicRotation and extrinsicTranslation by that name");
      }
      const Result<CameraSensor> camera =
          ParseCameraSensor(camera_text_ + extrinsics_ + offset_, camera_place_ + " as sensor.yaml");
      ALIDADE_RETURN_IF_ERROR(camera.status());
      calibration_.camera = *camera;
    }
    if (!calibration_.imu && !calibration_.camera) {
      return Status::Input(path + ": holds neither the noise of an IMU nor a camera");
    }
    return calibration_;
  }

 private:
  static Status Unknown(const std::string& path) {
    return Status::Input(
        path + ": found none of the keys of a calibration, expected one of Kalibr, OpenVINS, VINS or Basalt");
  }

  Status AddChainCamera(const std::string& path, const Node& camera) {
    if (!camera_text_.empty()) {
      return Status::Ok();
    }
    camera_place_ = path + ": " + camera_;
    const std::string lens = FlowText(camera["distortion_model"]);
    const std::string model = FlowText(camera["camera_model"]);
    const bool omni = model == "omni";
    const std::string name = omni               ? "mei"
                             : lens == "radtan" ? "radial-tangential"
                             : lens == "equi"   ? "equidistant"
                                                : lens;
    if (model == "ds" || model == "eucm") {
      if (!(lens == "none" || lens == "''")) {
        return Status::Input(camera_place_ + ": distortion_model: found '" + lens + "' with '" + model +
                             "', expected none");
      }
      return SetChainCamera(camera, model == "ds" ? "double-sphere" : "eucm", SplitIntrinsics(camera, 2));
    }
    if (model != "pinhole" && !(omni && lens == "radtan")) {
      return Status::Input(camera_place_ + ": camera_model: found '" + model + "' with '" + lens +
                           "', expected pinhole, omni with radtan, ds or eucm");
    }
    Result<Intrinsics> intrinsics = SplitIntrinsics(camera, omni ? 1 : 0);
    if (intrinsics.ok()) {
      for (const std::string& coefficient : FlowEntries(camera["distortion_coeffs"])) {
        intrinsics->coefficients.push_back(coefficient);
      }
    }
    return SetChainCamera(camera, name, intrinsics);
  }

  /// The four of the image plane, and coefficients of the lens.
  struct Intrinsics {
    std::vector<std::string> plane, coefficients;
  };

  /// Kalibr puts `count` coefficients of a lens that is no pinhole before fu, fv, cu, cv.
  [[nodiscard]] Result<Intrinsics> SplitIntrinsics(const Node& camera, std::size_t count) const {
    const std::vector<std::string> all = FlowEntries(camera["intrinsics"]);
    if (all.size() != count + 4) {
      return Status::Input(camera_place_ + ": intrinsics: found " + FlowText(camera["intrinsics"]) +
                           ", expected " + std::to_string(count + 4) + " numbers" +
                           (count > 0 ? ", the lens' before fu, fv, cu, cv" : ": fu, fv, cu, cv"));
    }
    const auto split = all.begin() + static_cast<std::ptrdiff_t>(count);
    return Intrinsics{{split, all.end()}, {all.begin(), split}};
  }

  Status SetChainCamera(const Node& camera, const std::string& name, const Result<Intrinsics>& intrinsics) {
    ALIDADE_RETURN_IF_ERROR(intrinsics.status());
    camera_text_ = CalibrationLine("resolution", FlowText(camera["resolution"])) +
                   CalibrationLine("intrinsics", FlowList(intrinsics->plane)) +
                   CalibrationLine("distortion_model", name) +
                   CalibrationLine("distortion_coefficients", FlowList(intrinsics->coefficients));
    for (const char* key : {"T_cam_imu", "T_imu_cam"}) {
      if (camera[key].IsDefined()) {
        extrinsics_ += CalibrationLine(key, FlowText(camera[key]));
      }
    }
    if (camera["timeshift_cam_imu"].IsDefined()) {
      offset_ = CalibrationLine("time_offset_s", FlowText(camera["timeshift_cam_imu"]));
    }
    return Status::Ok();
  }

  Status AddBasalt(const std::string& path, const Node& calibration) {
    const Result<BasaltTexts> texts = TranslateBasalt(path, calibration, camera_);
    ALIDADE_RETURN_IF_ERROR(texts.status());
    if (camera_text_.empty()) {
      camera_text_ = texts->camera;
      camera_place_ = path + ": " + camera_;
      extrinsics_ = texts->extrinsics;
      offset_ = texts->offset;
    }
    if (imu_text_.empty()) {
      imu_text_ = texts->imu;
      imu_place_ = path;
    }
    return Status::Ok();
  }

  Status AddKalibrImu(const std::string& path, const Node& imu) {
    if (!imu_text_.empty()) {
      return Status::Ok();
    }
    imu_place_ = path;
    for (const char* key : {"gyroscope_noise_density", "gyroscope_random_walk", "accelerometer_noise_density",
                            "accelerometer_random_walk"}) {
      imu_text_ += CalibrationLine(key, FlowText(imu[key]));
    }
    if (imu["update_rate"].IsDefined()) {
      imu_text_ += CalibrationLine("rate_hz", FlowText(imu["update_rate"]));
    }
    return Status::Ok();
  }

  Status AddVinsCamera(const std::string& path, const Node& root) {
    if (!camera_text_.empty()) {
      return Status::Ok();
    }
    const Result<std::string> text = TranslateVinsCamera(path, root);
    ALIDADE_RETURN_IF_ERROR(text.status());
    camera_text_ = *text;
    camera_place_ = path;
    return Status::Ok();
  }

  void AddVinsImu(const std::string& path, const Node& root) {
    if (imu_text_.empty()) {
      imu_text_ = TranslateVinsImu(root);
      imu_place_ = path;
      calibration_.imu_is_per_sample = true;
    }
  }

  /// True when the file holds any.
  bool AddVinsExtrinsics(const Node& root) {
    const VinsExtrinsics found = TranslateVinsExtrinsics(root, camera_);
    if (!found.extrinsics.empty() && extrinsics_.empty()) {
      extrinsics_ = found.extrinsics;
      if (!found.offset.empty()) {
        offset_ = found.offset;
      }
    }
    return !found.extrinsics.empty();
  }

  std::string camera_;
  std::string imu_text_, imu_place_;
  std::string camera_text_, camera_place_;
  std::string lensless_place_;  ///< a key that names the lens of other cameras alone
  std::string extrinsics_, offset_;
  ImportedCalibration calibration_;
};

}  // namespace

Result<ImportedCalibration> ImportCalibration(const std::vector<std::string>& paths,
                                              const std::string& camera) {
  Importer importer(camera);
  for (const std::string& path : paths) {
    ALIDADE_RETURN_IF_ERROR(importer.Add(path));
  }
  return importer.Finish(paths.empty() ? std::string("--calibration") : paths.front());
}

ImuNoise DensitiesOf(const ImuNoise& per_sample, double rate_hz) {
  const double root = std::sqrt(rate_hz);
  return {per_sample.gyro_noise_density_radps_sqrthz / root,
          per_sample.accel_noise_density_mps2_sqrthz / root, per_sample.gyro_random_walk_radps2_sqrthz / root,
          per_sample.accel_random_walk_mps3_sqrthz / root};
}

}  // namespace alidade
