#include "eval/simulation/sim_receiver.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/numbers.h"
#include "core/random.h"
#include "gnss/base/constants.h"
#include "gnss/model/atmosphere.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

double Round(double value) {
  return std::round(value * 1e3) / 1e3;
}

/// Signals of a system: the first always, the second with second_band.
std::pair<SignalCode, SignalCode> SignalsOf(GnssSystem system) {
  switch (system) {
    case GnssSystem::kGalileo:
      return {{'1', 'C'}, {'5', 'Q'}};
    case GnssSystem::kBeidou:
      return {{'2', 'I'}, {'6', 'I'}};
    case GnssSystem::kGlonass:
      return {{'1', 'C'}, {'2', 'C'}};
    default:
      return {{'1', 'C'}, {'2', 'W'}};
  }
}

}  // namespace

SimReceiver::SimReceiver(const SimGnssConfig& config, const ContinuousTrajectory& trajectory, TimeNs start_ns,
                         const SimPull& pull, std::uint64_t seed,
                         std::shared_ptr<const SatelliteCatalog> catalog)
    : config_(config),
      pull_(pull),
      trajectory_(trajectory),
      start_gpst_ns_(start_ns - SecondsToNs(config.time_offset_s)),
      catalog_(std::move(catalog)),
      clock_(config, seed),
      enu_(EnuFrame::At(ToEcef({config.anchor_latitude_deg * kRadiansPerDegree,
                                config.anchor_longitude_deg * kRadiansPerDegree, config.anchor_height_m}))) {
  RandomStream biases(seed, "gnss.inter_system");
  for (const GnssSystem system : {GnssSystem::kGalileo, GnssSystem::kBeidou, GnssSystem::kGlonass}) {
    system_bias_m_[system] = config.inter_system_bias_m * biases.Normal();
  }
  ionosphere_scale_ = 1 + config.ionosphere_error * RandomStream(seed, "gnss.ionosphere").Normal();
  for (const auto& [id, list] : catalog_->navigation().kepler) {
    satellites_.push_back(id);
  }
  for (const auto& [number, list] : catalog_->navigation().glonass) {
    satellites_.push_back({GnssSystem::kGlonass, number});
    channels_[number] = list.front().channel;
  }
  std::erase_if(satellites_,
                [&](SatelliteId id) { return config.systems.find(Letter(id.system)) == std::string::npos; });
  for (const SatelliteId id : satellites_) {
    paths_.emplace(id, SimSignalPath(config_, seed, ToString(id)));
  }
}

std::vector<ObservationEpoch> SimReceiver::Run() {
  std::vector<ObservationEpoch> epochs;
  const double period_s = 1 / config_.rate_hz;
  const TimeNs first = (start_gpst_ns_ / kSecondNs + 1) * kSecondNs;
  const TimeNs end = start_gpst_ns_ + SecondsToNs(trajectory_.DurationSeconds());
  for (int k = 0;; ++k) {
    // Whole 100 ns, as the file has them.
    const TimeNs tag = first + SecondsToNs(k * period_s) / 100 * 100;
    if (tag > end - kSecondNs / 100) {
      return epochs;
    }
    if (k > 0) {
      clock_.Advance(period_s, SecondsBetween(start_gpst_ns_, tag));
      for (auto& [id, path] : paths_) {
        path.Advance(period_s);
      }
    }
    epochs.push_back(Observe(tag));
  }
}

Vector3d SimReceiver::AntennaAt(double time_s, const Vector3d& pull_W) const {
  const NavState nav = trajectory_.At(time_s).nav;
  return enu_.ToEcef(nav.p_WB + nav.R_WB * config_.lever_arm_m + pull_W);
}

std::optional<int> SimReceiver::Channel(SatelliteId id) const {
  return id.system == GnssSystem::kGlonass ? std::optional(channels_.at(id.number)) : std::nullopt;
}

std::optional<SimReceiver::Sight> SimReceiver::Look(SatelliteId id, SignalCode signal, TimeNs tag_ns,
                                                    double clock_m, const Vector3d& antenna_E) const {
  constexpr double kSurelyBelow = -5 * kRadiansPerDegree;
  Sight sight;
  double range = 7e7 * 0.33 + clock_m;
  double before = 0;
  const EnuFrame here = EnuFrame::At(antenna_E);
  for (int i = 0; i < 6 && range != before; ++i) {
    before = range;
    sight.fix = catalog_->AtTransmission(id, signal, tag_ns, range);
    if (sight.fix.fault != SatelliteFault::kNone) {
      return std::nullopt;
    }
    const SatelliteState& s = sight.fix.state;
    sight.direction = DirectionTo(here, s.position_E);
    if (sight.direction.elevation_rad < kSurelyBelow) {
      return std::nullopt;
    }
    double tau = 0.075;
    double distance = 0;
    for (int j = 0; j < 4; ++j) {
      const Vector3d turned = Eigen::AngleAxisd(-kEarthRotationRate * tau, Vector3d::UnitZ()) * s.position_E;
      distance = (turned - antenna_E).norm();
      tau = distance / kSpeedOfLight;
    }
    range = distance + clock_m - s.clock_m;
  }
  const GeodeticPosition place = ToGeodetic(antenna_E);
  if (sight.direction.elevation_rad < 0) {
    return std::nullopt;
  }
  const double frequency = CarrierFrequencyHz(id.system, signal.band, Channel(id)).value_or(1575.42e6);
  constexpr double kL1Hz = 1575.42e6;
  const NavigationData& navigation = catalog_->navigation();
  if (config_.ionosphere && navigation.gps_ionosphere) {
    range += ionosphere_scale_ * kL1Hz * kL1Hz / (frequency * frequency) *
             KlobucharDelayL1(*navigation.gps_ionosphere, place, sight.direction, tag_ns);
  }
  range += config_.troposphere ? TroposphereDelay(place, sight.direction.elevation_rad, tag_ns) : 0;
  const auto bias = system_bias_m_.find(id.system);
  range += GroupDelayOf(sight.fix, id, signal).delay_m + (bias == system_bias_m_.end() ? 0 : bias->second);
  sight.range_m = range;
  return sight;
}

ObservationEpoch SimReceiver::Observe(TimeNs tag_ns) {
  ObservationEpoch epoch;
  epoch.stamp_ns = tag_ns;
  const double clock_s = clock_.bias_m() / kSpeedOfLight;
  const double time_s = SecondsBetween(start_gpst_ns_, tag_ns) - clock_s;
  std::vector<std::pair<double, SatelliteId>> seen;
  std::map<SatelliteId, SatelliteObservation> observations;
  for (const SatelliteId id : satellites_) {
    SatelliteObservation observed{id, {}};
    double elevation = 0;
    const auto [first, second] = SignalsOf(id.system);
    for (const SignalCode signal : {first, second}) {
      if (signal == second && !config_.second_band) {
        continue;
      }
      if (const auto measured = Measure(id, signal, tag_ns, time_s, &elevation)) {
        observed.signals.push_back(*measured);
      }
    }
    if (!observed.signals.empty()) {
      seen.emplace_back(-elevation, id);
      observations.emplace(id, std::move(observed));
    }
  }
  std::sort(seen.begin(), seen.end());
  const double into_outage_s = time_s - config_.outage_start_s;
  if (config_.outage_start_s >= 0 && into_outage_s >= 0 && into_outage_s < config_.outage_s) {
    seen.resize(std::min(seen.size(), static_cast<std::size_t>(config_.outage_satellites)));
  }
  std::set<SatelliteId> kept;
  for (const auto& [height, id] : seen) {
    kept.insert(id);
  }
  for (auto& [id, observed] : observations) {
    if (kept.contains(id)) {
      epoch.satellites.push_back(std::move(observed));
    }
  }
  return epoch;
}

std::optional<SignalObservation> SimReceiver::Measure(SatelliteId id, SignalCode signal, TimeNs tag_ns,
                                                      double time_s, double* elevation) {
  SimSignalPath& path = paths_.at(id);
  const double code_noise = path.Noise();
  const double rate_noise = path.Noise();
  const Vector3d pull_W = pull_.At(time_s);
  const std::optional<Sight> now = Look(id, signal, tag_ns, clock_.bias_m(), AntennaAt(time_s, pull_W));
  if (!now || now->direction.elevation_rad < config_.elevation_mask_deg * kRadiansPerDegree) {
    return std::nullopt;
  }
  *elevation = now->direction.elevation_rad;
  constexpr TimeNs kStepNs = 5'000'000;
  const double step_s = SecondsBetween(0, kStepNs);
  const double shift_m = clock_.drift_mps() * step_s;
  const auto look_after = [&](int steps) {
    const double then_s = time_s + steps * step_s;
    return Look(id, signal, tag_ns + steps * kStepNs, clock_.bias_m() + steps * shift_m,
                AntennaAt(then_s, pull_.moves_rates() ? pull_.At(then_s) : pull_W));
  };
  const auto late = look_after(1);
  const auto early = look_after(-1);
  if (!late || !early) {
    return std::nullopt;
  }
  const double rate = (late->range_m - early->range_m) / (2 * step_s);
  SignalObservation observation;
  observation.signal = signal;
  observation.cn0_dbhz = Round(38 + 12 * std::sin(*elevation));
  const auto deviation = [&](double zenith_std) {
    return std::sqrt(ObservationVariance(zenith_std, *elevation, *observation.cn0_dbhz, std::nullopt));
  };
  observation.pseudorange_m =
      Round(now->range_m + path.delay_m() + code_noise * deviation(config_.pseudorange_noise_m));
  const double frequency = CarrierFrequencyHz(id.system, signal.band, Channel(id)).value_or(1575.42e6);
  observation.doppler_hz =
      Round(-(rate + rate_noise * deviation(config_.range_rate_noise_mps)) * frequency / kSpeedOfLight);
  return observation;
}

}  // namespace alidade
