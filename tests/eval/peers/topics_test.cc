#include "eval/peers/stubs/ros/topics.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace alidade {
namespace {

/// A node that answers a number below 3 with the next on the same topic.
struct Node {
  void Take(const std::shared_ptr<const int>& number) {
    seen += std::to_string(*number);
    if (*number < 3) {
      publisher.publish(std::make_shared<int>(*number + 1));
    }
  }
  ros::Publisher publisher;
  std::string seen;
};

TEST(StubTopics, DeliverOneByOneInOrder) {
  ros::NodeHandle handle;
  Node node;
  handle.subscribe("/node/numbers", 10, &Node::Take, &node);
  node.publisher = handle.advertise<int>("numbers", 10);
  node.publisher.publish(std::make_shared<int>(2));
  node.publisher.publish(std::make_shared<int>(7));
  handle.advertise<int>("nobody", 1).publish(std::make_shared<int>(9));
  EXPECT_EQ(node.seen, "") << "nothing calls back by itself";
  ros::Topics& topics = ros::Topics::Instance();
  EXPECT_TRUE(topics.DeliverOne());
  EXPECT_EQ(node.seen, "2");
  EXPECT_TRUE(topics.DeliverOne());
  EXPECT_TRUE(topics.DeliverOne());
  EXPECT_EQ(node.seen, "273");
  EXPECT_FALSE(topics.DeliverOne());
}

TEST(StubTopics, ParametersAreTheTextsThatTheProgramSets) {
  ros::NodeHandle handle;
  std::string text = "before";
  EXPECT_FALSE(handle.getParam("config_file", text));
  ros::Parameters()["config_file"] = "a.yaml";
  EXPECT_TRUE(handle.getParam("config_file", text));
  EXPECT_EQ(text, "a.yaml");
}

}  // namespace
}  // namespace alidade
