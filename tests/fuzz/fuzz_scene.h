#pragma once

#include "eval/dataset/dataset.h"

namespace alidade::test {

/// Three seconds of a figure-8 with 30 tracks, IMU of 100 Hz, GNSS and position fixes.
const Dataset& FuzzScene();

}  // namespace alidade::test
