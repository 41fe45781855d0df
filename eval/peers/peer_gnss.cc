#include "eval/peers/peer_gnss.h"

#include <algorithm>

#include "eval/bag/bag_import.h"
#include "eval/bag/bag_parts.h"
#include "eval/rosbag/gnss_messages.h"
#include "eval/rosbag/gnss_navigation_messages.h"
#include "eval/rosbag/gnss_receiver_messages.h"
#include "eval/rosbag/rosbag_reader.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {
namespace {

/// Takes messages by their bytes.
class Collector {
 public:
  explicit Collector(TimeNs offset_ns) : offset_ns_(offset_ns) {}

  Status Take(const std::string& type, bool gps_ionosphere, std::string_view bytes) {
    if (type == "gnss_comm/GnssMeasMsg") {
      return TakeEpoch(bytes);
    }
    if (type == "gnss_comm/GnssEphemMsg") {
      return Keep(ReadEphemMsg(bytes), LeastAccuracy, &gnss_.ephemerides);
    }
    if (type == "gnss_comm/GnssGloEphemMsg") {
      return Keep(
          ReadGloEphemMsg(bytes), [](std::uint32_t) { return 0.0; }, &gnss_.glonass);
    }
    if (type == "gnss_comm/StampedFloat64Array" && gps_ionosphere) {
      const auto message = ReadFloat64ArrayMsg(bytes);
      ALIDADE_RETURN_IF_ERROR(message.status());
      gnss_.ionosphere.push_back(*message);
    }
    return Status::Ok();
  }

  PeerGnss Finish() {
    const auto earlier = [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; };
    const auto same = [](const auto& a, const auto& b) { return a.stamp_ns == b.stamp_ns; };
    std::stable_sort(gnss_.epochs.begin(), gnss_.epochs.end(), earlier);
    gnss_.epochs.erase(std::unique(gnss_.epochs.begin(), gnss_.epochs.end(), same), gnss_.epochs.end());
    return std::move(gnss_);
  }

 private:
  static double LeastAccuracy(std::uint32_t number) {
    const std::optional<SatelliteId> satellite = SatelliteOfGnssCommNumber(number);
    return satellite && satellite->system == GnssSystem::kGalileo ? 2 : 1;
  }

  /// Whether every signal of the first band has both deviations.
  static bool IsWeighable(const gnss_comm::GnssObsMsg& m) {
    constexpr double kFirstBandLowHz = 1.55e9, kFirstBandHighHz = 1.61e9;
    for (std::size_t i = 0; i < m.freqs.size(); ++i) {
      const bool first = m.freqs[i] > kFirstBandLowHz && m.freqs[i] < kFirstBandHighHz;
      const bool weighable =
          i < m.psr_std.size() && m.psr_std[i] > 0 && i < m.dopp_std.size() && m.dopp_std[i] > 0;
      if (first && !weighable) {
        return false;
      }
    }
    return true;
  }

  template <typename Message, typename Least>
  Status Keep(Result<std::shared_ptr<Message>> message, Least least,
              std::vector<std::shared_ptr<const Message>>* list) {
    ALIDADE_RETURN_IF_ERROR(message.status());
    if ((*message)->ura > least((*message)->sat)) {
      list->push_back(*message);
    } else {
      ++gnss_.unweighable;
    }
    return Status::Ok();
  }

  Status TakeEpoch(std::string_view bytes) {
    auto message = ReadMeasMsg(bytes);
    ALIDADE_RETURN_IF_ERROR(message.status());
    std::map<int, int> channels;
    const Result<ObservationEpoch> decoded = DecodeMeasurements(bytes, &channels);
    ALIDADE_RETURN_IF_ERROR(decoded.status());
    gnss_.unweighable += static_cast<int>(
        std::erase_if((*message)->meas, [](const gnss_comm::GnssObsMsg& m) { return !IsWeighable(m); }));
    if (!(*message)->meas.empty()) {
      gnss_.epochs.push_back({decoded->stamp_ns, decoded->stamp_ns + offset_ns_, *message});
    }
    return Status::Ok();
  }

  TimeNs offset_ns_;
  PeerGnss gnss_;
};

Status TakeBag(const std::string& path, Collector* collector) {
  const Result<BagTopics> topics = MakeBagTopics("");
  ALIDADE_RETURN_IF_ERROR(topics.status());
  Result<RosbagReader> bag = RosbagReader::Open(path);
  ALIDADE_RETURN_IF_ERROR(bag.status());
  return bag
      ->Scan([&](const BagMessage& message) {
        return collector->Take(message.connection->type, message.connection->topic == (*topics)["iono"],
                               message.data);
      })
      .status();
}

Status TakeFolder(const GnssLog& log, TimeNs first_ns, Collector* collector) {
  const NavigationData& navigation = log.catalog->navigation();
  const auto take = [&](const char* type, const std::optional<std::string>& bytes) {
    return bytes ? collector->Take(type, true, *bytes) : Status::Ok();
  };
  for (const auto& [id, list] : navigation.kepler) {
    for (const KeplerEphemeris& ephemeris : list) {
      ALIDADE_RETURN_IF_ERROR(take("gnss_comm/GnssEphemMsg", EncodeEphemeris(ephemeris)));
    }
  }
  for (const auto& [number, list] : navigation.glonass) {
    for (const GlonassEphemeris& ephemeris : list) {
      ALIDADE_RETURN_IF_ERROR(take("gnss_comm/GnssGloEphemMsg", EncodeEphemeris(ephemeris)));
    }
  }
  if (navigation.gps_ionosphere) {
    ALIDADE_RETURN_IF_ERROR(
        take("gnss_comm/StampedFloat64Array", EncodeIonosphere(first_ns, *navigation.gps_ionosphere)));
  }
  for (const ObservationEpoch& epoch : log.epochs) {
    ALIDADE_RETURN_IF_ERROR(take("gnss_comm/GnssMeasMsg", EncodeMeasurements(epoch, log.glonass_channels)));
  }
  return Status::Ok();
}

}  // namespace

Result<PeerGnss> ReadPeerGnss(const Dataset& dataset) {
  if (dataset.gnss == nullptr) {
    return PeerGnss{};
  }
  Collector collector(SecondsToNs(dataset.rig.gnss.time_offset_s));
  const Status taken = IsBag(dataset.path)
                           ? TakeBag(dataset.path, &collector)
                           : TakeFolder(*dataset.gnss, dataset.imu.front().stamp_ns, &collector);
  if (!taken.ok()) {
    return Status(taken.code(), dataset.path + ": " + taken.message());
  }
  return collector.Finish();
}

}  // namespace alidade
