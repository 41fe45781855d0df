#pragma once

#include <string>
#include <string_view>

#include "core/status.h"
#include "core/time.h"
#include "gnss/formats/ephemeris.h"

namespace alidade {

// Further messages of gnss_comm (eval/rosbag/gnss_messages.h): ionosphere, solution and time of a receiver.

/// StampedFloat64Array with the eight Klobuchar parameters.
[[nodiscard]] std::string EncodeIonosphere(TimeNs stamp_ns, const KlobucharParameters& parameters);
Result<KlobucharParameters> DecodeIonosphere(std::string_view bytes);

/// GnssPVTSolnMsg: the receiver's own solution.
struct ReceiverSolution {
  TimeNs stamp_ns = 0;  ///< GPST
  bool valid = false;
  int carrier = 0;  ///< 0 no carrier phase, 1 float, 2 fixed
  double latitude_deg = 0;
  double longitude_deg = 0;
  double height_m = 0;  ///< above the ellipsoid
  double horizontal_accuracy_m = 0;
  double vertical_accuracy_m = 0;
};
[[nodiscard]] std::string EncodeSolution(const ReceiverSolution& solution);
Result<ReceiverSolution> DecodeSolution(std::string_view bytes);

/// GnssTimePulseInfoMsg: GPST of the next pulse. An external trigger is LocalSensorExternalTrigger: the time
/// of the pulse in the clock of camera and IMU.
[[nodiscard]] std::string EncodeTimePulse(TimeNs pulse_ns);
Result<TimeNs> DecodeTimePulse(std::string_view bytes);
[[nodiscard]] std::string EncodeTrigger(TimeNs stamp_ns);
Result<TimeNs> DecodeTrigger(std::string_view bytes);

}  // namespace alidade
