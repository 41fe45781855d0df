#include "eval/rosbag/ros_message.h"

#include <algorithm>
#include <map>
#include <sstream>

#include "eval/files/hash.h"

namespace alidade {
namespace {

/// Fields by type; another message in them is named in full, so that this table is complete.
const std::map<std::string, std::string>& Fields() {
  static const std::map<std::string, std::string> fields = {
      {"std_msgs/Header", "uint32 seq\ntime stamp\nstring frame_id\n"},
      {"std_msgs/String", "string data\n"},
      {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
      {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
      {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
      {"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
      {"geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"},
      {"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
      {"geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
      {"geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"},
      {"geometry_msgs/PointStamped", "std_msgs/Header header\ngeometry_msgs/Point point\n"},
      {"geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
      {"geometry_msgs/PoseWithCovarianceStamped",
       "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n"},
      {"geometry_msgs/TransformStamped",
       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
      {"nav_msgs/Odometry",
       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
       "geometry_msgs/TwistWithCovariance twist\n"},
      {"sensor_msgs/Imu",
       "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
       "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
       "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"},
      {"sensor_msgs/Image",
       "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 "
       "step\n"
       "uint8[] data\n"},
      // Constants come first, as ROS sums them up.
      {"sensor_msgs/NavSatStatus",
       "int8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nint8 STATUS_SBAS_FIX=1\nint8 STATUS_GBAS_FIX=2\n"
       "uint16 SERVICE_GPS=1\nuint16 SERVICE_GLONASS=2\nuint16 SERVICE_COMPASS=4\nuint16 SERVICE_GALILEO=8\n"
       "int8 status\nuint16 service\n"},
      {"sensor_msgs/NavSatFix",
       "uint8 COVARIANCE_TYPE_UNKNOWN=0\nuint8 COVARIANCE_TYPE_APPROXIMATED=1\n"
       "uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN=2\nuint8 COVARIANCE_TYPE_KNOWN=3\n"
       "std_msgs/Header header\nsensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\n"
       "float64 altitude\nfloat64[9] position_covariance\nuint8 position_covariance_type\n"},
      {"sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n"},
      // GNSS messages of gnss_comm and the trigger of GVINS: github.com/HKUST-Aerial-Robotics
      {"gnss_comm/GnssTimeMsg", "uint32 week\nfloat64 tow\n"},
      {"gnss_comm/GnssObsMsg",
       "gnss_comm/GnssTimeMsg time\nuint32 sat\nfloat64[] freqs\nfloat64[] CN0\nuint8[] LLI\nuint8[] code\n"
       "float64[] psr\nfloat64[] psr_std\nfloat64[] cp\nfloat64[] cp_std\nfloat64[] dopp\nfloat64[] "
       "dopp_std\n"
       "uint8[] status\n"},
      {"gnss_comm/GnssMeasMsg", "gnss_comm/GnssObsMsg[] meas\n"},
      {"gnss_comm/GnssEphemMsg",
       "uint32 sat\ngnss_comm/GnssTimeMsg ttr\ngnss_comm/GnssTimeMsg toe\ngnss_comm/GnssTimeMsg toc\n"
       "float64 toe_tow\nuint32 week\nuint32 iode\nuint32 iodc\nuint32 health\nuint32 code\nfloat64 ura\n"
       "float64 A\nfloat64 e\nfloat64 i0\nfloat64 omg\nfloat64 OMG0\nfloat64 M0\nfloat64 delta_n\n"
       "float64 OMG_dot\nfloat64 i_dot\nfloat64 cuc\nfloat64 cus\nfloat64 crc\nfloat64 crs\nfloat64 cic\n"
       "float64 cis\nfloat64 af0\nfloat64 af1\nfloat64 af2\nfloat64 tgd0\nfloat64 tgd1\nfloat64 A_dot\n"
       "float64 n_dot\n"},
      {"gnss_comm/GnssGloEphemMsg",
       "uint32 sat\ngnss_comm/GnssTimeMsg ttr\ngnss_comm/GnssTimeMsg toe\nint32 freqo\nuint32 iode\n"
       "uint32 health\nuint32 age\nfloat64 ura\nfloat64 pos_x\nfloat64 pos_y\nfloat64 pos_z\nfloat64 vel_x\n"
       "float64 vel_y\nfloat64 vel_z\nfloat64 acc_x\nfloat64 acc_y\nfloat64 acc_z\nfloat64 tau_n\n"
       "float64 gamma\nfloat64 delta_tau_n\n"},
      {"gnss_comm/GnssPVTSolnMsg",
       "gnss_comm/GnssTimeMsg time\nuint8 fix_type\nbool valid_fix\nbool diff_soln\nuint8 carr_soln\n"
       "uint8 num_sv\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\nfloat64 height_msl\n"
       "float64 h_acc\nfloat64 v_acc\nfloat64 p_dop\nfloat64 vel_n\nfloat64 vel_e\nfloat64 vel_d\n"
       "float64 vel_acc\n"},
      {"gnss_comm/GnssTimePulseInfoMsg", "gnss_comm/GnssTimeMsg time\nbool utc_based\nuint32 time_sys\n"},
      {"gnss_comm/StampedFloat64Array", "std_msgs/Header header\nfloat64[] data\n"},
      {"gvins/LocalSensorExternalTrigger",
       "std_msgs/Header header\nuint32 trigger_id\nuint32 event_id\ntime timestamp_host\n"},
      // Ours: what a folder holds and no standard message does.
      {"alidade/Tracks",
       "std_msgs/Header header\nint64[] track_id\nfloat64[] u_px\nfloat64[] v_px\n"
       "float64[] noise_ratio\n"},
      {"alidade/Position", "std_msgs/Header header\ngeometry_msgs/Vector3 position\nfloat64[9] covariance\n"},
      {"alidade/State",
       // Row-major: a quaternion would round the rotation.
       "std_msgs/Header header\ngeometry_msgs/Vector3 p_WB\nfloat64[9] R_WB\nbool has_velocity\n"
       "geometry_msgs/Vector3 v_WB\ngeometry_msgs/Vector3 gyro_bias\ngeometry_msgs/Vector3 accel_bias\n"}};
  return fields;
}

/// The message a field's type names, "[]" cut off; empty for a built-in type.
std::string MessageIn(const std::string& field_type) {
  const std::string base = field_type.substr(0, field_type.find('['));
  return Fields().count(base) != 0 ? base : std::string();
}

/// The messages inside `type`, each once, in the order in which they come up.
void CollectInner(const std::string& type, std::vector<std::string>* inner) {
  std::istringstream fields(Fields().at(type));
  std::vector<std::string> fresh;
  for (std::string field, name; fields >> field >> name;) {
    const std::string message = MessageIn(field);
    if (!message.empty() && std::find(inner->begin(), inner->end(), message) == inner->end()) {
      inner->push_back(message);
      fresh.push_back(message);
    }
  }
  for (const std::string& message : fresh) {
    CollectInner(message, inner);
  }
}

}  // namespace

std::vector<std::string> RosTypes() {
  std::vector<std::string> types;
  for (const auto& [type, fields] : Fields()) {
    types.push_back(type);
  }
  return types;
}

std::string RosDefinition(const std::string& type) {
  if (Fields().count(type) == 0) {
    return {};
  }
  std::string text = Fields().at(type);
  std::vector<std::string> inner;
  CollectInner(type, &inner);
  for (const std::string& message : inner) {
    text += "\n" + std::string(80, '=') + "\nMSG: " + message + "\n" + Fields().at(message);
  }
  return text;
}

std::string RosMd5(const std::string& type) {
  if (Fields().count(type) == 0) {
    return {};
  }
  std::istringstream fields(Fields().at(type));
  std::string text;
  for (std::string field, name; fields >> field >> name;) {
    const std::string message = MessageIn(field);
    text += (text.empty() ? "" : "\n") + (message.empty() ? field : RosMd5(message)) + " " + name;
  }
  return HashHex(text, HashKind::kMd5);
}

}  // namespace alidade
