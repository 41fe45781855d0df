#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "eval/dataset/dataset.h"
#include "eval/peers/gnss_comm_messages.h"

namespace alidade {

/// What a system that reads messages of gnss_comm is given of a sequence's GNSS.
struct PeerGnss {
  struct Epoch {
    TimeNs tag_ns = 0;    ///< GPST
    TimeNs stamp_ns = 0;  ///< IMU time
    std::shared_ptr<const gnss_comm::GnssMeasMsg> message;
  };
  std::vector<std::shared_ptr<const gnss_comm::GnssEphemMsg>> ephemerides;
  std::vector<std::shared_ptr<const gnss_comm::GnssGloEphemMsg>> glonass;
  std::vector<std::shared_ptr<const gnss_comm::StampedFloat64Array>> ionosphere;  ///< Klobuchar's eight
  std::vector<Epoch> epochs;                                                      ///< strictly rising stamps
  /// Ephemerides left out because of their accuracy (below), and measurements without deviations.
  int unweighable = 0;
};

/// The messages of a sequence: those of the bag at `dataset.path` as they were recorded, or those that a bag
/// of the folder would hold. Without GNSS all is empty. Left out is what the weights of gnss_comm's readers
/// divide by zero or a negative number for: ephemerides with an accuracy of at most 1 m (GPS, BeiDou), 2 m
/// (Galileo), 0 m (GLONASS), and satellites whose signal of the first band (L1, E1, B1I, G1) has a deviation
/// of zero. kInput: a bag that cannot be read, a message that is torn.
Result<PeerGnss> ReadPeerGnss(const Dataset& dataset);

}  // namespace alidade
