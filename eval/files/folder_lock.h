#pragma once

#include <string>

#include "core/status.h"

namespace alidade {

/// Makes this process the only writer of `folder`, which exists, until it and the processes it has started
/// end, however they end: an advisory lock of the folder itself (flock), which leaves no file. Held until the
/// process ends; a second call for the same folder does nothing. Error (kOutput): another process holds it.
/// A file system without locks is taken as it is.
Status LockFolder(const std::string& folder);

}  // namespace alidade
