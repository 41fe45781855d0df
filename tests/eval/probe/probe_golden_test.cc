#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "tests/eval/probe/ask_probe.h"
#include "tests/support/shared_data.h"

namespace alidade {
namespace {

using test::Ask;
using test::Flatten;
using Json = nlohmann::json;

constexpr double kTolerance = 1e-8;

/// Largest difference over the largest golden magnitude, or a message why there is none.
void ExpectNear(const Json& answer, const Json& golden, double tolerance, const std::string& what) {
  const std::vector<double> found = Flatten(answer), expected = Flatten(golden);
  ASSERT_EQ(found.size(), expected.size()) << what;
  double scale = 0, difference = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    scale = std::max(scale, std::abs(expected[i]));
    difference = std::max(difference, std::abs(found[i] - expected[i]));
  }
  EXPECT_LE(difference, tolerance * scale) << what;
}

/// The golden file stamps in seconds; a probe case stamps in integer nanoseconds.
Json WithNanoseconds(Json imu) {
  for (Json& sample : imu) {
    sample["t"] = static_cast<std::int64_t>(std::llround(sample["t"].get<double>() * 1e9));
  }
  return imu;
}

Json VisualCase(const Json& golden, const std::string& pair) {
  Json views = Json::array();
  for (size_t i = 0; i < golden["p"].size(); ++i) {
    views.push_back({{"q_wxyz", golden["q_wxyz"][i]}, {"p", golden["p"][i]}});
  }
  return {{"views", views}, {"obs", golden["obs"]}, {"base", golden["base"]}, {"pair", pair}};
}

class ProbeGolden : public testing::Test {
 protected:
  void SetUp() override {
    ALIDADE_SKIP_WITHOUT_SHARED_DATA();
    std::ifstream file(test::SharedDir() + "/golden/golden.json");
    golden_ = Json::parse(file);
  }
  Json golden_;
};

TEST_F(ProbeGolden, PoseOnlyAnswersEqualTheGoldenOnes) {
  for (const std::string pair : {"multi", "two"}) {
    Json cases = Json::array();
    for (const Json& golden : golden_["pose_only"]) {
      cases.push_back(VisualCase(golden, pair));
    }
    const Json answers = Ask("pose_only", cases);
    ASSERT_EQ(answers.size(), golden_["pose_only"].size());
    ASSERT_FALSE(answers.empty());
    for (size_t i = 0; i < answers.size(); ++i) {
      const Json& expected = golden_["pose_only"][i][pair];
      const std::string what = pair + " case " + std::to_string(i) + " ";
      ExpectNear(answers[i]["depth"], expected["depth"], kTolerance, what + "depth");
      ExpectNear(answers[i]["p_f"], expected["p_f"], kTolerance, what + "p_f");
      ExpectNear(answers[i]["residual"], expected["residuals"], kTolerance, what + "residual");
      ExpectNear(answers[i]["H_X"], expected["H_X"], kTolerance, what + "H_X");
      ExpectNear(answers[i]["H_n"], expected["H_n"], kTolerance, what + "H_n");
      ExpectNear(answers[i]["information"], expected["info_Lambda"], kTolerance, what + "information");
      ExpectNear(answers[i]["gradient"], expected["info_eta"], kTolerance, what + "gradient");
    }
  }
}

// The golden propagation takes the mean of two samples: states and Phi differ by what that neglects
// (docs/imu.md).
TEST_F(ProbeGolden, ImuPropagationAnswersEqualTheGoldenOnesUpToTheRule) {
  for (const Json& golden : golden_["imu_propagation"]) {
    const Json input = {{"state", golden["x0"]},
                        {"gravity", golden["gravity"]},
                        {"noise", golden["noise"]},
                        {"imu", WithNanoseconds(golden["imu"])}};
    const Json answer = Ask("imu_propagation", Json::array({input}))[0];
    for (const char* key : {"q_wxyz", "p", "v"}) {
      ExpectNear(answer["state"][key], golden["x1"][key], 2e-5, key);
    }
    for (const char* key : {"bg", "ba"}) {
      ExpectNear(answer["state"][key], golden["x1"][key], kTolerance, key);
    }
    ExpectNear(answer["Phi"], golden["Phi"], 2e-5, "Phi");
    ExpectNear(answer["Q"], golden["Q_fine"], 1e-3, "Q");
  }
}

// The golden preintegration is by the midpoint rule: all differs by that of the two rules over 20 steps of 10
// ms (docs/imu.md), and cov15 by the noise within a step.
TEST_F(ProbeGolden, PreintegrationAnswersEqualTheGoldenOnesUpToTheRule) {
  for (const Json& golden : golden_["preintegration"]) {
    const Json input = {{"bg", golden["bg"]},
                        {"ba", golden["ba"]},
                        {"noise", golden["noise"]},
                        {"imu", WithNanoseconds(golden["imu"])}};
    const Json answer = Ask("preintegration", Json::array({input}))[0];
    ExpectNear(answer["gamma_wxyz"], golden["gamma_wxyz"], 6e-6, "gamma_wxyz");
    ExpectNear(answer["alpha"], golden["alpha"], 1e-4, "alpha");
    ExpectNear(answer["beta"], golden["beta"], 6e-5, "beta");
    ExpectNear(answer["J15"], golden["J15"], 6e-5, "J15");
    ExpectNear(answer["cov15"], golden["cov15"], 2e-4, "cov15");
  }
}

}  // namespace
}  // namespace alidade
