#include "eval/bag/bag_gnss.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "core/format.h"
#include "eval/dataset/dataset_gnss.h"
#include "eval/rosbag/gnss_messages.h"
#include "eval/rosbag/gnss_navigation_messages.h"
#include "gnss/base/geodesy.h"
#include "gnss/model/gnss_epoch.h"
#include "gnss/positioning/time_check.h"

namespace alidade {
namespace {

constexpr int kFixedCarrier = 2;
/// Beside the topic of `iono`; it cannot be named.
constexpr const char* kBeidouIonosphere = "/ublox_driver/iono_params_bds";

Eigen::Vector3d PositionOf(const ReceiverSolution& solution) {
  constexpr double kRadians = std::numbers::pi / 180;
  return ToEcef({solution.latitude_deg * kRadians, solution.longitude_deg * kRadians, solution.height_m});
}

void ScheduleObservations(const Dataset& dataset, const BagTopics& topics, BagSchedule* schedule) {
  const GnssLog& gnss = *dataset.gnss;
  const std::uint32_t range = schedule->AddTopic(topics["range"], "gnss_comm/GnssMeasMsg");
  const std::uint32_t pulse = schedule->AddTopic(topics["pulse"], "gnss_comm/GnssTimePulseInfoMsg");
  const std::uint32_t trigger = schedule->AddTopic(topics["trigger"], "gvins/LocalSensorExternalTrigger");
  const TimeNs offset_ns = SecondsToNs(dataset.rig.gnss.time_offset_s);
  TimeNs next_pulse_ns = INT64_MIN;
  for (const ObservationEpoch& epoch : gnss.epochs) {
    const TimeNs stamp_ns = epoch.stamp_ns + offset_ns;
    schedule->Add(stamp_ns, range,
                  [&epoch, &gnss] { return EncodeMeasurements(epoch, gnss.glonass_channels); });
    if (epoch.stamp_ns >= next_pulse_ns) {
      const TimeNs pulse_ns = (epoch.stamp_ns / kSecondNs + 1) * kSecondNs;
      next_pulse_ns = pulse_ns;
      schedule->Add(stamp_ns, pulse, [pulse_ns] { return EncodeTimePulse(pulse_ns); });
      const TimeNs local_ns = pulse_ns + offset_ns;
      schedule->Add(local_ns, trigger, [local_ns] { return EncodeTrigger(local_ns); });
    }
  }
}

void ScheduleNavigation(const NavigationData& navigation, const BagTopics& topics, BagSchedule* schedule) {
  const std::uint32_t kepler = schedule->AddTopic(topics["ephem"], "gnss_comm/GnssEphemMsg");
  const std::uint32_t glonass = schedule->AddTopic(topics["glo_ephem"], "gnss_comm/GnssGloEphemMsg");
  const TimeNs start_ns = schedule->Start();
  const auto add = [&](std::uint32_t topic, const auto& ephemeris) {
    if (std::optional<std::string> message = EncodeEphemeris(ephemeris)) {
      schedule->Add(start_ns, topic, [message = *message] { return message; });
    }
  };
  for (const auto& [id, list] : navigation.kepler) {
    for (const KeplerEphemeris& ephemeris : list) {
      add(kepler, ephemeris);
    }
  }
  for (const auto& [number, list] : navigation.glonass) {
    for (const GlonassEphemeris& ephemeris : list) {
      add(glonass, ephemeris);
    }
  }
  for (const auto& [name, parameters] :
       {std::pair(topics["iono"], navigation.gps_ionosphere),
        std::pair(std::string(kBeidouIonosphere), navigation.beidou_ionosphere)}) {
    if (parameters) {
      const std::uint32_t topic = schedule->AddTopic(name, "gnss_comm/StampedFloat64Array");
      schedule->Add(start_ns, topic,
                    [start_ns, parameters = *parameters] { return EncodeIonosphere(start_ns, parameters); });
    }
  }
}

}  // namespace

std::vector<BagTopic> GnssTopics() {
  using Search = BagTopic::Search;
  return {{"range", "/ublox_driver/range_meas", {"gnss_comm/GnssMeasMsg"}, Search::kByType},
          {"ephem", "/ublox_driver/ephem", {"gnss_comm/GnssEphemMsg"}, Search::kByType},
          {"glo_ephem", "/ublox_driver/glo_ephem", {"gnss_comm/GnssGloEphemMsg"}, Search::kByType},
          {"iono", "/ublox_driver/iono_params", {"gnss_comm/StampedFloat64Array"}},
          {"pvt", "/ublox_driver/receiver_pvt", {"gnss_comm/GnssPVTSolnMsg"}, Search::kByType},
          {"pulse", "/ublox_driver/time_pulse_info", {"gnss_comm/GnssTimePulseInfoMsg"}, Search::kByType},
          {"trigger", "/external_trigger", {"gvins/LocalSensorExternalTrigger"}}};
}

Result<bool> BagGnss::Take(const BagMessage& message, BagContext* bag) {
  const Result<bool> taken = Decode(bag->topics, message);
  if (!taken.ok()) {
    bag->remarks.AddSkipped(message.connection->topic, taken.message());
    return true;
  }
  return *taken;
}

Result<bool> BagGnss::Decode(const BagTopics& topics, const BagMessage& message) {
  const std::string& topic = message.connection->topic;
  const std::string& type = message.connection->type;
  if (topic == topics["range"] && type == "gnss_comm/GnssMeasMsg") {
    Result<ObservationEpoch> epoch = DecodeMeasurements(message.data, &glonass_channels_);
    ALIDADE_RETURN_IF_ERROR(epoch.status());
    epochs_.push_back(*std::move(epoch));
  } else if (topic == topics["ephem"] && type == "gnss_comm/GnssEphemMsg") {
    const Result<KeplerEphemeris> ephemeris = DecodeKeplerEphemeris(message.data);
    ALIDADE_RETURN_IF_ERROR(ephemeris.status());
    navigation_.kepler[ephemeris->satellite].push_back(*ephemeris);
  } else if (topic == topics["glo_ephem"] && type == "gnss_comm/GnssGloEphemMsg") {
    const Result<GlonassEphemeris> ephemeris = DecodeGlonassEphemeris(message.data);
    ALIDADE_RETURN_IF_ERROR(ephemeris.status());
    navigation_.glonass[ephemeris->satellite.number].push_back(*ephemeris);
    glonass_channels_.try_emplace(ephemeris->satellite.number, ephemeris->channel);
  } else if (topic == topics["iono"] || topic == kBeidouIonosphere) {
    const Result<KlobucharParameters> parameters = DecodeIonosphere(message.data);
    ALIDADE_RETURN_IF_ERROR(parameters.status());
    (topic == topics["iono"] ? navigation_.gps_ionosphere : navigation_.beidou_ionosphere) = *parameters;
  } else if (topic == topics["pvt"] && type == "gnss_comm/GnssPVTSolnMsg") {
    const Result<ReceiverSolution> solution = DecodeSolution(message.data);
    ALIDADE_RETURN_IF_ERROR(solution.status());
    if (solution->valid && solution->carrier == kFixedCarrier) {
      fixed_.push_back(*solution);
    }
  } else if (topic == topics["pulse"] && type == "gnss_comm/GnssTimePulseInfoMsg") {
    const Result<TimeNs> pulse_ns = DecodeTimePulse(message.data);
    ALIDADE_RETURN_IF_ERROR(pulse_ns.status());
    pulse_ns_ = *pulse_ns;
  } else if (topic == topics["trigger"] && pulse_ns_) {
    const Result<TimeNs> local_ns = DecodeTrigger(message.data);
    ALIDADE_RETURN_IF_ERROR(local_ns.status());
    syncs_.push_back({*local_ns, *pulse_ns_});
  } else {
    return false;
  }
  return true;
}

Status BagGnss::Assemble(BagContext* bag) {
  if (epochs_.empty()) {
    return Status::Ok();
  }
  SortByStamp(&epochs_);
  // Receivers repeat their ephemerides; merging keeps each once, in order.
  NavigationData navigation;
  navigation.Merge(std::move(navigation_));
  if (navigation.ephemerides() == 0) {
    bag->remarks.Add("has GNSS observations but no ephemeris; the observations are not used");
  }
  navigation.leap_seconds = LeapSeconds(epochs_.front().stamp_ns);
  auto log = std::make_shared<GnssLog>();
  log->epochs = std::move(epochs_);
  log->glonass_channels = std::move(glonass_channels_);
  log->catalog = std::make_shared<const SatelliteCatalog>(std::move(navigation));
  const std::string* text = bag->sheets.Text("gnss0");
  const std::string sheet = text == nullptr ? std::string() : *text;
  ALIDADE_RETURN_IF_ERROR(AssembleReceiver(sheet, bag));
  if (!sheet.empty()) {
    log->approximate_position_E = ParseGnssSheet(sheet, bag->path)->approximate_position_E;
  } else if (!fixed_.empty()) {
    log->approximate_position_E = PositionOf(fixed_.front());
  }
  if (log->catalog->navigation().ephemerides() > 0) {
    if (const Status tags = CheckTags(*log); !tags.ok()) {
      return Status::Input(bag->path + ": " + bag->topics["range"] + ": " + tags.message());
    }
    bag->dataset.gnss = std::move(log);
    bag->dataset.rig.gnss.is_present = true;
  }
  AssembleTruth(bag);
  return Status::Ok();
}

Status BagGnss::AssembleReceiver(const std::string& sheet, BagContext* bag) const {
  GnssReceiver& receiver = bag->dataset.rig.gnss;
  if (!sheet.empty()) {
    const Result<GnssSheet> parsed = ParseGnssSheet(sheet, bag->path + ": " + SheetTopic("gnss0"));
    ALIDADE_RETURN_IF_ERROR(parsed.status());
    receiver = parsed->receiver;
    return Status::Ok();
  }
  bag->remarks.Add(
      "does not contain the antenna's lever arm; zero is assumed; set p_BA in gnss0/sensor.yaml");
  if (const std::optional<double> offset = TimeOffset()) {
    receiver.time_offset_s = *offset;
    bag->remarks.Add(
        Format("IMU time is GPST %+.6f s, the median over %zu triggers", *offset, syncs_.size()));
  } else {
    bag->remarks.Add(
        "no trigger follows a pulse; IMU time is assumed to be GPST: set time_offset_s in gnss0/sensor.yaml");
  }
  return Status::Ok();
}

std::optional<double> BagGnss::TimeOffset() const {
  std::vector<TimeNs> offsets;
  for (const Sync& sync : syncs_) {
    offsets.push_back(sync.local_ns - sync.pulse_ns);
  }
  if (offsets.empty()) {
    return std::nullopt;
  }
  std::sort(offsets.begin(), offsets.end());
  return SecondsBetween(0, offsets[offsets.size() / 2]);
}

void BagGnss::AssembleTruth(BagContext* bag) {
  if (fixed_.empty() || bag->dataset.truth) {
    return;
  }
  GnssReceiver& receiver = bag->dataset.rig.gnss;
  if (!receiver.anchor_E) {
    receiver.anchor_E = PositionOf(fixed_.front());
  }
  const EnuFrame enu = EnuFrame::At(*receiver.anchor_E);
  const TimeNs offset_ns = SecondsToNs(receiver.time_offset_s);
  Trajectory truth;
  truth.has_orientation = false;
  std::stable_sort(fixed_.begin(), fixed_.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  for (const ReceiverSolution& solution : fixed_) {
    TrajectoryPoint point;
    point.stamp_ns = solution.stamp_ns + offset_ns;
    point.nav.p_WB = enu.FromEcef(PositionOf(solution));
    if (truth.points.empty() || point.stamp_ns > truth.points.back().stamp_ns) {
      truth.points.push_back(point);
    }
  }
  bag->remarks.Add(
      Format("truth is the antenna at %zu fixed solutions, without attitude", truth.points.size()));
  bag->dataset.truth = std::move(truth);
}

void ScheduleGnss(const Dataset& dataset, const BagTopics& topics, BagSchedule* schedule) {
  if (dataset.gnss != nullptr) {
    ScheduleObservations(dataset, topics, schedule);
    ScheduleNavigation(dataset.gnss->catalog->navigation(), topics, schedule);
  }
}

void ScheduleGnssSheet(const Dataset& dataset, BagSchedule* schedule) {
  if (dataset.gnss != nullptr) {
    schedule->AddSheet("gnss0", GnssSensorYaml(dataset.rig.gnss, dataset.gnss->approximate_position_E));
  }
}

}  // namespace alidade
