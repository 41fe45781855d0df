#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "core/status.h"
#include "eval/dataset/dataset.h"

namespace alidade {

// A sequence may be written over another one. What the new one does not have must not stay from the old one:
// it would be read as a part of the new one.

/// True when `mav` is the folder that the dataset was read from: all in it belongs to it, and nothing goes.
[[nodiscard]] bool IsItsOwnFolder(const Dataset& dataset, const std::string& mav);

/// Removes these files of `folder`, where they exist, or the whole of `folder`; of a link only the link.
/// Errors: kOutput naming the path and the system's reason.
Status RemoveStaleFiles(const std::string& folder, std::initializer_list<const char*> names);
Status RemoveStaleFolder(const std::string& folder);

/// The paths of the entries of `mav` that are named `stem` and a number from `first` on: fix2, fix3, ...
[[nodiscard]] std::vector<std::string> NumberedFolders(const std::string& mav, const std::string& stem,
                                                       std::size_t first);

}  // namespace alidade
