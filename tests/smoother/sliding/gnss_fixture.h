#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "smoother/sliding/gnss_window.h"
#include "tests/gnss/model/synthetic_sky.h"
#include "tests/smoother/window/window_fixture.h"

namespace alidade::test {

inline GnssConfig GnssTestConfig() {
  GnssConfig config;
  config.corrections.ionosphere = IonosphereMode::kNone;
  return config;
}

/// A window whose frames have clocks and epochs of a sky, some milliseconds after each frame.
struct GnssFixture : WindowFixture {
  explicit GnssFixture(unsigned seed) : WindowFixture(seed, 4, 12, 1.0) {
    constexpr TimeNs sky_ns = 1'700'000'100 * kSecondNs;
    const NavigationData sky = SyntheticSky(sky_ns);
    builder = std::make_shared<const MeasurementBuilder>(std::make_shared<SatelliteCatalog>(sky),
                                                         GnssTestConfig().corrections);
    SyntheticReceiver receiver;
    receiver.stamp_ns = sky_ns;
    EpochMeasurements measurements = builder->Prepare(Observe(sky, receiver));
    builder->Locate(receiver.position_E, &measurements);
    context.config = GnssTestConfig();
    context.mount = {EnuFrame::At(receiver.position_E), Eigen::Vector3d(0.1, -0.2, 0.3)};
    context.gravity_W = gravity_W;
    for (int i = 0; i < window.size(); ++i) {
      WindowFrame& frame = window.frame(i);
      frame.clock.emplace();
      for (double& value : *frame.clock) {
        value = random.Uniform(-3, 3);
      }
      FrameEpoch epoch;
      epoch.stamp_ns = frame.stamp_ns + 30'000'000;
      epoch.measurements = measurements;
      for (int k = 0; k <= 3; ++k) {
        epoch.imu.push_back({frame.stamp_ns + k * 10'000'000LL, random.Vector(0.4),
                             Eigen::Vector3d(0, 0, 9.81) + random.Vector(1)});
      }
      epoch.gyro_radps = epoch.imu.back().gyro;
      epoch.preintegration.emplace(frame.imu_bias(), noise);
      epoch.preintegration->Add(epoch.imu);
      frame.epochs.push_back(epoch);
    }
  }
  /// A window of GNSS that begins at the first frame in the fixture's frame, with the frame's clock zero.
  GnssWindow AlignedWindow() {
    GnssWindow gnss(GnssTestConfig(), {}, gravity_W);
    GnssAlignment alignment;
    alignment.enu = context.mount.enu;
    alignment.clock = Vector6d::Zero();
    LinearPrior prior;
    EXPECT_TRUE(
        MakeInitialPrior(ErrorConvention::kRightInvariant, window.frame(0), Matrix15d::Identity(), &prior));
    gnss.Align(alignment, &window.frame(0), &prior);
    return gnss;
  }

  GnssFactorContext context;
  std::shared_ptr<const MeasurementBuilder> builder;
};

}  // namespace alidade::test
