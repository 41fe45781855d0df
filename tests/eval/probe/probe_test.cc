#include "eval/probe/probe.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/eval/probe/ask_probe.h"

namespace alidade {
namespace {

using test::Ask;
using test::Flatten;
using Json = nlohmann::json;

/// Two views of a point, 1 m apart; the landmark (0.5, 0.2, 4).
Json TwoViews() {
  return {
      {"views", {{{"q_wxyz", {1, 0, 0, 0}}, {"p", {0, 0, 0}}}, {{"q_wxyz", {1, 0, 0, 0}}, {"p", {1, 0, 0}}}}},
      {"obs", {{0.125, 0.05}, {-0.125, 0.05}}},
      {"base", 0},
      {"pair", "multi"},
      {"inverse_depth", 0.25}};
}

TEST(Probe, NoiseFreeViewsLeaveNoResidual) {
  const Json pose_only = Ask("pose_only", Json::array({TwoViews()}))[0];
  EXPECT_NEAR(pose_only["depth"].get<double>(), 4, 1e-12);
  const Json inverse_depth = Ask("inverse_depth", Json::array({TwoViews()}))[0];
  for (const Json& answer : {pose_only, inverse_depth}) {
    ASSERT_EQ(answer["residual"].size(), 4u);
    for (const double r : Flatten(answer["residual"])) {
      EXPECT_NEAR(r, 0, 1e-12);
    }
    EXPECT_EQ(answer["H_X"].size(), 4u);
    EXPECT_EQ(answer["H_X"][0].size(), 12u);
  }
  // u = X/Z with X = x - 1 and Z = 1/rho: du/drho = -1 for a base at the origin.
  EXPECT_NEAR(inverse_depth["H_rho"][2].get<double>(), -1, 1e-12);
}

TEST(Probe, JacobianFollowsTheErrorConvention) {
  Json input = TwoViews();
  input["views"][1]["p"] = {1, 0, 0};
  const Json body = Ask("inverse_depth", Json::array({input}), ErrorConvention::kSo3xRn)[0];
  const Json world = Ask("inverse_depth", Json::array({input}), ErrorConvention::kRightInvariant)[0];
  EXPECT_NE(body["H_X"], world["H_X"]);
  EXPECT_EQ(body["residual"], world["residual"]);
}

struct BadCase {
  const char* name;
  const char* model;
  Json input;
  const char* expected;
};

TEST(Probe, BadCasesAnswerTheirErrorInPlace) {
  const auto with = [](const char* key, Json value) {
    Json input = TwoViews();
    input[key] = std::move(value);
    return input;
  };
  Json parallel = TwoViews();
  parallel["views"][1]["p"] = {0, 0, 0};
  Json turned = TwoViews();
  turned["views"][1]["q_wxyz"] = {0, 0, 1, 0};
  Json not_unit = TwoViews();
  not_unit["views"][0]["q_wxyz"] = {1, 1, 0, 0};
  const Json imu = Json::array(
      {{{"t", 0}, {"w", {0, 0, 0}}, {"a", {0, 0, 9.8}}}, {{"t", 0.5}, {"w", {0, 0, 0}}, {"a", {0, 0, 9.8}}}});
  const Json preintegration = {{"bg", {0, 0, 0}},
                               {"ba", {0, 0, 0}},
                               {"noise", {{"sg", 1}, {"sa", 1}, {"swg", 1}, {"swa", 1}}},
                               {"imu", imu}};
  const std::vector<BadCase> bad = {
      {"no object", "pose_only", 3, "expected an object"},
      {"one view", "pose_only", with("views", Json::array()), "at least two poses"},
      {"an observation too few", "pose_only", with("obs", Json::array({Json::array({0, 0})})), "2 pairs"},
      {"base out of range", "pose_only", with("base", 7), "base: found 7"},
      {"base no integer", "pose_only", with("base", "x"), "base: found \"x\""},
      {"unknown pair", "pose_only", with("pair", "three"), "pair: found \"three\""},
      {"number as null", "inverse_depth", with("inverse_depth", nullptr), "inverse_depth: found null"},
      {"no parallax", "pose_only", parallel, "no parallax"},
      {"no unit quaternion", "pose_only", not_unit, "unit quaternion"},
      {"behind the base", "inverse_depth", with("inverse_depth", -0.25), "at least 0"},
      {"behind another view", "inverse_depth", turned, "behind views[1]"},
      {"stamps in seconds", "preintegration", preintegration, "integer nanoseconds"},
      {"no anchor", "doppler", Json::object(), "anchor_llh_deg"}};
  for (const BadCase& bad_case : bad) {
    const bool visual =
        std::string(bad_case.model) == "pose_only" || std::string(bad_case.model) == "inverse_depth";
    const Json cases =
        visual ? Json::array({TwoViews(), bad_case.input, TwoViews()}) : Json::array({bad_case.input});
    const Json answers = Ask(bad_case.model, cases);
    ASSERT_EQ(answers.size(), cases.size()) << bad_case.name;
    const Json& answer = answers[visual ? 1 : 0];
    ASSERT_TRUE(answer.contains("error")) << bad_case.name << ": " << answer.dump();
    EXPECT_NE(answer["error"].get<std::string>().find(bad_case.expected), std::string::npos)
        << bad_case.name << ": " << answer["error"];
    if (visual) {
      EXPECT_TRUE(answers[0].contains("residual") && answers[2].contains("residual")) << bad_case.name;
    }
  }
}

TEST(Probe, RefusesWhatIsNoListOfCases) {
  for (const char* input : {"", "{", "[]", "{\"cases\": 3}", "{\"case\": []}", "\"x\""}) {
    EXPECT_EQ(Probe("pose_only", input, ErrorConvention::kSo3xRn).code(), StatusCode::kInput) << input;
  }
  const Result<std::string> unknown = Probe("pose_onyl", "{\"cases\": []}", ErrorConvention::kSo3xRn);
  EXPECT_EQ(unknown.code(), StatusCode::kUsage);
  EXPECT_NE(unknown.message().find("did you mean 'pose_only'"), std::string::npos) << unknown.message();
}

Json GnssCase() {
  return {{"anchor_llh_deg", {55.5, 8.5, 70}},
          {"state",
           {{"q_wxyz", {1, 0, 0, 0}},
            {"p", {10, -20, 5}},
            {"v", {1, 2, -0.5}},
            {"bg", {0.01, -0.02, 0.03}},
            {"ba", {0, 0, 0}}}},
          {"lever_arm", {0.3, -0.1, 0.2}},
          {"omega", {0.1, 0.4, -0.2}},
          {"clock_m", 1234.5},
          {"drift_mps", -12.25},
          {"satellite",
           {{"p", {15e6, 3e6, 21.5e6}}, {"v", {1500, -2200, -700}}, {"clock_m", -3000}, {"drift_mps", 0.02}}},
          {"iono_m", 3.25},
          {"tropo_m", 4.75},
          {"wavelength", 0.19}};
}

/// The equations written out once more, without the library.
TEST(Probe, GnssPredictionsFollowTheirEquations) {
  const Json range = Ask("pseudorange", Json::array({GnssCase()}))[0];
  const Json rate = Ask("doppler", Json::array({GnssCase()}))[0];
  ASSERT_TRUE(range.contains("predicted") && rate.contains("predicted")) << range << rate;
  constexpr double kC = 299792458.0;
  constexpr double kW = 7.2921151467e-5;
  const double lat = 55.5 * M_PI / 180;
  const double lon = 8.5 * M_PI / 180;
  const double a = 6378137.0;
  const double f = 1 / 298.257223563;
  const double e2 = f * (2 - f);
  const double n = a / std::sqrt(1 - e2 * std::sin(lat) * std::sin(lat));
  const Eigen::Vector3d anchor((n + 70) * std::cos(lat) * std::cos(lon),
                               (n + 70) * std::cos(lat) * std::sin(lon), (n * (1 - e2) + 70) * std::sin(lat));
  Eigen::Matrix3d C;
  C << -std::sin(lon), -std::sin(lat) * std::cos(lon), std::cos(lat) * std::cos(lon), std::cos(lon),
      -std::sin(lat) * std::sin(lon), std::cos(lat) * std::sin(lon), 0, std::cos(lat), std::sin(lat);
  const Eigen::Vector3d l(0.3, -0.1, 0.2);
  const Eigen::Vector3d w = Eigen::Vector3d(0.1, 0.4, -0.2) - Eigen::Vector3d(0.01, -0.02, 0.03);
  const Eigen::Vector3d p = anchor + C * (Eigen::Vector3d(10, -20, 5) + l);
  const Eigen::Vector3d v = C * (Eigen::Vector3d(1, 2, -0.5) + w.cross(l));
  const Eigen::Vector3d s(15e6, 3e6, 21.5e6);
  const Eigen::Vector3d vs(1500, -2200, -700);
  const Eigen::Vector3d e = (s - p).normalized();
  EXPECT_NEAR(range["predicted"].get<double>(),
              (s - p).norm() + kW / kC * (s.x() * p.y() - s.y() * p.x()) + 1234.5 + 3000 + 4.75 + 3.25, 1e-6);
  const double expected =
      (e.dot(vs - v) + kW / kC * (vs.x() * p.y() + s.x() * v.y() - vs.y() * p.x() - s.y() * v.x())) /
          (1 + e.dot(vs) / kC) -
      12.25 - 0.02;
  EXPECT_NEAR(rate["predicted"].get<double>(), expected, 1e-9);
  EXPECT_NEAR(rate["predicted_hz"].get<double>(), -expected / 0.19, 1e-8);
  const std::vector<double> h = Flatten(range["H"]);
  ASSERT_EQ(h.size(), 17u);
  EXPECT_EQ(h[15], 1);
  EXPECT_EQ(h[16], 0);
  const Eigen::Vector3d line = -C.transpose() * e;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(h[static_cast<size_t>(3 + i)], line[i], 1e-5);
  }
  EXPECT_EQ(Flatten(rate["H"])[16], 1);
}

}  // namespace
}  // namespace alidade
