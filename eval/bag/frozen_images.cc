#include "eval/bag/frozen_images.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/format.h"
#include "eval/bag/dataset_images.h"

namespace alidade {

void CheckFrozenImages(const Dataset& dataset, Findings* findings) {
  constexpr std::size_t kSample = 8;
  constexpr std::size_t kLeast = 3;
  const std::size_t count = std::min(kSample, dataset.images.size());
  if (count < kLeast) {
    return;
  }
  DatasetImages images;
  std::optional<GreyImage> first;
  std::size_t equal = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Result<GreyImage> image = images.Read(dataset.images[i * (dataset.images.size() - 1) / (count - 1)]);
    if (!image.ok()) {
      continue;  // named by whoever reads all of them
    }
    if (!first) {
      first = std::move(*image);
    } else if (image->pixels != first->pixels) {
      return;
    }
    ++equal;
  }
  if (equal >= kLeast) {
    findings->Error(Format(
        "cam0: %zu images, sampled evenly from %zu, are equal to the pixel, expected at least noise: a "
        "camera that is frozen or covered?",
        equal, dataset.images.size()));
  }
}

}  // namespace alidade
