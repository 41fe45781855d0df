// In place of ROS: a broken assumption ends the program with its text.
#pragma once

#include <cstdio>
#include <cstdlib>

#define ROS_BREAK() (std::fprintf(stderr, "%s:%d: gave up\n", __FILE__, __LINE__), std::abort())
#define ROS_ASSERT(condition) ((condition) ? static_cast<void>(0) : ROS_BREAK())
#define ROS_ASSERT_MSG(condition, ...) ROS_ASSERT(condition)
