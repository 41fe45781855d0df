// In place of ROS: the pointers that its generator declares beside a message.
#pragma once

#include <memory>

#define STUB_POINTERS(Message)                   \
  using Message##Ptr = std::shared_ptr<Message>; \
  using Message##ConstPtr = std::shared_ptr<const Message>
#define STUB_POINTERS_WITHIN(Message)   \
  using Ptr = std::shared_ptr<Message>; \
  using ConstPtr = std::shared_ptr<const Message>
