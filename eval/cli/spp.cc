#include "eval/cli/command.h"
#include "eval/cli/support.h"

namespace alidade::cli {

int RunSpp(const std::vector<std::string>&) {
  return Report(Status::Usage("spp: GNSS is not in this build"));
}

}  // namespace alidade::cli
