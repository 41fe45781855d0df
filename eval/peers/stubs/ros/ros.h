// In place of ROS: what the peers' sources need to compile.
#pragma once

#include "ros/assert.h"
#include "ros/console.h"
#include "ros/time.h"
#include "ros/topics.h"
