#include "eval/files/lies_in.h"

namespace alidade {

bool LiesIn(const std::filesystem::path& path, const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  for (fs::path above = fs::weakly_canonical(fs::absolute(path), error);; above = above.parent_path()) {
    if (fs::equivalent(above, folder, error)) {
      return true;
    }
    if (above == above.parent_path()) {
      return false;
    }
  }
}

}  // namespace alidade
