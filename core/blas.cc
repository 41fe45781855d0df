#include "core/blas.h"

#include <cblas.h>

namespace alidade {

void UseOneThreadPerBlasCall() {
  // A static of a function is initialised once, by one thread while the others wait.
  [[maybe_unused]] static const bool set = [] {
    openblas_set_num_threads(1);
    return true;
  }();
}

bool BlasIsThreadSafe() {
  return openblas_get_parallel() != 0;
}

}  // namespace alidade
