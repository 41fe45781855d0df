#include "core/cpu_time.h"

#include <gtest/gtest.h>

namespace alidade {
namespace {

TEST(ProcessCpuSeconds, CountsWork) {
  const double before = ProcessCpuSeconds();
  volatile double sum = 0;
  for (int i = 0; i < 1000000; ++i) {
    sum = sum + 1;
  }
  EXPECT_GT(ProcessCpuSeconds(), before);
}

}  // namespace
}  // namespace alidade
