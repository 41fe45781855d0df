#pragma once

#include <string>

#include "core/status.h"

namespace alidade {

/// MD5 of a file's content, 32 lower-case hexadecimal digits: for archives whose publisher states nothing
/// better. kInput: the file cannot be read.
Result<std::string> Md5OfFile(const std::string& path);

}  // namespace alidade
