#pragma once

#include <string>

#include "core/status.h"
#include "eval/dataset/dataset.h"

namespace alidade {

/// Writes all but the images of a sequence under `path`. Numbers are the shortest text that reads back equal.
/// Parts of another sequence there that this one does not have are removed.
Status WriteDataset(const Dataset& dataset, const std::string& path);

}  // namespace alidade
