#include "eval/render/hall_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/random.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

Hall SomeHall() {
  Hall hall;
  hall.origin_W = {100.25, -7, 3};
  hall.room = {.low = {-5, -4, 0}, .high = {5, 4, 3}, .faces = {}};
  hall.boxes.push_back({.low = {1.1F, 1.2F, 0}, .high = {2.3F, 2, 1.7F}, .faces = {}});
  hall.moving.push_back({.box = {.low = {2.6F, 1, 0}, .high = {3.1F, 2, 1.2F}, .faces = {}},
                         .travel = {0.7F, -0.3F, 0},
                         .period_s = 3.3F,
                         .phase = 0.4F});
  hall.epoch_ns = 1403715273262142976;
  hall.columns.push_back({.centre = {-2.1F, 0.3F}, .radius = 0.4F, .surface = {}});
  return hall;
}

TEST(HallFile, GIVEN_a_hall_THEN_every_ray_is_as_long_in_the_one_read_back) {
  const test::TemporaryFolder folder;
  const Hall hall = SomeHall();
  ASSERT_TRUE(WriteHall(hall, folder.File("hall.csv")).ok());
  const Result<Hall> read = ReadHall(folder.File("hall.csv"));
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_EQ(read->epoch_ns, hall.epoch_ns);
  RandomStream stream(3, "rays");
  for (int i = 0; i < 200; ++i) {
    const Vector3d direction = Vector3d(stream.Normal(), stream.Normal(), stream.Normal()).normalized();
    const Vector3d p_W = hall.origin_W + Vector3d(0.2, -1, 1);
    EXPECT_EQ(read->Distance(p_W, direction), hall.Distance(p_W, direction));
    EXPECT_EQ(read->Distance(p_W, direction, 0.1 * i), hall.Distance(p_W, direction, 0.1 * i));
  }
}

TEST(HallFile, GIVEN_a_row_that_is_no_object_THEN_the_message_names_file_and_line) {
  const test::TemporaryFolder folder;
  const std::string header = "#shape,x_0 [m],y_0 [m],z_0 [m],x_1 [m],y_1 [m],z_1 [m]\n";
  const std::string good = header + "origin,0,0,0,0,0,0\nroom,-1,-1,-1,1,1,1\n";
  const std::string path = folder.File("hall.csv");
  const auto message = [&](const std::string& text) {
    std::ofstream(path) << text;
    const Result<Hall> hall = ReadHall(path);
    return hall.ok() ? std::string() : hall.message();
  };
  EXPECT_EQ(message(good), "");
  for (const char* row :
       {"ball,0,0,0,1,1,1\n", "box,0,0,0,1,1\n", "box,0,0,0,1,0,1\n", "column,0,0,0,0,0,0\n",
        "travel,1,0,0,3,0,0\n", "epoch,0.5,0,0,0,0,0\n", "epoch,0,1e9,0,0,0,0\n"}) {
    EXPECT_NE(message(good + row).find("hall.csv:4"), std::string::npos) << row;
  }
  EXPECT_NE(message(header + "origin,0,0,0,0,0,0\n").find("0 rows room"), std::string::npos);
  EXPECT_NE(message(good + "moving,0,0,0,1,1,1\ntravel,1,0,0,0,0,0\n").find("hall.csv:5"), std::string::npos);
  EXPECT_NE(message(good + "moving,0,0,0,1,1,1\n").find("without a row travel"), std::string::npos);
  EXPECT_NE(message("#shape,x\n").find("hall.csv"), std::string::npos);
}

}  // namespace
}  // namespace alidade
