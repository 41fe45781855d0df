#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/package/installed_tree.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;

/// What bash would offer behind `words`, written as bash splits them: "--config = gv"; '' is an empty word.
std::vector<std::string> Replies(const std::string& words, const std::string& folder = "/") {
  TemporaryFolder scripts;
  const std::string script =
      scripts.Write("ask.bash", "set -u\ncompopt() { :; }\nsource " +
                                    Installed("share/bash-completion/completions/alidade") +
                                    "\nCOMP_WORDS=(" + Installed("bin/alidade") + " " + words +
                                    ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_alidade\n"
                                    "((${#COMPREPLY[@]} == 0)) || printf '%s\\n' \"${COMPREPLY[@]}\"\n");
  const CommandResult asked = ShellIn(folder, "bash --norc " + script);
  EXPECT_EQ(asked.code, 0) << asked.output;
  std::vector<std::string> replies;
  std::istringstream lines(asked.output);
  for (std::string line; std::getline(lines, line);) {
    replies.push_back(line);
  }
  return replies;
}

TEST(Completion, OffersCommands) {
  EXPECT_THAT(Replies("''"), IsSupersetOf({"simulate", "run", "compare", "spp", "help", "--version"}));
  EXPECT_THAT(Replies("co"), ElementsAre("compare", "convert", "config", "completion"));
  EXPECT_THAT(Replies("da"), ElementsAre("data"));
  EXPECT_THAT(Replies("help ev"), ElementsAre("evaluate"));
}

TEST(Completion, OffersTheFlagsOfTheCommandAndNoOthers) {
  EXPECT_THAT(Replies("compare --"), IsSupersetOf({"--plan=", "--jobs=", "--resume", "--help"}));
  EXPECT_THAT(Replies("compare --"), Not(Contains("--align=")));
  EXPECT_THAT(Replies("run --back"), ElementsAre("--backend="));
  EXPECT_THAT(Replies("evaluate ''"), IsSupersetOf({"--truth=", "--json"}));
}

TEST(Completion, OffersTheWordsThatAFlagTakes) {
  const auto alignments = ElementsAre("none", "pos", "posyaw", "se3", "sim3");
  EXPECT_THAT(Replies("evaluate --align ="), alignments);
  EXPECT_THAT(Replies("evaluate --align ''"), alignments);
  EXPECT_THAT(Replies("evaluate --align = pos"), ElementsAre("pos", "posyaw"));
  EXPECT_THAT(Replies("run --seed = 1"), IsEmpty());
}

TEST(Completion, OffersWhatDataDoesAndItsSets) {
  EXPECT_THAT(Replies("data ''"), ElementsAre("list", "fetch", "verify"));
  EXPECT_THAT(Replies("data fetch tu"), ElementsAre("tumvi"));
  EXPECT_THAT(Replies("data fetch --mi"), ElementsAre("--mirror="));
}

TEST(Completion, OffersShippedConfigurationsOfTheRightKindAndFiles) {
  EXPECT_THAT(Replies("run --config = alidade_"), ElementsAre("alidade_filter", "alidade_smoother"));
  EXPECT_THAT(Replies("compare --plan = dem"), ElementsAre("demo"));
  EXPECT_THAT(Replies("simulate --config = figure8_"), ElementsAre("figure8_short"));
  EXPECT_THAT(Replies("config --kind = plan --check dem"), ElementsAre("demo"));
  EXPECT_THAT(Replies("config --check gvio"), ElementsAre("gvio"));

  TemporaryFolder folder;
  folder.Write("gvio of mine.yaml", "");
  EXPECT_THAT(Replies("run --config = gvio", folder.path()), ElementsAre("gvio", "gvio of mine.yaml"));
  EXPECT_THAT(Replies("check --dataset = gvi", folder.path()), ElementsAre("gvio of mine.yaml"));
}

}  // namespace
}  // namespace alidade::test
