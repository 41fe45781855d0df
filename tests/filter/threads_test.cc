#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "core/blas.h"
#include "filter/filter_estimator.h"
#include "tests/support/scenario.h"

// Filters that run side by side in one process, as the runs of a comparison do.

namespace alidade {
namespace {

TEST(ThreadsTest, TheBlasOfThisProcessHasLocks) {
  EXPECT_TRUE(BlasIsThreadSafe()) << "install libopenblas0-pthread";
}

TEST(ThreadsTest, FiltersSideBySideEachGiveWhatTheyGiveAlone) {
  if (!BlasIsThreadSafe()) {
    GTEST_SKIP() << "this BLAS must not be called from several threads";
  }
  SimulatorConfig sim;
  sim.duration_s = 5;
  sim.path_m = 6.5;
  const Dataset dataset = test::SimulateOrDie(sim, 1);
  const NavEstimate initial = test::DrawInitialState(dataset, 1);
  const auto run = [&] {
    FilterEstimator filter(EstimatorConfig(), dataset.rig);
    return test::RunScenario(dataset, initial, &filter).last;
  };
  const NavEstimate alone = run();
  constexpr size_t kThreads = 4;
  constexpr int kRepetitions = 6;
  std::vector<int> different(kThreads, 0);
  std::vector<std::thread> threads;
  for (size_t i = 0; i < kThreads; ++i) {
    threads.emplace_back([&, i] {
      for (int k = 0; k < kRepetitions; ++k) {
        const NavEstimate beside = run();
        different[i] += beside.nav.p_WB != alone.nav.p_WB || beside.covariance != alone.covariance;
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  EXPECT_EQ(different, std::vector<int>(kThreads, 0));
}

}  // namespace
}  // namespace alidade
