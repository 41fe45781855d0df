#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <memory>

#include "gnss/model/epoch_rows.h"
#include "gnss/model/receiver_clock.h"
#include "tests/gnss/model/synthetic_sky.h"
#include "tests/integration/one_window.h"

namespace alidade::test {

/// Sets what the receiver measures of a satellite to what the row predicts less `noise`.
inline void Measure(const GnssRow& row, SatelliteId id, double noise, EpochMeasurements* epoch) {
  const auto found = std::find_if(epoch->satellites.begin(), epoch->satellites.end(),
                                  [&](const SatelliteMeasurement& m) { return m.satellite == id; });
  ASSERT_NE(found, epoch->satellites.end());
  (row.is_rate ? *found->range_rate_mps : found->pseudorange_m) += row.residual - noise;
}

/// Raw GNSS at every second frame but the first and the last, and the alignment that knows the clock. The
/// errors, of the clock, its walk and the measurements, are `scale` times draws from what is assumed of them.
inline void AddEpochs(const GnssConfig& config, double scale, OneWindow* window) {
  constexpr TimeNs kSkyNs = 1'700'000'100 * kSecondNs;
  RandomStream random(25, "GNSS of one window");
  const auto draw = [&](const Matrix6d& covariance) -> Vector6d {
    Vector6d normal;
    for (double& entry : normal) {
      entry = random.Normal();
    }
    const Matrix6d root = covariance.llt().matrixL();
    return scale * (root * normal);
  };
  const NavigationData sky = SyntheticSky(kSkyNs);
  const auto builder =
      std::make_shared<MeasurementBuilder>(std::make_shared<SatelliteCatalog>(sky), config.corrections);
  SyntheticReceiver receiver;
  window->rig.gnss.p_BA = Eigen::Vector3d(0.3, -0.2, 0.4);
  const AntennaMount mount{EnuFrame::At(receiver.position_E), window->rig.gnss.p_BA};
  Vector6d clock;
  clock << 20, 0.5, 5, 0, 0, 0;  // GPS and Galileo are in the sky
  window->alignment = IdentityAlignment(window->start.stamp_ns);
  window->alignment->enu = mount.enu;
  window->alignment->clock = clock + draw(FreshClock(config, clock).covariance);
  for (size_t i = 1; i + 1 < window->states.size(); ++i) {
    const TimeNs stamp_ns = window->frames[i].stamp_ns;
    const ClockTransition transition =
        PropagateClock(config, SecondsBetween(window->frames[i - 1].stamp_ns, stamp_ns));
    clock = transition.phi * clock + draw(transition.q);
    if (i % 2 == 1) {
      continue;
    }
    receiver.stamp_ns = kSkyNs + stamp_ns;
    GnssEpoch& epoch = window->epochs.emplace_back();
    epoch.stamp_ns = stamp_ns;
    epoch.builder = builder;
    epoch.measurements = builder->Prepare(Observe(sky, receiver));
    LocateEpoch(*builder, mount, window->states[i], &epoch.measurements);
    const Eigen::Vector3d gyro_radps = window->samples[i * kSamplesPerFrame].gyro;
    GnssResiduals residuals;
    for (const GnssRow& row :
         LinearizeEpoch(config, mount, {window->states[i], window->bias, gyro_radps, clock},
                        epoch.measurements, &residuals)) {
      Measure(row, residuals.satellites[row.satellite].satellite, scale * row.deviation * random.Normal(),
              &epoch.measurements);
    }
  }
}

}  // namespace alidade::test
