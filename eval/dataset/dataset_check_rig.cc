#include "eval/dataset/dataset_check_rig.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/format.h"
#include "core/numbers.h"
#include "eval/dataset/clock_shift.h"
#include "eval/dataset/dataset_camera.h"
#include "eval/dataset/dataset_findings.h"
#include "eval/dataset/sensor_yaml.h"

namespace alidade {
namespace {

void AddFinding(bool impossible, std::string text, Findings* findings) {
  if (impossible) {
    findings->Error(std::move(text));
  } else {
    findings->Warning(std::move(text));
  }
}

/// Where a sensor's calibration stands: its sheet, or the sensor where that may be any file.
std::string SheetOf(const Dataset& dataset, const std::string& sensor) {
  return dataset.has_sheets ? sensor + "/sensor.yaml" : sensor;
}

/// One camera of the rig.
struct CameraSheet {
  std::string name;
  const CameraModel& camera;
  const Pose& T_BC;
  double time_offset_s;
};

bool IsRectilinear(DistortionModel model) {
  return model == DistortionModel::kNone || model == DistortionModel::kRadialTangential;
}

/// Angles across the image [rad], the lens' distortion aside: rectilinear, or of the other lenses
/// equidistant.
struct Field {
  double across;  ///< the longer axis
  double within;  ///< the axis that the lens surely fills: the image circle of other lenses may end there
};

Field FieldOf(const CameraModel& camera) {
  const Eigen::Vector4d& intrinsics = camera.intrinsics();
  if (IsRectilinear(camera.model())) {
    const double across = std::max(2 * std::atan(0.5 * camera.width_px() / intrinsics[0]),
                                   2 * std::atan(0.5 * camera.height_px() / intrinsics[1]));
    return {across, across};
  }
  const auto [shorter, longer] = std::minmax({camera.width_px(), camera.height_px()});
  return {longer / camera.mean_focal_px(), shorter / camera.mean_focal_px()};
}

void CheckField(const CameraSheet& sheet, Findings* findings) {
  // Telescopes have a degree. The widest rectilinear lenses reach 130 degrees, the widest others 280; a
  // stereographic image of those is as wide as an equidistant one of 480.
  constexpr double kLeastDeg = 1, kNarrowDeg = 10;
  const bool rectilinear = IsRectilinear(sheet.camera.model());
  const double wide_deg = rectilinear ? 140 : 360;
  const double most_deg = rectilinear ? 170 : 540;
  const Field field = FieldOf(sheet.camera);
  const bool narrow = field.across * kDegreesPerRadian < kNarrowDeg;
  const double field_deg = (narrow ? field.across : field.within) * kDegreesPerRadian;
  if (!narrow && field_deg <= wide_deg) {
    return;
  }
  const Eigen::Vector4d& intrinsics = sheet.camera.intrinsics();
  AddFinding(
      field_deg < kLeastDeg || field_deg > most_deg,
      Format("%s: intrinsics: found fu %.6g px, fv %.6g px for %d x %d px, a field of view of %.3g deg, "
             "expected %.0f to %.0f deg: focal lengths in another unit, or of another resolution?",
             sheet.name.c_str(), intrinsics[0], intrinsics[1], sheet.camera.width_px(),
             sheet.camera.height_px(), field_deg, kNarrowDeg, wide_deg),
      findings);
}

void CheckPixels(const CameraSheet& sheet, Findings* findings) {
  // Pixels are square; every second line or column of them, at most, is left out.
  constexpr double kUnequal = 1.2;
  constexpr double kMostUnequal = 3;
  const Eigen::Vector4d& intrinsics = sheet.camera.intrinsics();
  const double ratio = std::max(intrinsics[0] / intrinsics[1], intrinsics[1] / intrinsics[0]);
  if (ratio > kUnequal) {
    AddFinding(ratio > kMostUnequal,
               Format("%s: intrinsics: found fu %.6g px and fv %.6g px, expected about equal focal lengths",
                      sheet.name.c_str(), intrinsics[0], intrinsics[1]),
               findings);
  }
}

void CheckPrincipalPoint(const CameraSheet& sheet, Findings* findings) {
  const double width = sheet.camera.width_px(), height = sheet.camera.height_px();
  const double cu = sheet.camera.intrinsics()[2], cv = sheet.camera.intrinsics()[3];
  // No error at any distance: an image may be a small region that is read out of a large sensor.
  if (cu < 0 || cu > width || cv < 0 || cv > height) {
    findings->Warning(Format(
        "%s: intrinsics: found the principal point cu %.6g px, cv %.6g px, expected it in the image of "
        "%.0f x %.0f px",
        sheet.name.c_str(), cu, cv, width, height));
  }
}

/// How far a sensor may be from the IMU [m].
struct ArmLimits {
  double unlikely;
  double impossible;
};
// Ships and trains are 400 m long, and their IMU is near the middle.
constexpr double kHalfShipM = 200;
// A camera that is to be rigid with the IMU is beside it, on a car at most at the other end of the roof.
constexpr ArmLimits kCameraArm = {3, kHalfShipM};
// The mast of a car or a small boat.
constexpr ArmLimits kAntennaArm = {10, kHalfShipM};

void CheckArm(const std::string& place, const Eigen::Vector3d& arm, const ArmLimits& limits,
              Findings* findings) {
  const double length = arm.norm();
  if (length > limits.unlikely) {
    AddFinding(
        length > limits.impossible,
        Format("%s: found [%.6g, %.6g, %.6g], %.4g m from the IMU, expected at most %.0f m: in mm or cm?",
               place.c_str(), arm.x(), arm.y(), arm.z(), length, limits.unlikely),
        findings);
  }
}

void CheckCameraSheet(const CameraSheet& sheet, Findings* findings) {
  CheckField(sheet, findings);
  CheckPixels(sheet, findings);
  CheckPrincipalPoint(sheet, findings);
  CheckArm(sheet.name + ": T_BS: translation", sheet.T_BC.translation, kCameraArm, findings);
  // Clocks may be seconds apart; an offset that leaves no common time is reported by CheckSpan.
  if (std::abs(sheet.time_offset_s) > kMostCameraOffsetS) {
    findings->Warning(Format("%s: time_offset_s: found %g s, expected within +-%g s: in ms?",
                             sheet.name.c_str(), sheet.time_offset_s, kMostCameraOffsetS));
  }
}

/// Of a receiver, whose clock may count from elsewhere or in another scale than the IMU's. imu: none when its
/// time is not known (ImuSpan); nothing is compared then.
void CheckReceiverOffset(const std::string& sheet, double offset_s, const std::optional<TimeSpan>& imu,
                         Findings* findings) {
  constexpr double kSameClockS = 1;
  if (!imu) {
    return;
  }
  const std::vector<ClockShift> known = KnownClockShifts(imu->first_ns);
  const bool expected = std::abs(offset_s) <= kSameClockS ||
                        std::abs(offset_s) > std::abs(SecondsBetween(0, known.back().shift_ns)) ||
                        std::any_of(known.begin(), known.end(), [offset_s](const ClockShift& shift) {
                          return std::abs(offset_s - SecondsBetween(0, shift.shift_ns)) <= kSameClockS;
                        });
  if (!expected) {
    findings->Warning(
        Format("%s: time_offset_s: found %g s, expected within %g s of 0 or of a difference of clocks (leap "
               "seconds, whole hours)",
               sheet.c_str(), offset_s, kSameClockS));
  }
}

}  // namespace

void CheckAntenna(const Dataset& dataset, const std::string& sensor, const Eigen::Vector3d& p_BA,
                  double time_offset_s, Findings* findings) {
  const std::string sheet = SheetOf(dataset, sensor);
  CheckArm(sheet + ": p_BA", p_BA, kAntennaArm, findings);
  CheckReceiverOffset(sheet, time_offset_s, ImuSpan(dataset), findings);
}

void CheckRig(const Dataset& dataset, Findings* findings) {
  const RigCalibration& rig = dataset.rig;
  if (HasCamera(dataset)) {
    CheckCameraSheet({SheetOf(dataset, "cam0"), rig.camera, rig.T_BC, rig.camera_time_offset_s}, findings);
  }
  for (std::size_t k = 0; k < dataset.extra_cameras.size(); ++k) {
    const ExtraCamera& extra = dataset.extra_cameras[k];
    const std::string name = "cam" + std::to_string(k + 1);
    CheckCameraSheet({SheetOf(dataset, name), extra.camera, extra.T_BC, extra.camera_time_offset_s},
                     findings);
  }
  if (dataset.gnss != nullptr) {
    CheckAntenna(dataset, "gnss0", rig.gnss.p_BA, rig.gnss.time_offset_s, findings);
  }
}

}  // namespace alidade
