#include "eval/calibrate/camera_gyro_fit.h"

#include <gtest/gtest.h>

#include "eval/calibrate/camera_gyro_check.h"
#include "eval/calibrate/gyro_path.h"
#include "tests/eval/calibrate/shaken_camera.h"

namespace alidade::test {
namespace {

using Coordinate = CameraGyroCoordinate;

CameraGyroError EverythingFree() {
  CameraGyroError prior = CameraGyroPrior();
  prior[Coordinate::kReadout] = 0.05;
  prior[Coordinate::kFocal] = 0.3;
  prior[Coordinate::kFocalRatio] = 0.05;
  prior.segment<2>(Coordinate::kCentre).setConstant(30);
  prior.segment<4>(Coordinate::kLens).setConstant(0.3);
  return prior;
}

TEST(GyroPathTest, TheRotationFollowsTheMotion) {
  ShakenCamera recording{PhoneModel()};
  recording.gyro_noise_radps = 0;
  const MeasurementLog log = recording.Record();
  const GyroPath path(log.imu, recording.model.gyro_bias, 1);
  const double from_s = 3.0012, to_s = 3.4567;
  const Eigen::Matrix3d R_ij = path.At(from_s).R_0t.transpose() * path.At(to_s).R_0t;
  const Eigen::Matrix3d truth = ShakenCamera::R_WB(from_s).transpose() * ShakenCamera::R_WB(to_s);
  EXPECT_LT(so3::Log(R_ij.transpose() * truth).norm(), 3e-5);
}

TEST(GyroPathTest, TheBiasJacobianAgreesWithDifferences) {
  const MeasurementLog log = ShakenCamera{PhoneModel()}.Record();
  const Eigen::Vector3d bias(0.01, 0.02, -0.03);
  const GyroPath path(log.imu, bias, 1);
  const GyroPath::Point i = path.At(2.3013), j = path.At(2.9007);
  const Eigen::Matrix3d analytic = GyroPath::BiasJacobian(i, j);
  constexpr double kStep = 1e-5;
  for (int axis = 0; axis < 3; ++axis) {
    const GyroPath moved(log.imu, bias + kStep * Eigen::Vector3d::Unit(axis), 1);
    const Eigen::Matrix3d R_ij = i.R_0t.transpose() * j.R_0t;
    const Eigen::Matrix3d R_moved = moved.At(2.3013).R_0t.transpose() * moved.At(2.9007).R_0t;
    const Eigen::Vector3d numeric = so3::Log(R_ij.transpose() * R_moved) / kStep;
    EXPECT_LT((numeric - analytic.col(axis)).norm(), 2e-3 * analytic.col(axis).norm());
  }
}

TEST(GyroPathTest, AQueryBeyondTheSamplesIsTheEnd) {
  const MeasurementLog log = ShakenCamera{PhoneModel()}.Record();
  const GyroPath path(log.imu, Eigen::Vector3d::Zero(), 1);
  EXPECT_TRUE(path.At(1e3).R_0t.isApprox(path.At(19.995).R_0t));
  EXPECT_TRUE(path.At(-1).R_0t.isIdentity());
}

TEST(CameraGyroFitTest, ExactDataGiveTheTruth) {
  ShakenCamera recording{PhoneModel()};
  recording.model.time_offset_s = -0.02;
  recording.pixel_noise_px = 0;
  recording.gyro_noise_radps = 0;
  const MeasurementLog log = recording.Record();
  CameraGyroModel start = recording.model;
  start.gyro_bias.setZero();
  CameraGyroError shift = CameraGyroError::Zero();
  shift.segment<3>(Coordinate::kRotation) << 0.03, -0.02, 0.03;
  shift[Coordinate::kTimeOffset] = 0.015;
  shift[Coordinate::kFocal] = 0.04;
  shift.segment<2>(Coordinate::kCentre) << 6, -5;
  shift[Coordinate::kLens] = 0.05;
  ASSERT_TRUE(Retract(shift, &start));
  CameraGyroFitOptions options;
  options.prior = 1e3 * EverythingFree();
  const Result<CameraGyroFit> fit = FitCameraToGyro(FramePairsOf(log, 1000), log.imu, start, options);
  ASSERT_TRUE(fit.ok()) << fit.message();
  const CameraGyroError error = CameraGyroOffset(recording.model, fit->model);
  EXPECT_LT(error.segment<3>(Coordinate::kGyroBias).norm(), 1e-4);
  EXPECT_LT(error.segment<3>(Coordinate::kRotation).norm(), 1e-4);
  EXPECT_NEAR(error[Coordinate::kTimeOffset], 0, 1e-5);
  EXPECT_NEAR(error[Coordinate::kReadout], 0, 1e-4);
  EXPECT_NEAR(error[Coordinate::kFocal], 0, 1e-3);
  EXPECT_LT(error.segment<2>(Coordinate::kCentre).norm(), 0.3);
}

TEST(CameraGyroFitTest, ExactDataOfWideLensesGiveTheTruth) {
  const Result<CameraModel> lenses[] = {
      CameraModel::Create(DistortionModel::kDoubleSphere, {180, 181, 322, 243}, {-0.18, 0.59}, 640, 480),
      CameraModel::Create(DistortionModel::kEucm, {220, 221, 322, 243}, {0.62, 1.08}, 640, 480),
      CameraModel::Create(DistortionModel::kEquidistant, {220, 221, 322, 243},
                          {0.003, 0.0007, -0.002, 0.0002}, 640, 480)};
  for (const Result<CameraModel>& lens : lenses) {
    ASSERT_TRUE(lens.ok()) << lens.message();
    SCOPED_TRACE(ToString(lens->model()));
    ASSERT_EQ(lens->plane(), ObservationPlane::kTangent);
    ShakenCamera recording{PhoneModel()};
    recording.model.camera = *lens;
    recording.pixel_noise_px = 0;
    recording.gyro_noise_radps = 0;
    const MeasurementLog log = recording.Record();
    CameraGyroModel start = recording.model;
    CameraGyroError shift = CameraGyroError::Zero();
    shift.segment<3>(Coordinate::kRotation) << 0.02, -0.01, 0.02;
    shift[Coordinate::kFocal] = 0.03;
    shift.segment<2>(Coordinate::kCentre) << 4, -3;
    shift[Coordinate::kLens] = 0.02;
    ASSERT_TRUE(Retract(shift, &start));
    CameraGyroFitOptions options;
    options.prior = 1e3 * EverythingFree();
    const Result<CameraGyroFit> fit = FitCameraToGyro(FramePairsOf(log, 1000), log.imu, start, options);
    ASSERT_TRUE(fit.ok()) << fit.message();
    const CameraGyroError error = CameraGyroOffset(recording.model, fit->model);
    EXPECT_LT(error.segment<3>(Coordinate::kRotation).norm(), 1e-3);
    EXPECT_LT(error.segment<2>(Coordinate::kCentre).norm(), 0.5);
    // Coefficients trade with the focal length: where rays go is what counts.
    for (const double angle : {0.3, 0.8, 1.2, 1.7}) {
      Eigen::Vector2d found, wanted;
      const Eigen::Vector3d ray(std::sin(angle), 0, std::cos(angle));
      ASSERT_TRUE(fit->model.camera.Project(ray, &found) && lens->Project(ray, &wanted));
      EXPECT_LT((found - wanted).norm(), 1) << angle;
    }
  }
}

/// Normalised squared errors over seeds; each coordinate counts alone, as it is reported.
TEST(CameraGyroFitTest, DeviationsHoldOverSeeds) {
  constexpr unsigned kSeeds = 12;
  double squares = 0;
  int beyond = 0, count = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    ShakenCamera recording{PhoneModel()};
    recording.seed = seed;
    recording.model.time_offset_s = 0.01;
    recording.model.readout_s = 0.02;
    const MeasurementLog log = recording.Record();
    CameraGyroModel start = recording.model;
    start.readout_s = 0;
    start.time_offset_s = 0;
    start.gyro_bias.setZero();
    CameraGyroFitOptions options;
    options.prior = EverythingFree();
    const Result<CameraGyroFit> fit = FitCameraToGyro(FramePairsOf(log, 1000), log.imu, start, options);
    ASSERT_TRUE(fit.ok()) << fit.message();
    EXPECT_NEAR(fit->residual_px, recording.pixel_noise_px, 0.1);
    const CameraGyroError error = CameraGyroOffset(recording.model, fit->model);
    for (int c = 0; c < Coordinate::kCount; ++c) {
      if (fit->deviations[c] > 0) {
        const double sigmas = error[c] / fit->deviations[c];
        squares += sigmas * sigmas;
        beyond += std::abs(sigmas) > 3 ? 1 : 0;
        ++count;
      }
    }
    EXPECT_NEAR(fit->model.readout_s, 0.02, 1e-3);
    EXPECT_NEAR(fit->model.time_offset_s, 0.01, 3e-4);
    EXPECT_LT(so3::Log(fit->model.R_BC.transpose() * recording.model.R_BC).norm(), 5e-3);
    EXPECT_NEAR(fit->model.camera.intrinsics()[0], 480, 4);
  }
  EXPECT_LT(squares / count, 1.6);
  EXPECT_GT(squares / count, 0.3);
  EXPECT_LE(beyond, count / 50);
}

TEST(CameraGyroFitTest, AReadoutThatIsNotEstimatedBiasesTheRest) {
  ShakenCamera recording{PhoneModel()};
  recording.model.readout_s = 0.025;
  const MeasurementLog log = recording.Record();
  CameraGyroModel start = recording.model;
  start.readout_s = 0;
  CameraGyroFitOptions options;
  const std::vector<FramePair> pairs = FramePairsOf(log, 1000);
  const Result<CameraGyroFit> without = FitCameraToGyro(pairs, log.imu, start, options);
  options.prior[Coordinate::kReadout] = 0.05;
  const Result<CameraGyroFit> with = FitCameraToGyro(pairs, log.imu, start, options);
  ASSERT_TRUE(without.ok() && with.ok());
  EXPECT_GT(without->residual_px, 1.5 * with->residual_px);
}

TEST(CameraGyroFitTest, ARecordingAtRestHasNoPairs) {
  ShakenCamera recording{PhoneModel()};
  recording.duration_s = 2;
  MeasurementLog log = recording.Record();
  for (TrackFrame& frame : log.frames) {
    frame.observations = log.frames.front().observations;
  }
  EXPECT_TRUE(FramePairsOf(log, 100).empty());
  const Result<CameraGyroFit> fit = FitCameraToGyro({}, log.imu, recording.model, {});
  ASSERT_FALSE(fit.ok());
  EXPECT_EQ(fit.code(), StatusCode::kInput);
}

TEST(CameraGyroFitTest, WrongTracksAreOutliers) {
  ShakenCamera recording{PhoneModel()};
  MeasurementLog log = recording.Record();
  RandomStream random(7, "wrong tracks");
  for (TrackFrame& frame : log.frames) {
    for (TrackObservation& observation : frame.observations) {
      if (observation.track_id % 7 == 0) {
        observation.pixel += Eigen::Vector2d(20 * random.Normal(), 20 * random.Normal());
      }
    }
  }
  CameraGyroFitOptions options;
  const Result<CameraGyroFit> fit =
      FitCameraToGyro(FramePairsOf(log, 1000), log.imu, recording.model, options);
  ASSERT_TRUE(fit.ok()) << fit.message();
  EXPECT_GT(fit->outliers, 0.05);
  EXPECT_LT(fit->outliers, 0.3);
  EXPECT_NEAR(fit->model.time_offset_s, 0, 5e-4);
  EXPECT_LT(so3::Log(fit->model.R_BC.transpose() * recording.model.R_BC).norm(), 4e-3);
}

}  // namespace
}  // namespace alidade::test
