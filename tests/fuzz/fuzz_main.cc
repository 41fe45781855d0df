#include <cstdio>
#include <cstdlib>

#include "core/check.h"
#include "tests/fuzz/fuzz_targets.h"

// The entry points of libFuzzer. The environment variable ALIDADE_FUZZ_TARGET names what is fed; without it
// the names are listed.

namespace {

const alidade::test::FuzzTarget* g_target = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** argv) {
  using namespace alidade::test;
  google::InitGoogleLogging((*argv)[0]);
  FLAGS_minloglevel = google::GLOG_FATAL;
  const char* name = std::getenv("ALIDADE_FUZZ_TARGET");
  if (name == nullptr) {
    for (const auto targets : {ReaderTargets(), SequenceTargets(), SessionTargets()}) {
      for (const FuzzTarget& target : targets) {
        std::puts(target.name);
      }
    }
    std::exit(0);
  }
  g_target = FindFuzzTarget(name);
  if (g_target == nullptr) {
    std::fprintf(stderr, "ALIDADE_FUZZ_TARGET=%s: no such target\n", name);
    std::exit(2);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  g_target->take({reinterpret_cast<const char*>(data), size});
  return 0;
}
