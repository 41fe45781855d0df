#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <ostream>
#include <string>
#include <vector>

#include "eval/config/config_yaml.h"
#include "filter/filter_estimator.h"
#include "tests/support/scenario.h"

// The heap's calls are counted by taking malloc's place, hence a program of its own. Eigen, BLAS and the
// standard library all end there.

namespace {

std::atomic<bool> counting = false;
std::atomic<int> allocations = 0;

void CountAllocation() {
  if (counting.load(std::memory_order_relaxed)) {
    allocations.fetch_add(1, std::memory_order_relaxed);
  }
}

}  // namespace

extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier): glibc's own names of what is replaced here
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* block, size_t size);
// NOLINTEND(bugprone-reserved-identifier)

void* malloc(size_t size) {
  CountAllocation();
  return __libc_malloc(size);
}
void* calloc(size_t count, size_t size) {
  CountAllocation();
  return __libc_calloc(count, size);
}
void* realloc(void* block, size_t size) {
  CountAllocation();
  return __libc_realloc(block, size);
}
}

namespace alidade {
namespace {

struct Variant {
  std::string preset;
  std::vector<std::string> overrides;
};

void PrintTo(const Variant& variant, std::ostream* out) {
  *out << variant.preset << (variant.overrides.empty() ? "" : "_in_single_precision");
}

class SteadyState : public testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(Presets, SteadyState,
                         testing::Values(Variant{"alidade_filter", {}},
                                         Variant{"alidade_filter", {"filter.update_precision=single"}},
                                         Variant{"invio_l10_all", {}}, Variant{"invio_l5_at", {}},
                                         Variant{"po_invio_multi", {}}, Variant{"po_invio_two", {}},
                                         Variant{"pockf", {}}, Variant{"openvins_class", {}}),
                         [](const auto& variant) { return testing::PrintToString(variant.param); });

// GIVEN a filter that has run two rounds of the figure-8 WHEN it runs on THEN neither propagation nor update
// asks for memory.
TEST_P(SteadyState, AllocatesNothing) {
  SimulatorConfig sim;
  sim.duration_s = 60;
  sim.path_m = 78.6;
  const Dataset dataset = test::SimulateOrDie(sim, 1);
  const Result<EstimatorConfig> config = LoadEstimatorConfig(
      std::string(ALIDADE_SOURCE_DIR) + "/configs/estimators/" + GetParam().preset + ".yaml",
      GetParam().overrides);
  ASSERT_TRUE(config.ok()) << config.message();
  FilterEstimator filter(*config, dataset.rig);
  ASSERT_TRUE(filter.Initialize(test::DrawInitialState(dataset, 1)).ok());
  size_t imu = 0;
  allocations = 0;
  int in_steady_state = 0;
  int used = 0;
  for (size_t frame = 0; frame < dataset.frames.size(); ++frame) {
    counting = frame >= 2 * dataset.frames.size() / 3;
    for (; imu < dataset.imu.size() &&
           (imu == 0 || dataset.imu[imu - 1].stamp_ns < dataset.frames[frame].stamp_ns);
         ++imu) {
      ASSERT_TRUE(filter.AddImu(dataset.imu[imu]).ok());
    }
    const bool ok = filter.AddFrame(dataset.frames[frame]).ok();
    in_steady_state += counting ? 1 : 0;
    used += counting ? filter.last_statistics().features_used : 0;
    counting = false;
    ASSERT_TRUE(ok);
  }
  EXPECT_GE(in_steady_state, 100);
  EXPECT_GE(used, in_steady_state) << "at least a track a frame";
  EXPECT_EQ(allocations, 0);
}

}  // namespace
}  // namespace alidade
