#pragma once

#include <string>
#include <vector>

#include "eval/bag/bag_import.h"

namespace alidade {

/// Reads a bag (ReadBag) and writes it as a folder in the extended ASL layout: raw images become grey PNG
/// files, compressed ones keep their bytes. `options.take_image` is ignored. Returns the remarks of the
/// import. Errors: those of ReadBag; kOutput.
Result<std::vector<std::string>> ConvertBagToFolder(const std::string& bag, BagImportOptions options,
                                                    const std::string& folder);

}  // namespace alidade
