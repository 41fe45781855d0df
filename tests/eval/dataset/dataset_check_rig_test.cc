#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <ostream>

#include "tests/eval/dataset/healthy_dataset.h"

// Calibrations that no rig known to `check` has.

namespace alidade {
namespace {

using test::Complaints;
using test::Healthy;
using test::WithGnss;
using testing::HasSubstr;
using Severity = DatasetFinding::Severity;

CameraModel Lens(DistortionModel model, const Eigen::Vector4d& intrinsics,
                 const std::vector<double>& coefficients) {
  return CameraModel::Create(model, intrinsics, coefficients, 640, 480).value();
}

std::function<void(Dataset*)> WithIntrinsics(double fu, double fv, double cu, double cv) {
  return [=](Dataset* dataset) { dataset->rig.camera = Lens(DistortionModel::kNone, {fu, fv, cu, cv}, {}); };
}

std::function<void(Dataset*)> WithFisheye(double focal) {
  return [=](Dataset* dataset) {
    dataset->rig.camera = Lens(DistortionModel::kEquidistant, {focal, focal, 320, 240}, {0, 0, 0, 0});
  };
}

std::function<void(Dataset*)> WithCameraAt(double x, double y, double z) {
  return [=](Dataset* dataset) { dataset->rig.T_BC.translation = Eigen::Vector3d(x, y, z); };
}

struct RigCase {
  const char* story;
  std::function<void(Dataset*)> change;
  Severity severity;
  std::vector<std::string> said;
};

std::ostream& operator<<(std::ostream& stream, const RigCase& c) {
  return stream << c.story;
}

class ImplausibleRig : public testing::TestWithParam<RigCase> {};

TEST_P(ImplausibleRig, IsNamedWithKeyValueAndExpectation) {
  Dataset dataset = WithGnss(0, 0);
  dataset.rig.fixes = {{Eigen::Vector3d::Zero(), 0, std::nullopt}};
  GetParam().change(&dataset);
  const std::string complaints = Complaints(dataset, GetParam().severity);
  for (const std::string& text : GetParam().said) {
    EXPECT_THAT(complaints, HasSubstr(text));
  }
  const Severity other = GetParam().severity == Severity::kError ? Severity::kWarning : Severity::kError;
  EXPECT_THAT(Complaints(dataset, other), testing::Not(HasSubstr(GetParam().said[0])));
}

const RigCase kRigCases[] = {
    {"focal length in mm",
     WithIntrinsics(4, 4, 320, 240),
     Severity::kError,
     {"cam0/sensor.yaml: intrinsics: found fu 4 px, fv 4 px for 640 x 480 px", "field of view of 179 deg",
      "expected 10 to 140 deg"}},
    {"focal length of a telescope", WithIntrinsics(4e5, 4e5, 320, 240), Severity::kError, {"0.0917 deg"}},
    {"focal length of a long lens", WithIntrinsics(1e4, 1e4, 320, 240), Severity::kWarning, {"3.67 deg"}},
    {"very wide pinhole", WithIntrinsics(100, 100, 320, 240), Severity::kWarning, {"145 deg"}},
    {"fisheye beyond the sphere", WithFisheye(30), Severity::kError, {"expected 10 to 360 deg"}},
    {"fisheye of nearly the sphere", WithFisheye(75), Severity::kWarning, {"367 deg"}},
    {"focal lengths of two lenses",
     WithIntrinsics(300, 1200, 320, 240),
     Severity::kError,
     {"fu 300 px and fv 1200 px, expected about equal"}},
    {"stretched pixels", WithIntrinsics(400, 600, 320, 240), Severity::kWarning, {"fu 400 px and fv 600 px"}},
    {"principal point beside the image",
     WithIntrinsics(400, 400, -50, 240),
     Severity::kWarning,
     {"principal point cu -50 px, cv 240 px, expected it in the image of 640 x 480 px"}},
    {"region of a large sensor", WithIntrinsics(400, 400, 320, 4000), Severity::kWarning, {"cv 4000 px"}},
    {"camera 300 m from the IMU",
     WithCameraAt(0, 0, 300),
     Severity::kError,
     {"cam0/sensor.yaml: T_BS: translation: found [0, 0, 300], 300 m from the IMU, expected at most 3 m"}},
    {"camera on a ship", WithCameraAt(0, 60, 80), Severity::kWarning, {"found [0, 60, 80], 100 m"}},
    {"camera on the bonnet",
     WithCameraAt(5, 0, 0),
     Severity::kWarning,
     {"T_BS: translation: found [5, 0, 0]"}},
    {"second camera, far away",
     [](Dataset* dataset) {
       ExtraCamera& extra = dataset->extra_cameras.emplace_back();
       extra.camera = dataset->rig.camera;
       extra.T_BC.translation.x() = 400;
     },
     Severity::kError,
     {"cam1/sensor.yaml: T_BS: translation"}},
    {"time offset longer than the sequence",
     [](Dataset* dataset) { dataset->rig.camera_time_offset_s = -12; },
     Severity::kWarning,
     {"cam0/sensor.yaml: time_offset_s: found -12 s, expected within +-10 s"}},
    {"antenna on a ship",
     [](Dataset* dataset) { dataset->rig.gnss.p_BA = Eigen::Vector3d(0, 60, 80); },
     Severity::kWarning,
     {"gnss0/sensor.yaml: p_BA: found [0, 60, 80], 100 m from the IMU, expected at most 10 m"}},
    {"antenna in mm",
     [](Dataset* dataset) { dataset->rig.gnss.p_BA = Eigen::Vector3d(0, 0, 1200); },
     Severity::kError,
     {"gnss0/sensor.yaml: p_BA: found [0, 0, 1200]"}},
    {"position sensor in mm",
     [](Dataset* dataset) { dataset->rig.fixes[0].p_BA = Eigen::Vector3d(0, 0, 1200); },
     Severity::kError,
     {"fix0/sensor.yaml: p_BA: found [0, 0, 1200]"}},
    {"receiver's clock off by 5 s",
     [](Dataset* dataset) { dataset->rig.gnss.time_offset_s = 5; },
     Severity::kWarning,
     {"gnss0/sensor.yaml: time_offset_s: found 5 s, expected within 1 s of 0 or of a difference of clocks"}},
};
INSTANTIATE_TEST_SUITE_P(Check, ImplausibleRig, testing::ValuesIn(kRigCases));

// Leap seconds, time zones and clocks that count from elsewhere are what a receiver's offset is for.
TEST(PlausibleRig, OffsetsBetweenClocksAreNoComplaint) {
  for (const double offset_s : {-18.0, 7200.5, -1.5e9}) {
    Dataset dataset = WithGnss(0, 0);
    dataset.rig.gnss.time_offset_s = offset_s;
    EXPECT_THAT(Complaints(dataset, Severity::kWarning), testing::Not(HasSubstr("time_offset_s")))
        << offset_s;
  }
}

TEST(PlausibleRig, ALensBeyond180DegreesIsNoComplaint) {
  Dataset dataset = Healthy();
  WithFisheye(130)(&dataset);  // 220 degrees over 500 px
  EXPECT_EQ(Complaints(dataset, Severity::kWarning), "");
  EXPECT_EQ(Complaints(dataset, Severity::kError), "");
}

// An omnidirectional camera of 220 degrees, whose image circle fills the height.
TEST(PlausibleRig, AnImageWiderThanItsImageCircleIsNoComplaint) {
  Dataset dataset = Healthy();
  dataset.rig.camera = CameraModel::Create(DistortionModel::kMei, Eigen::Vector4d(378, 378, 960, 540),
                                           {1, 0, 0, 0, 0}, 1920, 1080)
                           .value();
  EXPECT_THAT(Complaints(dataset, Severity::kWarning), testing::Not(HasSubstr("intrinsics")));
  EXPECT_THAT(Complaints(dataset, Severity::kError), testing::Not(HasSubstr("intrinsics")));
}

// What `check` itself advises where clocks are seconds apart.
TEST(PlausibleRig, ACameraOffsetOfSecondsIsNoComplaint) {
  Dataset dataset = Healthy();
  dataset.rig.camera_time_offset_s = -4;
  for (const Severity severity : {Severity::kWarning, Severity::kError}) {
    EXPECT_THAT(Complaints(dataset, severity), testing::Not(HasSubstr("time_offset_s")));
  }
}

// GIVEN a sequence with sheets THEN its findings name the sheet; GIVEN one without THEN they name the sensor.
TEST(SheetOfRig, WithoutSheetsTheSensorIsNamed) {
  Dataset dataset = Healthy();
  WithIntrinsics(4, 4, 320, 240)(&dataset);
  EXPECT_THAT(Complaints(dataset, Severity::kError), HasSubstr("cam0/sensor.yaml: intrinsics: found fu"));
  dataset.has_sheets = false;
  EXPECT_THAT(Complaints(dataset, Severity::kError), HasSubstr("cam0: intrinsics: found fu"));
}

// The camera's span is that of its stamps in IMU time.
TEST(PlausibleRig, TheCameraSpanIsInImuTime) {
  Dataset dataset = Healthy();
  dataset.rig.camera_time_offset_s = -0.25;
  EXPECT_THAT(Complaints(dataset, Severity::kFact), HasSubstr("cam0: starts -0.250 s and ends -0.250 s"));
}

}  // namespace
}  // namespace alidade
