#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/navigation_state.h"
#include "core/status.h"
#include "eval/files/strict_yaml.h"

namespace alidade {

/// The keys of one sensor.yaml, with its path for messages. Errors (kInput) name file:line:column, key, value
/// and expectation; for a missing key also the nearest existing key.
class SensorFile {
 public:
  /// Errors: that of `root`; a key sensor_type with another value.
  static Result<SensorFile> Make(const Result<YAML::Node>& root, const std::string& path,
                                 const std::string& sensor_type);

  [[nodiscard]] bool Has(const char* key) const { return root_[key].IsDefined(); }
  [[nodiscard]] YAML::Node operator[](const char* key) const { return root_[key]; }
  [[nodiscard]] Status Fault(const char* key, const std::string& expected) const;

  Status ReadReal(const char* key, double min, double* value) const;
  /// `count` numbers, or any number of them when it is 0.
  Status ReadReals(const char* key, size_t count, std::vector<double>* values) const;
  /// Key rate_hz [Hz]: positive, or absent.
  Status ReadRate(std::optional<double>* rate_hz) const;
  /// The sixteen row-major numbers of a 4x4: {cols, rows, data} as EuRoC and OpenCV write it, or a list of
  /// four rows, or a flat list.
  Status ReadTransform(const char* key, Pose* transform) const;

 private:
  SensorFile(std::string path, const YAML::Node& root) : path_(std::move(path)), root_(root) {}

  std::string path_;
  YAML::Node root_;
};

}  // namespace alidade
