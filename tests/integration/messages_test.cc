#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/read_file.h"

// The page of messages against the sources that print them.

namespace alidade::test {
namespace {

namespace fs = std::filesystem;

/// All sources, with string literals that are written in several pieces joined.
std::string Sources() {
  std::string all;
  for (const char* folder : {"core", "eval", "filter", "frontend", "gnss", "smoother"}) {
    for (const fs::directory_entry& entry :
         fs::recursive_directory_iterator(std::string(ALIDADE_SOURCE_DIR) + "/" + folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cc" && extension != ".h") {
        continue;
      }
      const std::string text = ReadFile(entry.path().string());
      for (size_t i = 0; i < text.size(); ++i) {
        const size_t next = text.find_first_not_of(" \n", i + 1);
        const bool joins = text[i] == '"' && next != std::string::npos && next > i + 1 && text[next] == '"' &&
                           text.find('\n', i) < next;
        if (joins) {
          i = next;
        } else {
          all += text[i];
        }
      }
    }
  }
  return all;
}

/// The pieces between `...` of the first column of each row of a table.
std::vector<std::string> Pieces(const std::string& row) {
  std::vector<std::string> pieces;
  const size_t begin = row.find('`') + 1;
  std::string message = row.substr(begin, row.find('`', begin) - begin);
  for (size_t end = 0; end != std::string::npos;) {
    end = message.find("...");
    pieces.push_back(message.substr(0, end));
    message = end == std::string::npos ? "" : message.substr(end + 3);
  }
  return pieces;
}

TEST(MessagesTest, EveryTextOfThePageIsSaidSomewhere) {
  const std::string sources = Sources();
  ASSERT_GT(sources.size(), 1000000U);
  const std::string page = ReadFile(std::string(ALIDADE_SOURCE_DIR) + "/docs/messages.md");
  int rows = 0;
  for (size_t at = 0; at < page.size();) {
    const size_t end = page.find('\n', at);
    const std::string line = page.substr(at, end - at);
    at = end + 1;
    if (line.rfind("| `", 0) != 0) {
      continue;
    }
    ++rows;
    for (const std::string& piece : Pieces(line)) {
      EXPECT_NE(sources.find(piece), std::string::npos) << "'" << piece << "' of: " << line;
    }
  }
  EXPECT_GT(rows, 60);
}

}  // namespace
}  // namespace alidade::test
