#pragma once

#include <filesystem>

namespace alidade {

/// Whether `path` is `folder` or below it, whatever links lead there; `path` need not exist.
[[nodiscard]] bool LiesIn(const std::filesystem::path& path, const std::filesystem::path& folder);

}  // namespace alidade
