#pragma once

namespace alidade::vins {

/// Whether solves of VINS-Mono or GVINS may end by wall time, as published (40 ms a window, limits of its own
/// in the initialisation): results then depend on the machine. Without a call they end by iterations alone.
void SetRealTime(bool real_time);

}  // namespace alidade::vins
