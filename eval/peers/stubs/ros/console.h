// In place of ROS: messages are dropped.
#pragma once

// Standard headers that the real one brings along.
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <vector>

#define ROS_DEBUG(...) static_cast<void>(0)
#define ROS_INFO(...) static_cast<void>(0)
#define ROS_WARN(...) static_cast<void>(0)
#define ROS_ERROR(...) static_cast<void>(0)
#define ROS_DEBUG_STREAM(...) static_cast<void>(0)
#define ROS_INFO_STREAM(...) static_cast<void>(0)
#define ROS_WARN_STREAM(...) static_cast<void>(0)
#define ROS_ERROR_STREAM(...) static_cast<void>(0)
