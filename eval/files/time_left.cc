#include "eval/files/time_left.h"

#include "core/format.h"

namespace alidade {

std::string TimeLeft(double elapsed_s, size_t done, size_t total) {
  if (elapsed_s < 10 || done == 0 || done >= total) {
    return {};
  }
  const double left_s = elapsed_s / static_cast<double>(done) * static_cast<double>(total - done);
  if (left_s < 90) {
    return Format(", about %.0f s left", left_s);
  }
  return left_s < 90 * 60 ? Format(", about %.0f min left", left_s / 60)
                          : Format(", about %.1f h left", left_s / 3600);
}

}  // namespace alidade
