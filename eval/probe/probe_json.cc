#include "eval/probe/probe_json.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/imu_step.h"

namespace alidade::probe {
namespace {

constexpr double kQuaternionNormTolerance = 1e-6;

[[noreturn]] void Fail(const std::string& name, const Json& found, const std::string& expected) {
  std::string text = found.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > 60) {
    text = text.substr(0, 57) + "...";
  }
  throw CaseError{name + ": found " + text + ", expected " + expected};
}

TimeNs Stamp(const Json& value, const std::string& name) {
  if (!value.is_number_integer()) {
    Fail(name, value, "integer nanoseconds");
  }
  return value.get<TimeNs>();
}

}  // namespace

const Json& Member(const Json& object, const std::string& key) {
  if (!object.is_object()) {
    Fail("case", object, "an object with \"" + key + "\"");
  }
  const auto found = object.find(key);
  if (found == object.end()) {
    throw CaseError{key + ": missing"};
  }
  return *found;
}

double Number(const Json& value, const std::string& name) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    Fail(name, value, "a finite number");
  }
  return value.get<double>();
}

Eigen::VectorXd Vector(const Json& value, const std::string& name, int size) {
  if (!value.is_array() || value.size() != static_cast<size_t>(size)) {
    Fail(name, value, "an array of " + std::to_string(size) + " numbers");
  }
  Eigen::VectorXd vector(size);
  for (int i = 0; i < size; ++i) {
    vector[i] = Number(value[static_cast<size_t>(i)], name);
  }
  return vector;
}

Eigen::Matrix3d Rotation(const Json& value, const std::string& name) {
  const Eigen::Vector4d wxyz = Vector(value, name, 4);
  if (std::abs(wxyz.norm() - 1) > kQuaternionNormTolerance) {
    Fail(name, value, "a unit quaternion w, x, y, z");
  }
  return Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized().toRotationMatrix();
}

int Index(const Json& value, const std::string& name, int size) {
  const std::string expected = "an integer from 0 to " + std::to_string(size - 1);
  if (!value.is_number_integer()) {
    Fail(name, value, expected);
  }
  const std::int64_t index = value.get<std::int64_t>();
  if (index < 0 || index >= size) {
    Fail(name, value, expected);
  }
  return static_cast<int>(index);
}

std::vector<Pose> Views(const Json& object) {
  const Json& views = Member(object, "views");
  if (!views.is_array() || views.size() < 2) {
    Fail("views", views, "an array of at least two poses {q_wxyz, p}");
  }
  std::vector<Pose> poses;
  for (size_t i = 0; i < views.size(); ++i) {
    const std::string name = "views[" + std::to_string(i) + "]";
    poses.push_back({Rotation(Member(views[i], "q_wxyz"), name + ".q_wxyz"),
                     Vector(Member(views[i], "p"), name + ".p", 3)});
  }
  return poses;
}

std::vector<Eigen::Vector2d> Observations(const Json& object, size_t count) {
  const Json& observations = Member(object, "obs");
  if (!observations.is_array() || observations.size() != count) {
    Fail("obs", observations, std::to_string(count) + " pairs [u, v], one a view");
  }
  std::vector<Eigen::Vector2d> z;
  for (size_t i = 0; i < count; ++i) {
    z.emplace_back(Vector(observations[i], "obs[" + std::to_string(i) + "]", 2));
  }
  return z;
}

ImuNoise Noise(const Json& object) {
  const Json& noise = Member(object, "noise");
  const auto density = [&noise](const char* key) {
    const double value = Number(Member(noise, key), std::string("noise.") + key);
    if (value < 0) {
      Fail(std::string("noise.") + key, noise[key], "a number of at least 0");
    }
    return value;
  };
  return {density("sg"), density("sa"), density("swg"), density("swa")};
}

std::vector<ImuSample> ImuSamples(const Json& object) {
  const Json& imu = Member(object, "imu");
  if (!imu.is_array() || imu.size() < 2) {
    Fail("imu", imu, "an array of at least two samples {t, w, a}");
  }
  std::vector<ImuSample> samples;
  for (size_t i = 0; i < imu.size(); ++i) {
    const std::string name = "imu[" + std::to_string(i) + "]";
    ImuSample sample;
    sample.stamp_ns = Stamp(Member(imu[i], "t"), name + ".t");
    sample.gyro = Vector(Member(imu[i], "w"), name + ".w", 3);
    sample.accel = Vector(Member(imu[i], "a"), name + ".a", 3);
    if (!samples.empty() && sample.stamp_ns <= samples.back().stamp_ns) {
      Fail(name + ".t", imu[i]["t"], "a stamp later than " + std::to_string(samples.back().stamp_ns));
    }
    samples.push_back(sample);
  }
  SetCurvatures(samples);
  return samples;
}

Json VectorToJson(const Eigen::Ref<const Eigen::VectorXd>& vector) {
  Json array = Json::array();
  for (Eigen::Index i = 0; i < vector.size(); ++i) {
    array.push_back(vector[i]);
  }
  return array;
}

Json ToJson(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    rows.push_back(VectorToJson(matrix.row(i).transpose()));
  }
  return rows;
}

Json QuaternionToJson(const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  q.normalize();
  const double sign = q.w() < 0 ? -1 : 1;
  return Json::array({sign * q.w(), sign * q.x(), sign * q.y(), sign * q.z()});
}

}  // namespace alidade::probe
