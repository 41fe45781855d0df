#include "eval/bag/bag_gnss.h"

#include <algorithm>
#include <numbers>

#include "core/format.h"
#include "eval/dataset/dataset_gnss.h"
#include "eval/rosbag/gnss_messages.h"
#include "eval/rosbag/gnss_navigation_messages.h"
#include "gnss/base/geodesy.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {
namespace {

constexpr int kFixedCarrier = 2;

Eigen::Vector3d PositionOf(const ReceiverSolution& solution) {
  constexpr double kRadians = std::numbers::pi / 180;
  return ToEcef({solution.latitude_deg * kRadians, solution.longitude_deg * kRadians, solution.height_m});
}

}  // namespace

Status BagGnss::Take(const BagTopics& topics, const BagMessage& message) {
  const std::string& topic = message.connection->topic;
  const std::string& type = message.connection->type;
  if (topic == topics.range && type == "gnss_comm/GnssMeasMsg") {
    Result<ObservationEpoch> epoch = DecodeMeasurements(message.data, &glonass_channels_);
    ALIDADE_RETURN_IF_ERROR(epoch.status());
    epochs_.push_back(*std::move(epoch));
  } else if (topic == topics.ephemeris && type == "gnss_comm/GnssEphemMsg") {
    const Result<KeplerEphemeris> ephemeris = DecodeKeplerEphemeris(message.data);
    ALIDADE_RETURN_IF_ERROR(ephemeris.status());
    navigation_.kepler[ephemeris->satellite].push_back(*ephemeris);
  } else if (topic == topics.glonass_ephemeris && type == "gnss_comm/GnssGloEphemMsg") {
    const Result<GlonassEphemeris> ephemeris = DecodeGlonassEphemeris(message.data);
    ALIDADE_RETURN_IF_ERROR(ephemeris.status());
    navigation_.glonass[ephemeris->satellite.number].push_back(*ephemeris);
    glonass_channels_.try_emplace(ephemeris->satellite.number, ephemeris->channel);
  } else if (topic == topics.ionosphere || topic == topics.beidou_ionosphere) {
    const Result<KlobucharParameters> parameters = DecodeIonosphere(message.data);
    ALIDADE_RETURN_IF_ERROR(parameters.status());
    (topic == topics.ionosphere ? navigation_.gps_ionosphere : navigation_.beidou_ionosphere) = *parameters;
  } else if (topic == topics.solution && type == "gnss_comm/GnssPVTSolnMsg") {
    const Result<ReceiverSolution> solution = DecodeSolution(message.data);
    ALIDADE_RETURN_IF_ERROR(solution.status());
    if (solution->valid && solution->carrier == kFixedCarrier) {
      fixed_.push_back(*solution);
    }
  } else if (topic == topics.time_pulse && type == "gnss_comm/GnssTimePulseInfoMsg") {
    const Result<TimeNs> pulse_ns = DecodeTimePulse(message.data);
    ALIDADE_RETURN_IF_ERROR(pulse_ns.status());
    pulse_ns_ = *pulse_ns;
  } else if (topic == topics.trigger && pulse_ns_) {
    const Result<TimeNs> local_ns = DecodeTrigger(message.data);
    ALIDADE_RETURN_IF_ERROR(local_ns.status());
    syncs_.push_back({*local_ns, *pulse_ns_});
  }
  return Status::Ok();
}

Status BagGnss::Assemble(const std::string& path, const std::string& sheet, Dataset* dataset,
                         std::vector<std::string>* remarks) {
  if (epochs_.empty()) {
    return Status::Ok();
  }
  const auto before = [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; };
  const auto same = [](const auto& a, const auto& b) { return a.stamp_ns == b.stamp_ns; };
  std::stable_sort(epochs_.begin(), epochs_.end(), before);
  epochs_.erase(std::unique(epochs_.begin(), epochs_.end(), same), epochs_.end());
  // Receivers repeat their ephemerides; merging keeps each once, in order.
  NavigationData navigation;
  navigation.Merge(std::move(navigation_));
  if (navigation.ephemerides() == 0) {
    remarks->push_back(path + ": has GNSS observations but no ephemeris; the observations are not used");
  }
  navigation.leap_seconds = LeapSeconds(epochs_.front().stamp_ns);
  auto log = std::make_shared<GnssLog>();
  log->epochs = std::move(epochs_);
  log->glonass_channels = std::move(glonass_channels_);
  log->catalog = std::make_shared<const SatelliteCatalog>(std::move(navigation));
  ALIDADE_RETURN_IF_ERROR(AssembleReceiver(path, sheet, dataset, remarks));
  if (!sheet.empty()) {
    log->approximate_position_E = ParseGnssSheet(sheet, path)->approximate_position_E;
  } else if (!fixed_.empty()) {
    log->approximate_position_E = PositionOf(fixed_.front());
  }
  if (log->catalog->navigation().ephemerides() > 0) {
    dataset->gnss = std::move(log);
  }
  AssembleTruth(path, dataset, remarks);
  return Status::Ok();
}

Status BagGnss::AssembleReceiver(const std::string& path, const std::string& sheet, Dataset* dataset,
                                 std::vector<std::string>* remarks) const {
  if (!sheet.empty()) {
    const Result<GnssSheet> parsed = ParseGnssSheet(sheet, path + ": " + SheetTopic("gnss0"));
    ALIDADE_RETURN_IF_ERROR(parsed.status());
    dataset->rig.gnss = parsed->receiver;
    return Status::Ok();
  }
  remarks->push_back(
      path + ": does not contain the antenna's lever arm; zero is assumed; set p_BA in gnss0/sensor.yaml");
  if (const std::optional<double> offset = TimeOffset()) {
    dataset->rig.gnss.time_offset_s = *offset;
    remarks->push_back(
        path + Format(": IMU time is GPST %+.6f s, the median over %zu triggers", *offset, syncs_.size()));
  } else {
    remarks->push_back(path +
                       ": no trigger follows a pulse; IMU time is assumed to be GPST: set time_offset_s in "
                       "gnss0/sensor.yaml");
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

void BagGnss::AssembleTruth(const std::string& path, Dataset* dataset, std::vector<std::string>* remarks) {
  if (fixed_.empty() || dataset->truth) {
    return;
  }
  if (!dataset->rig.gnss.anchor_E) {
    dataset->rig.gnss.anchor_E = PositionOf(fixed_.front());
  }
  const EnuFrame enu = EnuFrame::At(*dataset->rig.gnss.anchor_E);
  const TimeNs offset_ns = SecondsToNs(dataset->rig.gnss.time_offset_s);
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
  remarks->push_back(
      path + Format(": truth is the antenna at %zu fixed solutions, without attitude", truth.points.size()));
  dataset->truth = std::move(truth);
}

}  // namespace alidade
