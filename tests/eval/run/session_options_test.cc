#include "eval/run/session_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace alidade {
namespace {

using testing::HasSubstr;

void ExpectRefused(const SessionOptions& options, const EstimatorConfig& config, const char* key) {
  const Status status = options.Validate(config);
  EXPECT_EQ(status.code(), StatusCode::kConfig);
  EXPECT_THAT(status.message(), HasSubstr(key));
}

TEST(SessionOptionsTest, AStartFromATruthThatNobodyGivesIsRefused) {
  EstimatorConfig config;
  config.init.method = InitMethod::kTruth;
  SessionOptions options;
  ExpectRefused(options, config, "init.method: found truth");
  options.start_state = [](TimeNs) { return Result<NavEstimate>(NavEstimate()); };
  EXPECT_TRUE(options.Validate(config).ok());
  config.init.method = InitMethod::kAuto;
  EXPECT_TRUE(SessionOptions().Validate(config).ok());
}

// GIVEN no camera THEN the configuration must use GNSS, a setup of it must be given, and the back end must
// work without frames.
TEST(SessionOptionsTest, WithoutACameraGnssIsNeededAndABackEndThatTakesIt) {
  EstimatorConfig config;
  SessionOptions options;
  options.camera = false;
  config.gnss.enabled = true;
  ExpectRefused(options, config, "gnss.enabled: a session without a camera");
  options.gnss.emplace();
  EXPECT_TRUE(options.Validate(config).ok());
  config.init.method = InitMethod::kTruth;
  EXPECT_TRUE(options.Validate(config).ok()) << "a start without a camera asks for no state";
  config.backend = Backend::kBatch;
  ExpectRefused(options, config, "backend: batch");
  config.gnss.enabled = false;
  ExpectRefused(options, config, "gnss.enabled: a session without a camera");
}

}  // namespace
}  // namespace alidade
