#include "eval/peers/peer_flags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace alidade {
namespace {

using testing::HasSubstr;

const std::map<std::string, std::string> kDefaults = {
    {"dataset", "required"}, {"clones", "own"}, {"scale", "1"}, {"start", "own"}};

Result<PeerFlags> Parse(const std::vector<std::string>& arguments) {
  return PeerFlags::Parse(kDefaults, arguments);
}

TEST(PeerFlags, GivenFlagsThenTheyReplaceTheirDefaults) {
  const Result<PeerFlags> flags = Parse({"--dataset=/a=b", "--scale=2.5", "--start=truth"});
  ASSERT_TRUE(flags.ok()) << flags.message();
  EXPECT_EQ(flags->Text("dataset"), "/a=b");
  double scale = 0;
  EXPECT_TRUE(flags->Real("scale", 0, 10, &scale).ok());
  EXPECT_EQ(scale, 2.5);
  bool truth = false;
  EXPECT_TRUE(flags->OneOf("start", "truth", "own", &truth).ok());
  EXPECT_TRUE(truth);
}

TEST(PeerFlags, GivenOwnThenTheSettingOfTheOtherSystemStays) {
  const Result<PeerFlags> flags = Parse({"--dataset=a"});
  ASSERT_TRUE(flags.ok()) << flags.message();
  int clones = 11;
  EXPECT_TRUE(flags->Whole("clones", 1, 100, &clones).ok());
  EXPECT_EQ(clones, 11);
}

TEST(PeerFlags, NamesTheFaultOfEveryFlag) {
  EXPECT_THAT(Parse({}).message(), HasSubstr("--dataset: missing"));
  EXPECT_THAT(Parse({"--dataset=a", "--clone=1"}).message(), HasSubstr("did you mean 'clones'"));
  EXPECT_THAT(Parse({"--dataset"}).message(), HasSubstr("expected --name=value"));
  EXPECT_EQ(Parse({"dataset=a"}).code(), StatusCode::kUsage);
  const Result<PeerFlags> flags = Parse({"--dataset=a", "--clones=1.5", "--scale=x", "--start=late"});
  ASSERT_TRUE(flags.ok()) << flags.message();
  int clones = 11;
  double scale = 1;
  bool truth = false;
  EXPECT_THAT(flags->Whole("clones", 1, 100, &clones).message(), HasSubstr("whole number"));
  EXPECT_THAT(flags->Real("clones", 2, 100, &scale).message(), HasSubstr("from 2 to 100"));
  EXPECT_THAT(flags->Real("scale", 0, 10, &scale).message(), HasSubstr("found 'x'"));
  EXPECT_THAT(flags->OneOf("start", "truth", "own", &truth).message(), HasSubstr("expected truth or own"));
  EXPECT_EQ(clones, 11);
  EXPECT_EQ(scale, 1);
}

}  // namespace
}  // namespace alidade
