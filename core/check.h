#pragma once

#include <glog/logging.h>

// CHECK, CHECK_EQ and friends guard against programmer mistakes only; bad input is a Status (core/status.h).
