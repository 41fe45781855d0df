#include "eval/peers/peer_world.h"

#include <gtest/gtest.h>

#include "core/lie.h"

namespace alidade {
namespace {

TrajectoryPoint Point(TimeNs stamp_ns, const Eigen::Vector3d& position) {
  TrajectoryPoint point;
  point.stamp_ns = stamp_ns;
  point.nav.p_WB = position;
  point.nav.v_WB = Eigen::Vector3d(1, 0, 0);
  point.covariance(3, 3) = 4;
  return point;
}

const Eigen::Vector3d kAnchor = ToEcef({0.8, 0.15, 450});

/// A world turned to the left by 90 degrees against ENU, its origin at `origin` of it.
Pose WorldAt(const Eigen::Vector3d& origin) {
  const EnuFrame enu = EnuFrame::At(kAnchor);
  return {enu.R_EN * so3::Exp(Eigen::Vector3d(0, 0, M_PI / 2)), enu.ToEcef(origin)};
}

TEST(PeerWorld, RowsBeforeTheAlignmentComeIntoEnuWithIt) {
  PeerWorld world(kAnchor);
  world.Add(Point(1, {0, 0, 0}), std::nullopt);
  world.Add(Point(2, {1, 0, 0}), std::nullopt);
  EXPECT_FALSE(world.aligned_ns().has_value());
  world.Add(Point(3, {2, 0, 0}), WorldAt({10, 20, 30}));
  world.Add(Point(4, {3, 0, 0}), WorldAt({11, 20, 30}));
  EXPECT_EQ(world.aligned_ns(), 3);
  const Eigen::Vector3d expected[] = {{10, 20, 30}, {10, 21, 30}, {10, 22, 30}, {11, 23, 30}};
  for (size_t i = 0; i < 4; ++i) {
    const TrajectoryPoint& point = world.points().at(i);
    EXPECT_LT((point.nav.p_WB - expected[i]).norm(), 1e-6) << i;
    EXPECT_LT((point.nav.v_WB - Eigen::Vector3d(0, 1, 0)).norm(), 1e-9) << i;
    EXPECT_LT((so3::Log(point.nav.R_WB) - Eigen::Vector3d(0, 0, M_PI / 2)).norm(), 1e-9) << i;
    EXPECT_NEAR(point.covariance(4, 4), 4, 1e-9) << "of x is that of y now";
    EXPECT_NEAR(point.covariance(3, 3), 0, 1e-9);
  }
}

TEST(PeerWorld, AfterARestartItsNewWorldWaitsForTheNextAlignment) {
  PeerWorld world(kAnchor);
  world.Add(Point(1, {0, 0, 0}), WorldAt({10, 20, 30}));
  world.Restart();
  world.Add(Point(2, {0, 0, 0}), std::nullopt);
  world.Add(Point(3, {0, 0, 0}), WorldAt({40, 50, 60}));
  EXPECT_LT((world.points()[0].nav.p_WB - Eigen::Vector3d(10, 20, 30)).norm(), 1e-6);
  EXPECT_LT((world.points()[1].nav.p_WB - Eigen::Vector3d(40, 50, 60)).norm(), 1e-6);
  EXPECT_EQ(world.aligned_ns(), 1);
}

TEST(PeerWorld, WithoutAnAnchorRowsStay) {
  PeerWorld world(std::nullopt);
  world.Add(Point(1, {1, 2, 3}), WorldAt({10, 20, 30}));
  EXPECT_EQ(world.points()[0].nav.p_WB, Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace alidade
