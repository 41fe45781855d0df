#include "tests/fuzz/fuzz_scene.h"

#include "core/check.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"

namespace alidade::test {

const Dataset& FuzzScene() {
  static const Dataset scene = [] {
    SimulatorConfig config;
    config.start_time_s = 1.6e9;  // stamps of GNSS are GPST
    config.duration_s = 3;
    config.path_m = 9;
    config.max_features = 30;
    config.gnss.rate_hz = 5;
    config.fix.rate_hz = 5;
    Result<Dataset> dataset = Simulate(config, 1);
    CHECK(dataset.ok()) << dataset.message();
    return *std::move(dataset);
  }();
  return scene;
}

}  // namespace alidade::test
