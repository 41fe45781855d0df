#pragma once

#include <string>
#include <vector>

namespace alidade {

/// Names of all messages known here, such as "sensor_msgs/Imu".
[[nodiscard]] std::vector<std::string> RosTypes();

/// Definition of a message as in a connection header: its fields, then those of the messages in it. Empty for
/// an unknown type.
[[nodiscard]] std::string RosDefinition(const std::string& type);

/// The checksum by which ROS identifies a definition: MD5 over the fields, with the checksum of a message in
/// place of its name (wiki.ros.org/ROS/Technical Overview, "Message serialization and msg MD5 sums"). Empty
/// for an unknown type.
[[nodiscard]] std::string RosMd5(const std::string& type);

}  // namespace alidade
