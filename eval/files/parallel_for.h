#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <thread>
#include <vector>

#include "core/status.h"

namespace alidade {

/// Calls work(i) for i in [0, count) on `jobs` threads, each i once, in no particular order. After a failure
/// no further i is started; of several failures the one with the smallest i is returned.
template <typename Work>
Status ParallelFor(std::size_t count, int jobs, const Work& work) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::mutex mutex;
  std::size_t first_failure = count;
  Status failure;
  const auto loop = [&] {
    for (std::size_t i = next++; i < count && !failed; i = next++) {
      Status status = work(i);
      if (!status.ok()) {
        failed = true;
        const std::lock_guard<std::mutex> lock(mutex);
        if (i < first_failure) {
          first_failure = i;
          failure = std::move(status);
        }
      }
    }
  };
  std::vector<std::thread> threads;
  for (int k = 1; k < std::min(jobs, static_cast<int>(std::min<std::size_t>(count, 1024))); ++k) {
    threads.emplace_back(loop);
  }
  loop();
  for (std::thread& thread : threads) {
    thread.join();
  }
  return failure;
}

}  // namespace alidade
