#pragma once

#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_findings.h"

namespace alidade {

/// Decodes a sample of the images, spread evenly over the sequence, and compares them: an error where all are
/// equal to the pixel. A camera has noise even at rest; one that is frozen or covered from the start has not.
/// Nothing from fewer than three images that can be read.
void CheckFrozenImages(const Dataset& dataset, Findings* findings);

}  // namespace alidade
