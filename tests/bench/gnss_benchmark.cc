#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "filter/gnss_update.h"
#include "gnss/positioning/single_point.h"
#include "gnss/positioning/single_point_options.h"
#include "tests/gnss/model/synthetic_sky.h"

namespace alidade {
namespace {

/// One GNSS epoch in the filter, satellites prepared: clock propagation, atmosphere, linearisation, gates,
/// update, correction of the state. Arguments: clones, satellites.
void GnssEpochUpdate(benchmark::State& state) {
  constexpr TimeNs kStamp = 1'700'000'100 * kSecondNs;
  const auto clones = static_cast<int>(state.range(0));
  const NavigationData sky = test::SyntheticSky(kStamp);
  test::SyntheticReceiver receiver;
  receiver.stamp_ns = kStamp;
  ObservationEpoch observed = test::Observe(sky, receiver);
  // The sky holds fewer than 25: the first ones again.
  const std::size_t there = observed.satellites.size();
  const auto wanted = static_cast<std::size_t>(state.range(1));
  for (std::size_t i = 0; observed.satellites.size() < wanted; ++i) {
    observed.satellites.push_back(observed.satellites[i % there]);
  }
  observed.satellites.resize(wanted);
  GnssConfig config;
  config.corrections.elevation_mask_deg = 0;
  auto builder =
      std::make_shared<MeasurementBuilder>(std::make_shared<SatelliteCatalog>(sky), config.corrections);
  GnssEpoch epoch{kStamp, builder->Prepare(observed), builder};

  FilterState filter(ErrorConvention::kRightInvariant, false, Pose(), {clones, 0, true});
  NavEstimate initial;
  initial.stamp_ns = kStamp;
  initial.covariance = 1e-2 * Matrix15d::Identity();
  (void)filter.Reset(initial);
  for (int i = 0; i < clones; ++i) {
    filter.AddClone(i);
  }
  GnssUpdate update(config, {});
  GnssAlignment alignment;
  alignment.stamp_ns = kStamp;
  alignment.enu = EnuFrame::At(receiver.position_E);
  alignment.clock = Vector6d::Zero();
  alignment.covariance = Eigen::Matrix4d::Identity();
  update.Align(alignment, &filter);
  Eigen::VectorXd correction(filter.covariance().dimension());
  FrameStatistics statistics;
  for ([[maybe_unused]] auto _ : state) {
    epoch.stamp_ns += 100'000'000;  // the clock walks; the sky stands still
    benchmark::DoNotOptimize(update.Apply(epoch, Eigen::Vector3d::Zero(), &filter, correction, &statistics));
    filter.Correct(correction);
  }
  state.counters["rows"] = statistics.gnss_nis_dof;
}
BENCHMARK(GnssEpochUpdate)->Args({11, 25})->Args({26, 25})->Args({26, 10})->Unit(benchmark::kMicrosecond);

/// What an epoch costs before an estimator sees it: its preparation (orbits, clocks, group delays), and the
/// single-point solution of the prepared epoch.
struct Epoch {
  ObservationEpoch observed;
  MeasurementBuilder builder;

  static Epoch Make() {
    constexpr TimeNs kStamp = 1'700'000'100 * kSecondNs;
    const NavigationData sky = test::SyntheticSky(kStamp);
    test::SyntheticReceiver receiver;
    receiver.stamp_ns = kStamp;
    return {test::Observe(sky, receiver), {std::make_shared<SatelliteCatalog>(sky), GnssCorrectionOptions()}};
  }
};

void GnssPrepareEpoch(benchmark::State& state) {
  const Epoch epoch = Epoch::Make();
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(epoch.builder.Prepare(epoch.observed));
  }
  state.SetLabel(std::to_string(epoch.observed.satellites.size()) + " satellites");
}
BENCHMARK(GnssPrepareEpoch)->Unit(benchmark::kMicrosecond);

void GnssSinglePoint(benchmark::State& state) {
  const Epoch epoch = Epoch::Make();
  const EpochMeasurements prepared = epoch.builder.Prepare(epoch.observed);
  SinglePointSolver solver(epoch.builder, SinglePointOptions());
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(solver.Solve(prepared));
  }
}
BENCHMARK(GnssSinglePoint)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace alidade
