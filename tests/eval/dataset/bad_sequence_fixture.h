#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

namespace alidade::test {

struct FileCase {
  const char* story;
  const char* file;  ///< under mav0; its content is replaced, or removed when `content` is empty
  std::string content;
  std::vector<std::string> said;  ///< what the message must contain
};

inline std::ostream& operator<<(std::ostream& stream, const FileCase& c) {
  return stream << c.story;
}

class BadSequence : public testing::TestWithParam<FileCase> {};

}  // namespace alidade::test
