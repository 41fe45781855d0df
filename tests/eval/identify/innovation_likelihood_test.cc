#include "eval/identify/innovation_likelihood.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/imu_propagation.h"
#include "eval/identify/identifying_filter.h"
#include "filter/filter.h"
#include "tests/support/scenario.h"

namespace alidade::test {
namespace {

/// A short figure-8 through a filter that is recorded.
class RecordedRun : public testing::Test {
 protected:
  void Record(double pixel_noise_px, const ImuNoise& noise) {
    SimulatorConfig simulation;
    simulation.duration_s = 6;
    simulation.path_m = path_m_;
    const Dataset dataset = SimulateOrDie(simulation, 5);
    EstimatorConfig config;
    config.init.method = InitMethod::kTruth;
    config.filter.window = 8;
    config.filter.max_direction_deviation = max_direction_deviation_;
    config.vision.pixel_noise_px = pixel_noise_px;
    config = IdentifyingFilter(config);
    MeasurementLog log{dataset.rig, dataset.imu, dataset.frames};
    log.rig.imu_noise = noise;
    LinearRecorder recorder(noise, GravityInWorld(config.imu.gravity_mps2));
    const std::unique_ptr<Estimator> filter = MakeFilter(config, log.rig, &recorder);
    RunOptions options;
    options.truth = &*dataset.truth;
    run_ = RunEstimator(config, log, options, filter.get());
    ASSERT_TRUE(run_.status.ok()) << run_.status.message();
    Result<LinearSystem> system = recorder.Take();
    ASSERT_TRUE(system.ok()) << system.message();
    system_ = *std::move(system);
  }

  static double Total(const std::vector<FrameFit>& fits) {
    double total = 0;
    for (const FrameFit& fit : fits) {
      total += fit.log_likelihood;
    }
    return total;
  }

  /// Records, and evaluates at the recorded noises.
  void ExpectTheFilter() {
    Record(1, ImuNoise());
    const Result<std::vector<FrameFit>> fits = EvaluateInnovations(system_, PerNoise{});
    ASSERT_TRUE(fits.ok()) << fits.message();
    ASSERT_EQ(fits->size(), run_.records.size());
    int rows = 0;
    for (std::size_t k = 0; k < fits->size(); ++k) {
      EXPECT_NEAR((*fits)[k].nis[0], run_.records[k].statistics.nis,
                  1e-6 * (1 + run_.records[k].statistics.nis));
      EXPECT_EQ((*fits)[k].dof[0], run_.records[k].statistics.nis_dof);
      rows += (*fits)[k].dof[0];
    }
    EXPECT_GT(rows, 1000);
  }

  double path_m_ = 7.9;
  double max_direction_deviation_ = 0;
  RunResult run_;
  LinearSystem system_;
};

TEST_F(RecordedRun, AtTheRecordedNoisesTheReplayIsTheFilter) {
  ExpectTheFilter();
}

// GIVEN a motion whose scale is uncertain for seconds THEN what carries it is replayed.
TEST_F(RecordedRun, AnUncertainScaleIsReplayedToo) {
  path_m_ = 0.6;
  max_direction_deviation_ = 0.2;
  ExpectTheFilter();
  EXPECT_GT(std::count_if(system_.steps.begin(), system_.steps.end(),
                          [](const LinearSystem::Step& step) {
                            return std::holds_alternative<LinearSystem::Shear>(step);
                          }),
            5);
}

TEST_F(RecordedRun, GivenOtherNoisesThenTheReplayIsAFilterWithThem) {
  // Linearised at other estimates, which the errors of six seconds hardly move.
  Record(1, ImuNoise());
  PerNoise scales{};
  scales[static_cast<std::size_t>(NoiseSource::kGyro)] = std::log(3.0);
  scales[static_cast<std::size_t>(NoiseSource::kAccel)] = std::log(2.0);
  scales[static_cast<std::size_t>(NoiseSource::kPixel)] = std::log(1.5);
  const Result<std::vector<FrameFit>> fits = EvaluateInnovations(system_, scales);
  ASSERT_TRUE(fits.ok()) << fits.message();
  ImuNoise noise;
  noise.gyro_noise_density_radps_sqrthz *= 3;
  noise.accel_noise_density_mps2_sqrthz *= 2;
  Record(1.5, noise);
  const Result<std::vector<FrameFit>> anew = EvaluateInnovations(system_, PerNoise{});
  ASSERT_TRUE(anew.ok()) << anew.message();
  double nis = 0, nis_anew = 0, dof = 0, dof_anew = 0;
  for (std::size_t k = 0; k < fits->size(); ++k) {
    nis += (*fits)[k].nis[0];
    dof += (*fits)[k].dof[0];
    nis_anew += (*anew)[k].nis[0];
    dof_anew += (*anew)[k].dof[0];
  }
  EXPECT_NEAR(nis / dof, nis_anew / dof_anew, 0.01);
  EXPECT_LT(nis / dof, 0.6);  // the noises are too large
}

TEST(InnovationLikelihood, GivenOneUpdateThenItIsTheGaussianDensity) {
  LinearSystem system;
  const Matrix15d root = 0.3 * Matrix15d::Identity();
  LinearSystem::Propagation propagation;
  propagation.phi = Matrix15d::Identity();
  for (Eigen::MatrixXd& q : propagation.q) {
    q = 0.04 * Matrix15d::Identity();
  }
  LinearSystem::Update update;
  update.source = RowSource::kVision;
  update.rows = Eigen::MatrixXd::Zero(2, 15);
  update.rows << 1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.5,  //
      0, 1, -1, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0;
  update.innovation = Eigen::Vector2d(0.7, -1.1);
  update.discarded_rows = 3;
  update.discarded = 2.5;
  system.steps = {LinearSystem::Restart{0, root}, propagation, update, LinearSystem::FrameEnd{42}};
  system.capacity = 15;
  system.frames = 1;
  ASSERT_TRUE(FillCorrections(&system).ok());

  PerNoise scales{};
  scales[static_cast<std::size_t>(NoiseSource::kAccel)] = std::log(2.0);
  const double s = 1.7;
  scales[static_cast<std::size_t>(NoiseSource::kPixel)] = std::log(s);
  const Result<std::vector<FrameFit>> fits = EvaluateInnovations(system, scales);
  ASSERT_TRUE(fits.ok());
  const double variance = 0.09 + 0.04 * (1 + 4 + 1 + 1);
  const Eigen::Matrix2d S =
      variance * update.rows * update.rows.transpose() + s * s * Eigen::Matrix2d::Identity();
  const double nis = update.innovation.dot(S.inverse() * update.innovation) + update.discarded / (s * s);
  EXPECT_NEAR((*fits)[0].nis[0], nis, 1e-9);
  EXPECT_EQ((*fits)[0].dof[0], 5);
  EXPECT_EQ((*fits)[0].stamp_ns, 42);
  EXPECT_NEAR((*fits)[0].log_likelihood, -0.5 * (nis + std::log(S.determinant()) + 3 * std::log(s * s)),
              1e-9);
}

}  // namespace
}  // namespace alidade::test
