#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>

#include "tests/integration/command.h"

// The counts of docs/adding.md: files that an addition changes.

namespace alidade {
namespace {

using test::Shell;
using test::Source;
using testing::HasSubstr;
using testing::Le;

struct Addition {
  std::string name;  ///< as in the table, and above its command
  std::size_t most;  ///< files; 0: no aim
};

class AddingTest : public testing::TestWithParam<Addition> {
 protected:
  AddingTest() {
    std::istringstream page(test::ReadFile(Source("docs/adding.md")));
    bool in_command = false;
    for (std::string line; std::getline(page, line);) {
      if (line.rfind("| " + GetParam().name + " |", 0) == 0) {
        row_ = line;
      }
      const bool indented = line.rfind("    ", 0) == 0;
      if (line.rfind("    # ", 0) == 0) {
        in_command = line == "    # " + GetParam().name;
      } else if (in_command && indented) {
        command_ += line + "\n";
      } else {
        in_command = false;
      }
    }
  }

  std::string row_;
  std::string command_;
};

TEST_P(AddingTest, GivenThePageThenItsCommandPrintsTheFilesOfItsTable) {
  ASSERT_FALSE(row_.empty());
  ASSERT_FALSE(command_.empty());
  std::size_t stated = 0;
  ASSERT_EQ(std::sscanf(row_.c_str() + GetParam().name.size() + 4, " %zu |", &stated), 1) << row_;
  const test::CommandResult found = Shell("cd '" + Source("") + "' && " + command_);
  ASSERT_EQ(found.code, 0) << found.output;
  std::size_t count = 0;
  std::istringstream files(found.output);
  for (std::string file; std::getline(files, file); ++count) {
    if (GetParam().most > 0) {
      EXPECT_THAT(row_, HasSubstr(std::filesystem::path(file).stem().string())) << file;
    }
  }
  EXPECT_EQ(count, stated) << found.output;
  if (GetParam().most > 0) {
    EXPECT_THAT(count, Le(GetParam().most)) << found.output;
  }
}

INSTANTIATE_TEST_SUITE_P(Additions, AddingTest,
                         testing::Values(Addition{"a visual residual", 8}, Addition{"a sensor", 15},
                                         Addition{"a second camera", 0}, Addition{"a dataset format", 6},
                                         Addition{"an error convention", 5}),
                         [](const auto& addition) {
                           std::string name = addition.param.name;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

}  // namespace
}  // namespace alidade
