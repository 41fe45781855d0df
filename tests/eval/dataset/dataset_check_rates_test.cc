#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "core/numbers.h"
#include "core/random.h"
#include "tests/eval/dataset/healthy_dataset.h"

// Rates, tracks, noise and scale: what a sequence may have that makes every estimate from it useless.

namespace alidade {
namespace {

using test::Complaints;
using test::Healthy;
using test::WithGnss;
using testing::HasSubstr;
using testing::Not;
using Severity = DatasetFinding::Severity;

/// Twenty seconds of an IMU at rest at 200 Hz with white noise of 2e-4 rad/s/sqrt(Hz) and 2e-3
/// m/s^2/sqrt(Hz).
Dataset AtRest() {
  Dataset dataset;
  RandomStream noise(1, "at rest");
  const double root_rate = std::sqrt(200);
  for (int i = 0; i <= 4000; ++i) {
    dataset.imu.push_back({1'500'000'000'000'000'000 + i * TimeNs{5'000'000},
                           2e-4 * root_rate * noise.Normal3(),
                           Eigen::Vector3d(0, 0, 9.81) + 2e-3 * root_rate * noise.Normal3()});
  }
  dataset.rig.imu_noise.gyro_noise_density_radps_sqrthz = 2e-4;
  dataset.rig.imu_noise.accel_noise_density_mps2_sqrthz = 2e-3;
  return dataset;
}

Dataset WithImuStep(TimeNs step_ns) {
  Dataset dataset = AtRest();
  for (std::size_t i = 0; i < dataset.imu.size(); ++i) {
    dataset.imu[i].stamp_ns = 1'500'000'000'000'000'000 + static_cast<TimeNs>(i) * step_ns;
  }
  return dataset;
}

TEST(CheckRates, GivenAnImuOfAFewHertzOrOfStampsInAnotherUnitThenItIsNamed) {
  EXPECT_THAT(Complaints(WithImuStep(300'000'000), Severity::kError),
              HasSubstr("imu0: a rate of 3.33333 Hz, expected 50 to 10000 Hz"));
  EXPECT_EQ(Complaints(WithImuStep(50'000'000), Severity::kError), "");
  EXPECT_THAT(Complaints(WithImuStep(50'000'000), Severity::kWarning), HasSubstr("imu0: a rate of 20 Hz"));
  EXPECT_THAT(
      Complaints(WithImuStep(60'000), Severity::kWarning),
      HasSubstr("imu0: a rate of 16666.7 Hz, expected 50 to 10000 Hz: stamps in another unit than ns?"));
  EXPECT_THAT(Complaints(WithImuStep(66), Severity::kError), HasSubstr("imu0: a rate of 1.51515e+07 Hz"))
      << "in us too fast, in ms too slow";
  const Dataset in_us = WithImuStep(5'000);
  EXPECT_EQ(
      Complaints(in_us, Severity::kError),
      "imu0: the stamps as nanoseconds give 2e+05 Hz, expected at most 1e+04 Hz: they seem to be in us, "
      "which gives 200 Hz; expected ns, multiply them by 1000\n");
  EXPECT_THAT(Complaints(in_us, Severity::kWarning), Not(HasSubstr("a rate of")));
  EXPECT_THAT(Complaints(AtRest(), Severity::kWarning), Not(HasSubstr("a rate of")));
}

// GIVEN ten rows at a time, stamped on receipt, THEN the tiny steps within a packet are no rate.
TEST(CheckRates, GivenAnImuInPacketsThenItsMeanRateIsChecked) {
  Dataset dataset = AtRest();
  for (std::size_t i = 0; i < dataset.imu.size(); ++i) {
    const auto row = static_cast<TimeNs>(i);
    dataset.imu[i].stamp_ns = 1'500'000'000'000'000'000 + row / 10 * 50'000'000 + row % 10 * 5'000;
  }
  EXPECT_THAT(Complaints(dataset, Severity::kError), Not(HasSubstr("a rate of")));
  EXPECT_THAT(Complaints(dataset, Severity::kWarning), Not(HasSubstr("a rate of")));
}

// Steps of more than 0.1 s are silences of the IMU to the estimators.
TEST(CheckRates, GivenAnImuWhoseStepsCountAsSilencesThenItIsAnError) {
  EXPECT_THAT(Complaints(WithImuStep(125'000'000), Severity::kError),
              testing::AllOf(HasSubstr("imu0: a rate of 8 Hz, expected 50 to 10000 Hz"),
                             HasSubstr("imu0: a median step of 125.0 ms, expected at most 83.3 ms: steps "
                                       "above 100 ms count as silences, as most here do")));
  EXPECT_THAT(Complaints(WithImuStep(90'000'000), Severity::kError),
              HasSubstr("imu0: a median step of 90.0 ms, expected at most 83.3 ms: steps above 100 ms count "
                        "as silences, and jitter makes some so long"));
  EXPECT_EQ(Complaints(WithImuStep(80'000'000), Severity::kError), "");
}

TEST(CheckRates, GivenACameraOf1000HertzThenItIsDoubtedAndFasterThanTheImu) {
  Dataset dataset = Healthy();
  dataset.camera_rate_hz = 0;
  for (std::size_t i = 0; i < dataset.frames.size(); ++i) {
    dataset.frames[i].stamp_ns = dataset.imu.front().stamp_ns + static_cast<TimeNs>(i) * 1'000'000;
  }
  const std::string warnings = Complaints(dataset, Severity::kWarning);
  EXPECT_THAT(warnings, HasSubstr("cam0: a rate of 1000 Hz, expected 0 to 250 Hz"));
  EXPECT_THAT(warnings, HasSubstr("cam0: 1000 Hz, expected no more than imu0's 100 Hz"));
}

TEST(CheckTracks, GivenIdsThatAreNumberedAnewInEachFrameThenItIsAnErrorAndBesideGnssAWarning) {
  for (Dataset dataset : {Healthy(), WithGnss(0, 0)}) {
    std::int64_t id = 0;
    for (TrackFrame& frame : dataset.frames) {
      for (TrackObservation& observation : frame.observations) {
        observation.track_id = id++;
      }
    }
    EXPECT_THAT(Complaints(dataset, dataset.gnss ? Severity::kWarning : Severity::kError),
                HasSubstr("cam0: no track lasts: in 101 frames every track_id occurs once"));
  }
}

TEST(CheckTracks, GivenTracksOfTwoFramesThenItWarns) {
  Dataset dataset = Healthy();
  for (std::size_t i = 0; i < dataset.frames.size(); ++i) {
    for (TrackObservation& observation : dataset.frames[i].observations) {
      observation.track_id += 2 * static_cast<std::int64_t>(i / 2);
    }
  }
  EXPECT_THAT(Complaints(dataset, Severity::kWarning), HasSubstr("has more than 2 observations"));
}

TEST(CheckTracks, GivenFramesWithoutObservationsThenItIsAnError) {
  Dataset dataset = Healthy();
  for (TrackFrame& frame : dataset.frames) {
    frame.observations.clear();
  }
  EXPECT_THAT(Complaints(dataset, Severity::kError), HasSubstr("no observation in 101 frames"));
}

TEST(CheckTracks, GivenASingleFrameThenItIsAnErrorAndBesideGnssAWarning) {
  for (Dataset dataset : {Healthy(), WithGnss(0, 0)}) {
    dataset.frames.resize(1);
    EXPECT_THAT(Complaints(dataset, dataset.gnss ? Severity::kWarning : Severity::kError),
                HasSubstr("cam0: a single frame, expected at least two"));
  }
}

TEST(CheckNoise, GivenDensitiesInDegreesOrMilligThenTheyAreNamedBesideWhatTheSamplesShow) {
  EXPECT_THAT(Complaints(AtRest(), Severity::kWarning), Not(HasSubstr("noise_density")));
  Dataset in_degrees = AtRest();
  in_degrees.rig.imu_noise.gyro_noise_density_radps_sqrthz *= kDegreesPerRadian;
  EXPECT_THAT(
      Complaints(in_degrees, Severity::kWarning),
      testing::AllOf(HasSubstr("imu0/sensor.yaml: gyroscope_noise_density: found 0.0115 rad/s/sqrt(Hz)"),
                     HasSubstr("the quietest second shows at most 0.0002")));
  Dataset in_ug = AtRest();
  in_ug.rig.imu_noise.accel_noise_density_mps2_sqrthz *= 1e6 / 9.81;
  EXPECT_THAT(Complaints(in_ug, Severity::kWarning),
              HasSubstr("imu0/sensor.yaml: accelerometer_noise_density: found 204 m/s^2/sqrt(Hz)"));
}

TEST(CheckNoise, GivenADensityBeyondAnySensorThenThatLimitIsPrinted) {
  Dataset dataset = AtRest();
  for (ImuSample& sample : dataset.imu) {
    sample.gyro *= 50;  // 0.01 rad/s/sqrt(Hz): the samples alone do not contradict the sheet
  }
  dataset.rig.imu_noise.gyro_noise_density_radps_sqrthz = 6e-3;
  EXPECT_THAT(Complaints(dataset, Severity::kWarning),
              HasSubstr("gyroscope_noise_density: found 0.006 rad/s/sqrt(Hz), expected below 5e-03"));
  dataset.rig.imu_noise.gyro_noise_density_radps_sqrthz = 4e-3;
  EXPECT_THAT(Complaints(dataset, Severity::kWarning), Not(HasSubstr("noise_density")));
}

// A good gyroscope in degrees is within the bounds of a bad one; its own samples reveal it.
TEST(CheckNoise, GivenAGoodSensorInDegreesThenTheSamplesRevealIt) {
  Dataset dataset = AtRest();
  for (ImuSample& sample : dataset.imu) {
    sample.gyro *= 0.25;
  }
  dataset.rig.imu_noise.gyro_noise_density_radps_sqrthz = 5e-5 * kDegreesPerRadian;
  EXPECT_THAT(Complaints(dataset, Severity::kWarning),
              HasSubstr("gyroscope_noise_density: found 0.00286 rad/s/sqrt(Hz)"));
  // The sheet of a noisy sensor, enlarged tenfold, is no fault.
  dataset.rig.imu_noise.gyro_noise_density_radps_sqrthz = 10 * 5e-5;
  EXPECT_THAT(Complaints(dataset, Severity::kWarning), Not(HasSubstr("noise_density")));
}

// GIVEN the two groups of columns exchanged WHEN the sheet is right for either THEN the samples of the other
// are no bound of its densities.
TEST(CheckNoise, GivenExchangedColumnsThenTheSheetIsNotDoubted) {
  Dataset dataset = AtRest();
  dataset.rig.imu_noise.accel_noise_density_mps2_sqrthz = 0.04;  // enlarged, within what is in use
  EXPECT_THAT(Complaints(dataset, Severity::kWarning), Not(HasSubstr("noise_density")));
  for (ImuSample& sample : dataset.imu) {
    std::swap(sample.gyro, sample.accel);
  }
  EXPECT_THAT(Complaints(dataset, Severity::kError), HasSubstr("seem to be exchanged"));
  EXPECT_THAT(Complaints(dataset, Severity::kWarning), Not(HasSubstr("noise_density")));
}

TEST(CheckScale, GivenAnAccelerometerThatIsOffByFivePerCentAtRestThenTheRatioIsNamed) {
  for (const auto& [scale, said] :
       {std::pair(1.05, "is 1.050 of gravity"), std::pair(0.95, "is 0.950 of gravity")}) {
    Dataset dataset = AtRest();
    for (ImuSample& sample : dataset.imu) {
      sample.accel *= scale;
    }
    EXPECT_THAT(Complaints(dataset, Severity::kWarning), HasSubstr(said));
  }
  Dataset far = AtRest();
  Dataset in_g = AtRest();
  for (std::size_t i = 0; i < far.imu.size(); ++i) {
    far.imu[i].accel *= 1.2;
    in_g.imu[i].accel /= 9.81;
  }
  EXPECT_THAT(Complaints(far, Severity::kWarning),
              testing::AllOf(HasSubstr("is 1.20"), Not(HasSubstr("imu0: mean specific force"))));
  EXPECT_THAT(Complaints(in_g, Severity::kError), HasSubstr("in g, expected m/s^2"));
  EXPECT_THAT(Complaints(in_g, Severity::kWarning), Not(HasSubstr("of gravity")));
  Dataset biased = AtRest();
  for (ImuSample& sample : biased.imu) {
    sample.accel.z() += 0.25;  // 25 mg
  }
  EXPECT_THAT(Complaints(biased, Severity::kWarning), Not(HasSubstr("of gravity")));
}

// A steady turn adds to gravity as a scale error would.
TEST(CheckScale, GivenASteadyTurnThenNothingIsSaidOfTheScale) {
  Dataset dataset = AtRest();
  for (ImuSample& sample : dataset.imu) {
    sample.gyro.z() += 0.3;
    sample.accel.x() += 3;  // 10 m/s
  }
  EXPECT_THAT(Complaints(dataset, Severity::kWarning), Not(HasSubstr("of gravity")));
}

}  // namespace
}  // namespace alidade
