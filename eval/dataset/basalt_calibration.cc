#include "eval/dataset/basalt_calibration.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "eval/dataset/calibration_text.h"
#include "eval/files/output_file.h"

namespace alidade {
namespace {

using Node = YAML::Node;

/// Numbers of a file that name their place when they are none.
class BasaltReader {
 public:
  BasaltReader(std::string path, const Node& value0, const std::string& camera)
      : path_(std::move(path)), value0_(value0), camera_(camera) {}

  Result<BasaltTexts> Translate() {
    if (camera_.size() != 4 || camera_.compare(0, 3, "cam") != 0 || camera_[3] < '0' || camera_[3] > '9') {
      return Fault("intrinsics", "a camera cam0 to cam9, asked for " + camera_);
    }
    index_ = static_cast<std::size_t>(camera_[3] - '0');
    BasaltTexts texts;
    ALIDADE_RETURN_IF_ERROR(AddLens(&texts.camera));
    ALIDADE_RETURN_IF_ERROR(AddExtrinsics(&texts.extrinsics));
    if (value0_["cam_time_offset_ns"].IsDefined()) {
      double offset_ns = 0;
      ALIDADE_RETURN_IF_ERROR(Read(value0_, "", "cam_time_offset_ns", &offset_ns));
      texts.offset = CalibrationLine("time_offset_s", ShortestDouble(1e-9 * offset_ns));
    }
    ALIDADE_RETURN_IF_ERROR(AddImu(&texts.imu));
    return texts;
  }

 private:
  [[nodiscard]] Status Fault(const std::string& key, const std::string& expected) const {
    return Status::Input(path_ + ": value0." + key + ": expected " + expected);
  }

  /// The entry of the chosen camera in a list of value0's.
  [[nodiscard]] std::optional<Node> OfCamera(const char* key) const {
    const Node list = value0_[key];
    if (!list.IsDefined() || !list.IsSequence() || index_ >= list.size()) {
      return std::nullopt;
    }
    return list[index_];
  }

  Status Read(const Node& map, const std::string& place, const std::string& key, double* value) const {
    const Node node = map.IsMap() ? map[key] : Node(YAML::NodeType::Undefined);
    const bool is_number = node.IsDefined() && node.IsScalar() && YAML::convert<double>::decode(node, *value);
    return is_number && std::isfinite(*value) ? Status::Ok() : Fault(place + key, "a number");
  }

  Status AddLens(std::string* text) const {
    struct Lens {
      const char* type;
      const char* model;
      std::vector<const char*> coefficients;
    };
    static const std::array<Lens, 4> kLenses = {{{"ds", "double-sphere", {"xi", "alpha"}},
                                                 {"eucm", "eucm", {"alpha", "beta"}},
                                                 {"kb4", "equidistant", {"k1", "k2", "k3", "k4"}},
                                                 {"pinhole", "none", {}}}};
    const std::optional<Node> camera = OfCamera("intrinsics");
    const std::string place = "intrinsics[" + std::to_string(index_) + "].";
    if (!camera || !camera->IsMap()) {
      return Fault(place + "camera_type", "the lens of " + camera_);
    }
    const std::string type =
        (*camera)["camera_type"].IsDefined() ? (*camera)["camera_type"].as<std::string>("") : "";
    for (const Lens& lens : kLenses) {
      if (type != lens.type) {
        continue;
      }
      const Node values = (*camera)["intrinsics"];
      if (!values.IsDefined() || !values.IsMap()) {
        return Fault(place + "intrinsics", "fx, fy, cx, cy and the lens' coefficients");
      }
      std::string plane, coefficients;
      ALIDADE_RETURN_IF_ERROR(ReadList(values, place + "intrinsics.", {"fx", "fy", "cx", "cy"}, &plane));
      ALIDADE_RETURN_IF_ERROR(ReadList(values, place + "intrinsics.", lens.coefficients, &coefficients));
      const std::optional<Node> size = OfCamera("resolution");
      if (!size || !size->IsSequence() || size->size() != 2) {
        return Fault("resolution[" + std::to_string(index_) + "]", "width and height [px]");
      }
      *text = CalibrationLine("resolution", "[" + (*size)[0].as<std::string>("''") + ", " +
                                                (*size)[1].as<std::string>("''") + "]") +
              CalibrationLine("intrinsics", plane) + CalibrationLine("distortion_model", lens.model) +
              CalibrationLine("distortion_coefficients", coefficients);
      return Status::Ok();
    }
    return Fault(place + "camera_type", "one of ds, eucm, kb4, pinhole, found '" + type + "'");
  }

  Status ReadList(const Node& map, const std::string& place, const std::vector<const char*>& keys,
                  std::string* text) const {
    std::string list;
    for (const char* key : keys) {
      double value = 0;
      ALIDADE_RETURN_IF_ERROR(Read(map, place, key, &value));
      list += (list.empty() ? "" : ", ") + ShortestDouble(value);
    }
    *text = "[" + list + "]";
    return Status::Ok();
  }

  Status AddExtrinsics(std::string* text) const {
    const std::optional<Node> pose = OfCamera("T_imu_cam");
    if (!pose) {
      return Status::Ok();
    }
    const std::string place = "T_imu_cam[" + std::to_string(index_) + "].";
    Eigen::Vector3d p;
    Eigen::Vector4d q;  // x y z w
    constexpr std::array<const char*, 3> kPosition = {"px", "py", "pz"};
    constexpr std::array<const char*, 4> kQuaternion = {"qx", "qy", "qz", "qw"};
    for (int i = 0; i < 3; ++i) {
      ALIDADE_RETURN_IF_ERROR(Read(*pose, place, kPosition[static_cast<std::size_t>(i)], &p[i]));
    }
    for (int i = 0; i < 4; ++i) {
      ALIDADE_RETURN_IF_ERROR(Read(*pose, place, kQuaternion[static_cast<std::size_t>(i)], &q[i]));
    }
    constexpr double kUnitTolerance = 1e-3;  // of files with few digits
    if (!(std::abs(q.norm() - 1) < kUnitTolerance)) {
      return Fault(place + "qx", "a quaternion of unit length, found length " + ShortestDouble(q.norm()));
    }
    const Eigen::Matrix3d R = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
    std::string rows;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        rows += ShortestDouble(R(i, j)) + ", ";
      }
      rows += ShortestDouble(p[i]) + ", ";
    }
    *text = CalibrationLine("T_imu_cam", "[" + rows + "0, 0, 0, 1]");
    return Status::Ok();
  }

  Status AddImu(std::string* text) const {
    constexpr std::array<std::pair<const char*, const char*>, 4> kNoises = {
        {{"gyro_noise_std", "gyroscope_noise_density"},
         {"gyro_bias_std", "gyroscope_random_walk"},
         {"accel_noise_std", "accelerometer_noise_density"},
         {"accel_bias_std", "accelerometer_random_walk"}}};
    if (!value0_["gyro_noise_std"].IsDefined()) {
      return Status::Ok();
    }
    std::string lines;
    for (const auto& [key, line] : kNoises) {
      const Node axes = value0_[key];
      double squared = 0;
      if (!axes.IsDefined() || !axes.IsSequence() || axes.size() != 3) {
        return Fault(key, "three numbers");
      }
      for (const Node& axis : axes) {
        double value = 0;
        if (!axis.IsScalar() || !YAML::convert<double>::decode(axis, value) || !std::isfinite(value)) {
          return Fault(key, "three numbers");
        }
        squared += value * value / 3;
      }
      lines += CalibrationLine(line, ShortestDouble(std::sqrt(squared)));
    }
    if (value0_["imu_update_rate"].IsDefined()) {
      double rate_hz = 0;
      ALIDADE_RETURN_IF_ERROR(Read(value0_, "", "imu_update_rate", &rate_hz));
      lines += CalibrationLine("rate_hz", ShortestDouble(rate_hz));
    }
    *text = lines;
    return Status::Ok();
  }

  std::string path_;
  Node value0_;
  std::string camera_;
  std::size_t index_ = 0;
};

}  // namespace

Result<BasaltTexts> TranslateBasalt(const std::string& path, const YAML::Node& value0,
                                    const std::string& camera) {
  return BasaltReader(path, value0, camera).Translate();
}

}  // namespace alidade
