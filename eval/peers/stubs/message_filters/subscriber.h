// In place of ROS: included by the peers, used by what is not built of them.
#pragma once
