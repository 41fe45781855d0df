#pragma once

#include <sys/types.h>

#include <cstdint>

namespace alidade {

/// Memory that a process and all its descendants hold for themselves [bytes]: resident pages without those
/// that stand in files or are shared (resident - shared of /proc/PID/statm). A process that has ended counts
/// nothing.
int64_t MemoryOfTree(pid_t root);

/// Ends a process and all its descendants (SIGKILL). They are stopped first, so that none starts another
/// meanwhile. Does not wait for them.
void KillTree(pid_t root);

}  // namespace alidade
