#include "tests/fuzz/fuzz_targets.h"

#include <cstdio>
#include <cstdlib>

namespace alidade::test {

const FuzzTarget* FindFuzzTarget(std::string_view name) {
  for (const std::span<const FuzzTarget> targets : {ReaderTargets(), SequenceTargets(), SessionTargets()}) {
    for (const FuzzTarget& target : targets) {
      if (name == target.name) {
        return &target;
      }
    }
  }
  return nullptr;
}

void Require(bool kept, const std::string& property) {
  if (!kept) {
    std::fprintf(stderr, "broken: %s\n", property.c_str());
    std::abort();
  }
}

}  // namespace alidade::test
