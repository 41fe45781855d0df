#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace alidade::test {

/// Folder of the real data sets and golden cases: $ALIDADE_SHARED_DIR, else ../shared beside the checkout.
/// Empty when it is absent: tests that need it call ALIDADE_SKIP_WITHOUT_SHARED_DATA.
inline std::string SharedDir() {
  const char* variable = std::getenv("ALIDADE_SHARED_DIR");
  const std::filesystem::path path =
      variable != nullptr ? variable : std::filesystem::path(ALIDADE_SOURCE_DIR) / ".." / "shared";
  return std::filesystem::is_directory(path / "data") ? std::filesystem::weakly_canonical(path).string()
                                                      : std::string();
}

}  // namespace alidade::test

#define ALIDADE_SKIP_WITHOUT_SHARED_DATA()                                                \
  if (::alidade::test::SharedDir().empty()) {                                             \
    GTEST_SKIP() << "real data is absent: set ALIDADE_SHARED_DIR or put it at ../shared"; \
  }
