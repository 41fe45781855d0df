#include "eval/files/time_left.h"

#include <gtest/gtest.h>

namespace alidade {
namespace {

TEST(TimeLeft, IsPrintedByTheMeanTimeInTheUnitThatFits) {
  EXPECT_EQ(TimeLeft(20, 10, 30), ", about 40 s left");
  EXPECT_EQ(TimeLeft(100, 10, 30), ", about 3 min left");
  EXPECT_EQ(TimeLeft(3600, 1, 3), ", about 2.0 h left");
}

TEST(TimeLeft, IsNotPrintedBeforeItIsKnownNorAtTheEnd) {
  EXPECT_EQ(TimeLeft(5, 10, 30), "");
  EXPECT_EQ(TimeLeft(20, 0, 30), "");
  EXPECT_EQ(TimeLeft(20, 30, 30), "");
  EXPECT_EQ(TimeLeft(20, 0, 0), "");
}

}  // namespace
}  // namespace alidade
