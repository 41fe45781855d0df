#include "eval/dataset/sensor_file.h"

#include <Eigen/Core>

#include "eval/files/output_file.h"
#include "eval/files/suggest.h"

namespace alidade {
namespace {

constexpr double kMaxRigidityError = 1e-3;
// Below this a rotation is kept as it is, so that writing and reading is exact.
constexpr double kRoundingError = 1e-14;

/// Checks that 16 row-major numbers are a rigid transform; the empty text, or what is wrong with them.
std::string MakeRigid(const std::vector<double>& m, Pose* transform) {
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) {
    matrix(i / 4, i % 4) = m[static_cast<size_t>(i)];
  }
  if (!matrix.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), 1e-9)) {
    return "last row 0 0 0 1 (row-major order)";
  }
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const double error = (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  const double determinant = rotation.determinant();
  if (!(error <= kMaxRigidityError) || determinant < 0) {
    return "a rigid transform: the determinant of its rotation is " + ShortestDouble(determinant) +
           " (expected 1) and its orthogonality error " + ShortestDouble(error) + " (at most 1e-3)";
  }
  transform->rotation = error <= kRoundingError ? rotation : so3::Normalize(rotation);
  transform->translation = matrix.topRightCorner<3, 1>();
  return {};
}

}  // namespace

Result<SensorFile> SensorFile::Make(const Result<YAML::Node>& root, const std::string& path,
                                    const std::string& sensor_type) {
  if (!root.ok()) {
    return root.status();
  }
  SensorFile file(path, *root);
  if (file.Has("sensor_type") && file.root_["sensor_type"].as<std::string>("") != sensor_type) {
    return file.Fault("sensor_type", "'" + sensor_type + "'");
  }
  return file;
}

Status SensorFile::Fault(const char* key, const std::string& expected) const {
  if (!Has(key)) {
    std::vector<std::string> keys;
    for (const auto& entry : root_) {
      keys.push_back(entry.first.Scalar());
    }
    const std::string nearest = NearestName(key, keys);
    return Status::Input(path_ + ": " + key + ": is missing, expected " + expected +
                         (nearest.empty() ? "" : " (found a key '" + nearest + "')"));
  }
  return Status::Input(YamlPlace(path_, root_[key]) + ": " + key + ": found " + YamlText(root_[key]) +
                       ", expected " + expected);
}

Status SensorFile::ReadReal(const char* key, double min, double* value) const {
  if (!Has(key)) {
    return Fault(key, "a number");
  }
  if (const Status parsed = ParseYamlReal(root_[key], value); !parsed.ok()) {
    return Fault(key, parsed.message());
  }
  return *value >= min ? Status::Ok() : Fault(key, "a number of at least " + ShortestDouble(min));
}

Status SensorFile::ReadReals(const char* key, size_t count, std::vector<double>* values) const {
  if (!Has(key)) {
    return Fault(key, "a list of numbers");
  }
  if (const Status parsed = ParseYamlReals(root_[key], count, values); !parsed.ok()) {
    return Fault(key, parsed.message());
  }
  return Status::Ok();
}

Status SensorFile::ReadRate(std::optional<double>* rate_hz) const {
  if (!Has("rate_hz")) {
    return Status::Ok();
  }
  double rate = 0;
  ALIDADE_RETURN_IF_ERROR(ReadReal("rate_hz", 0, &rate));
  if (rate <= 0) {
    return Fault("rate_hz", "a positive rate [Hz]");
  }
  *rate_hz = rate;
  return Status::Ok();
}

Status SensorFile::ReadTransform(const char* key, Pose* transform) const {
  const YAML::Node node = root_[key];
  const YAML::Node data = node.IsMap() ? node["data"] : node;
  std::vector<double> numbers;
  if (data.IsDefined() && data.IsSequence() && data.size() == 4 && data[0].IsSequence()) {
    for (const YAML::Node& row : data) {
      std::vector<double> entries;
      if (const Status parsed = ParseYamlReals(row, 4, &entries); !parsed.ok()) {
        return Fault(key, "four rows of four numbers; a row is not " + parsed.message());
      }
      numbers.insert(numbers.end(), entries.begin(), entries.end());
    }
  } else if (!data.IsDefined()) {
    return Fault(key, "'data' with 16 numbers, row-major");
  } else if (const Status parsed = ParseYamlReals(data, 16, &numbers); !parsed.ok()) {
    return Fault(key, parsed.message() + ", a row-major 4x4 transform");
  }
  const std::string wrong = MakeRigid(numbers, transform);
  return wrong.empty() ? Status::Ok() : Fault(key, wrong);
}

}  // namespace alidade
