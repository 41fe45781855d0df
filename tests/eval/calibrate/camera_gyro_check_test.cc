#include "eval/calibrate/camera_gyro_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "tests/eval/calibrate/shaken_camera.h"

namespace alidade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Severity = DatasetFinding::Severity;

/// The findings of the check on a recording whose sheet is changed by `spoil`; facts are left out.
template <typename Spoil>
std::vector<DatasetFinding> Check(const CameraGyroModel& truth, const Spoil& spoil, double duration_s = 20) {
  MeasurementLog log = ShakenCamera{.model = truth, .duration_s = duration_s}.Record();
  spoil(&log);
  Findings findings;
  CheckCameraAgainstGyro(log, 200, &findings);
  std::vector<DatasetFinding> list = findings.Take();
  EXPECT_FALSE(list.empty());
  std::erase_if(list, [](const DatasetFinding& finding) { return finding.severity == Severity::kFact; });
  return list;
}

TEST(CameraGyroCheckTest, ARightSheetIsNotQuestioned) {
  for (const DatasetFinding& finding : Check(PhoneModel(), [](MeasurementLog*) {})) {
    ADD_FAILURE() << finding.text;
  }
}

TEST(CameraGyroCheckTest, ATimeOffsetIsReported) {
  const auto found = Check(PhoneModel(), [](MeasurementLog* log) { log->rig.camera_time_offset_s = 0.04; });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].severity, Severity::kWarning);
  EXPECT_THAT(found[0].text, AllOf(HasSubstr("time_offset_s"), HasSubstr("the sheet has 0.0400")));
}

TEST(CameraGyroCheckTest, AnInvertedTransformIsReported) {
  CameraGyroModel model = PhoneModel();
  model.R_BC << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const auto found = Check(model, [](MeasurementLog* log) {
    log->rig.T_BC.rotation = log->rig.T_BC.rotation.transpose().eval();
    log->rig.camera_time_offset_s = 0.03;
  });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].severity, Severity::kError);
  EXPECT_THAT(found[0].text, HasSubstr("T_BS is the inverse"));
}

TEST(CameraGyroCheckTest, OtherAxesAreReported) {
  const auto found =
      Check(PhoneModel(), [](MeasurementLog* log) { log->rig.T_BC.rotation = Eigen::Matrix3d::Identity(); });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].severity, Severity::kError);
  EXPECT_THAT(found[0].text, HasSubstr("camera x = body -y, camera y = body -x, camera z = body -z"));
}

TEST(CameraGyroCheckTest, ANegatedGyroscopeIsReported) {
  const auto found = Check(PhoneModel(), [](MeasurementLog* log) {
    for (ImuSample& sample : log->imu) {
      sample.gyro *= -1;
    }
  });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].severity, Severity::kError);
  EXPECT_THAT(found[0].text, HasSubstr("negated"));
}

TEST(CameraGyroCheckTest, ANegatedAxisOfTheGyroscopeIsNamed) {
  constexpr std::array<const char*, 3> kNames = {"the x axis", "the y axis", "the z axis"};
  for (int axis = 0; axis < 3; ++axis) {
    const auto found = Check(PhoneModel(), [axis](MeasurementLog* log) {
      for (ImuSample& sample : log->imu) {
        sample.gyro[axis] *= -1;
      }
    });
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].severity, Severity::kError);
    EXPECT_THAT(found[0].text, HasSubstr(std::string(kNames[static_cast<std::size_t>(axis)]) +
                                         " of the gyroscope is negated"));
  }
}

// GIVEN camera stamps that are seconds off THEN the offset is named, and nothing of T_BS or focal length. A
// short recording is not enough for an error.
TEST(CameraGyroCheckTest, ClocksSecondsApartAreReportedAlone) {
  for (const auto& [late_s, duration_s, severity] :
       {std::tuple(4.0, 40.0, Severity::kError), std::tuple(-2.0, 40.0, Severity::kError),
        std::tuple(4.0, 20.0, Severity::kWarning)}) {
    const auto delay = [late = late_s](MeasurementLog* log) {
      for (TrackFrame& frame : log->frames) {
        frame.stamp_ns += SecondsToNs(late);
      }
    };
    const auto found = Check(PhoneModel(), delay, duration_s);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].severity, severity);
    EXPECT_THAT(found[0].text, HasSubstr("the clocks of camera and imu0 differ"));
    const std::string key = "time_offset_s: ";
    const std::size_t at = found[0].text.find(key);
    ASSERT_NE(at, std::string::npos) << found[0].text;
    EXPECT_NEAR(std::stod(found[0].text.substr(at + key.size())), -late_s, 0.05);
  }
}

TEST(CameraGyroCheckTest, TheGyroscopesUnitIsFoundFromTheImages) {
  constexpr std::array<std::pair<double, const char*>, 3> kUnits = {
      {{180 / M_PI, "in deg/s"}, {1e3, "in mrad/s"}, {1e3 * 180 / M_PI, "in mdeg/s"}}};
  for (const auto& [factor, said] : kUnits) {
    const auto found = Check(PhoneModel(), [factor = factor](MeasurementLog* log) {
      for (ImuSample& sample : log->imu) {
        sample.gyro *= factor;
      }
    });
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].severity, Severity::kError);
    EXPECT_THAT(found[0].text, HasSubstr(said));
  }
}

// GIVEN rates that are too large by a factor of no unit THEN the fact states whether they vary as the
// images'.
TEST(CameraGyroCheckTest, RatesThatAreNotComparedAreSaidToVaryAlikeOrOtherwise) {
  const auto fact = [](const auto& spoil) {
    MeasurementLog log = ShakenCamera{PhoneModel()}.Record();
    for (ImuSample& sample : log.imu) {
      spoil(&sample);
    }
    Findings findings;
    CheckCameraAgainstGyro(log, 200, &findings);
    const std::vector<DatasetFinding> list = findings.Take();
    return list.size() == 1 && list[0].severity == Severity::kFact ? list[0].text : "";
  };
  EXPECT_THAT(fact([](ImuSample* sample) { sample->gyro *= 12; }), HasSubstr("vary alike"));
  RandomStream random(3, "another gyroscope");
  EXPECT_THAT(fact([&random](ImuSample* sample) { sample->gyro = 20 * random.Normal3(); }),
              HasSubstr("vary otherwise"));
}

TEST(CameraGyroCheckTest, AnAccelerometerInPlaceOfTheGyroscopeIsNotCompared) {
  for (const DatasetFinding& finding : Check(PhoneModel(), [](MeasurementLog* log) {
         for (ImuSample& sample : log->imu) {
           std::swap(sample.gyro, sample.accel);
         }
       })) {
    ADD_FAILURE() << finding.text;
  }
}

TEST(CameraGyroCheckTest, ATurnedCameraIsReported) {
  const auto found = Check(PhoneModel(), [](MeasurementLog* log) {
    log->rig.T_BC.rotation = log->rig.T_BC.rotation * so3::Exp(Eigen::Vector3d(0, 0.035, 0));
  });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].severity, Severity::kWarning);
  EXPECT_THAT(found[0].text, AllOf(HasSubstr("T_BS"), HasSubstr("-2.0")));
}

TEST(CameraGyroCheckTest, AWrongFocalLengthIsReported) {
  const auto found = Check(PhoneModel(), [](MeasurementLog* log) {
    const CameraModel& camera = log->rig.camera;
    Eigen::Vector4d intrinsics = camera.intrinsics();
    intrinsics.head<2>() *= 1.02;
    const Result<CameraModel> wrong = CameraModel::Create(
        camera.model(), intrinsics, {0.08, -0.15, 0.001, -0.0007}, camera.width_px(), camera.height_px());
    log->rig.camera = *wrong;
  });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0].text, AllOf(HasSubstr("focal length -1.9 +-"), HasSubstr("instead of 489.6")));
}

TEST(CameraGyroCheckTest, ARollingShutterIsReported) {
  CameraGyroModel model = PhoneModel();
  model.readout_s = 0.022;
  const auto found = Check(model, [](MeasurementLog*) {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0].text, AllOf(HasSubstr("rolling shutter"), HasSubstr("over 21.")));
}

TEST(CameraGyroCheckTest, ImagesOfAnotherRecordingAreNotCompared) {
  MeasurementLog log = ShakenCamera{PhoneModel()}.Record();
  RandomStream random(3, "another gyroscope");
  for (ImuSample& sample : log.imu) {
    sample.gyro = Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
  }
  Findings findings;
  CheckCameraAgainstGyro(log, 200, &findings);
  const std::vector<DatasetFinding> list = findings.Take();
  ASSERT_EQ(list.size(), 1U);
  EXPECT_THAT(list[0].text, HasSubstr("relate"));
}

}  // namespace
}  // namespace alidade::test
