#include "eval/peers/imu_delivery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace alidade {
namespace {

using testing::ElementsAre;
using testing::Pair;

/// Steps [s] with the samples' first gyro value, which is ten times the time.
std::vector<std::pair<double, double>> Delivered(ImuDelivery* delivery, double until_s) {
  std::vector<std::pair<double, double>> samples;
  delivery->DeliverUntil(until_s, [&](double step_s, const ImuDelivery::Sample& sample) {
    samples.emplace_back(step_s, sample.gyro.x());
  });
  return samples;
}

TEST(ImuDelivery, EndsWithASampleAtTheImage) {
  ImuDelivery delivery;
  for (const double time_s : {1.0, 1.5, 2.0, 3.0}) {
    delivery.Add({time_s, Eigen::Vector3d(10 * time_s, 0, 0), Eigen::Vector3d::Zero()});
  }
  EXPECT_THAT(Delivered(&delivery, 1.75), ElementsAre(Pair(0, 10), Pair(0.5, 15), Pair(0.25, 17.5)));
  EXPECT_THAT(Delivered(&delivery, 2.0), ElementsAre(Pair(0.25, 20))) << "a sample is there";
  EXPECT_THAT(Delivered(&delivery, 2.5), ElementsAre(Pair(0.5, 25)));
  EXPECT_THAT(Delivered(&delivery, 4), ElementsAre(Pair(0.5, 30))) << "none is later";
}

TEST(ImuDelivery, BeforeItsFirstSampleThereIsNothing) {
  ImuDelivery delivery;
  delivery.Add({1, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  EXPECT_TRUE(Delivered(&delivery, 0.5).empty());
}

}  // namespace
}  // namespace alidade
