#include "eval/files/utc_day.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

namespace alidade {
namespace {

using std::chrono::system_clock;

// 2026-11-25 23:59:59 UTC.
constexpr system_clock::time_point kEvening(std::chrono::seconds(1795651199));

TEST(UtcDay, GivenNoSourceDateThenItIsTheDayInUtc) {
  EXPECT_EQ(*UtcDay(nullptr, kEvening), "2026-11-25");
  EXPECT_EQ(*UtcDay("", kEvening + std::chrono::seconds(1)), "2026-11-26");
}

TEST(UtcDay, GivenASourceDateThenItIsThatOne) {
  EXPECT_EQ(*UtcDay("0", kEvening), "1970-01-01");
  EXPECT_EQ(*UtcDay("951782400", kEvening), "2000-02-29");
}

TEST(UtcDay, GivenASourceDateThatIsNoTimeThenItIsRefused) {
  for (const char* wrong : {"today", "-1", "1.5", "12 ", "253402300800", "99999999999999999999"}) {
    const Result<std::string> day = UtcDay(wrong, kEvening);
    EXPECT_EQ(day.code(), StatusCode::kUsage) << wrong;
    EXPECT_EQ(day.message(),
              "SOURCE_DATE_EPOCH: found \"" + std::string(wrong) + "\", expected whole seconds since 1970");
  }
}

TEST(UtcDay, GivenTheEnvironmentsSourceDateThenItIsThatOne) {
  ASSERT_EQ(setenv("SOURCE_DATE_EPOCH", "951782400", 1), 0);
  EXPECT_EQ(*UtcDay(), "2000-02-29");
  ASSERT_EQ(unsetenv("SOURCE_DATE_EPOCH"), 0);
  EXPECT_EQ(UtcDay()->size(), 10U);
  EXPECT_GT(*UtcDay(), "2026-01-01");
}

}  // namespace
}  // namespace alidade
