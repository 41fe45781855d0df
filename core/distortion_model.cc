#include "core/distortion_model.h"

#include <cmath>
#include <numbers>
#include <string>

namespace alidade {
namespace {

/// Of coefficients in the right number.
Status CheckRanges(DistortionModel model, const std::vector<double>& coefficients) {
  const auto fault = [](const std::string& expected, double found) {
    return Status::Input("distortion_coefficients: " + expected + ", found " + std::to_string(found));
  };
  constexpr double kMaxMirror = 10;
  constexpr double kMaxStretch = 100;
  switch (model) {
    case DistortionModel::kFov:
      if (coefficients[0] <= 1e-6 || coefficients[0] >= std::numbers::pi) {
        return fault("fov w must lie in (0, pi)", coefficients[0]);
      }
      break;
    case DistortionModel::kMei:
      if (coefficients[0] < 0 || coefficients[0] > kMaxMirror) {
        return fault("mei xi must lie in [0, 10]", coefficients[0]);
      }
      break;
    case DistortionModel::kDoubleSphere:
      if (coefficients[0] <= -1 || coefficients[0] > 1) {
        return fault("double-sphere xi must lie in (-1, 1]", coefficients[0]);
      }
      if (coefficients[1] < 0 || coefficients[1] > 1) {
        return fault("double-sphere alpha must lie in [0, 1]", coefficients[1]);
      }
      break;
    case DistortionModel::kEucm:
      if (coefficients[0] < 0 || coefficients[0] > 1) {
        return fault("eucm alpha must lie in [0, 1]", coefficients[0]);
      }
      if (coefficients[1] <= 0 || coefficients[1] > kMaxStretch) {
        return fault("eucm beta must lie in (0, 100]", coefficients[1]);
      }
      break;
    case DistortionModel::kNone:
    case DistortionModel::kRadialTangential:
    case DistortionModel::kEquidistant:
      break;
  }
  return Status::Ok();
}

}  // namespace

std::optional<DistortionModel> ParseDistortionModel(std::string_view name) {
  for (const DistortionModel model :
       {DistortionModel::kNone, DistortionModel::kRadialTangential, DistortionModel::kEquidistant,
        DistortionModel::kFov, DistortionModel::kMei, DistortionModel::kDoubleSphere,
        DistortionModel::kEucm}) {
    if (name == ToString(model)) {
      return model;
    }
  }
  return std::nullopt;
}

std::string_view ToString(DistortionModel model) {
  switch (model) {
    case DistortionModel::kRadialTangential:
      return "radial-tangential";
    case DistortionModel::kEquidistant:
      return "equidistant";
    case DistortionModel::kFov:
      return "fov";
    case DistortionModel::kMei:
      return "mei";
    case DistortionModel::kDoubleSphere:
      return "double-sphere";
    case DistortionModel::kEucm:
      return "eucm";
    case DistortionModel::kNone:
      break;
  }
  return "none";
}

int CoefficientCount(DistortionModel model) {
  switch (model) {
    case DistortionModel::kRadialTangential:
    case DistortionModel::kEquidistant:
      return 4;
    case DistortionModel::kFov:
      return 1;
    case DistortionModel::kMei:
      return 5;
    case DistortionModel::kDoubleSphere:
    case DistortionModel::kEucm:
      return 2;
    case DistortionModel::kNone:
      break;
  }
  return 0;
}

Status CheckCoefficients(DistortionModel model, const std::vector<double>& coefficients) {
  const int expected = CoefficientCount(model);
  if (static_cast<int>(coefficients.size()) != expected) {
    return Status::Input("distortion_coefficients: model " + std::string(ToString(model)) + " takes " +
                         std::to_string(expected) + ", found " + std::to_string(coefficients.size()));
  }
  for (size_t i = 0; i < coefficients.size(); ++i) {
    if (!std::isfinite(coefficients[i])) {
      return Status::Input("distortion_coefficients: entry " + std::to_string(i + 1) + " is not finite");
    }
  }
  return CheckRanges(model, coefficients);
}

}  // namespace alidade
