#include "eval/bag/bag_sheets.h"

#include "eval/bag/bag_topics.h"

namespace alidade {

const std::string* BagSheets::Text(const std::string& sensor) const {
  const auto found = sheets_.find(SheetTopic(sensor));
  return found == sheets_.end() ? nullptr : &found->second;
}

Result<ImuSensor> BagSheets::Imu(const std::optional<ImuSensor>& given) const {
  if (given) {
    return *given;
  }
  const std::string* sheet = Text("imu0");
  return sheet != nullptr
             ? ParseImuSensor(*sheet, path_ + ": " + SheetTopic("imu0"))
             : Status::Input(path_ + ": holds no noise of the IMU, expected --calibration=FILE with it");
}

Result<CameraSensor> BagSheets::Camera(const std::string& sensor,
                                       const std::optional<CameraSensor>& given) const {
  if (given) {
    return *given;
  }
  const std::string* sheet = Text(sensor);
  return sheet != nullptr
             ? ParseCameraSensor(*sheet, path_ + ": " + SheetTopic(sensor))
             : Status::Input(path_ +
                             ": holds no calibration of the camera, expected --calibration=FILE with it");
}

}  // namespace alidade
