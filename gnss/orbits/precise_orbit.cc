#include "gnss/orbits/precise_orbit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "gnss/base/constants.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kNodes = 11;
constexpr TimeNs kMaxClockGapNs = 600 * kSecondNs;
constexpr TimeNs kMaxCoarseClockGapNs = 1800 * kSecondNs;

template <typename Node>
std::size_t FirstAfter(const std::vector<Node>& nodes, TimeNs stamp_ns) {
  const auto after = std::upper_bound(nodes.begin(), nodes.end(), stamp_ns,
                                      [](TimeNs stamp, const Node& node) { return stamp < node.stamp_ns; });
  return static_cast<std::size_t>(after - nodes.begin());
}

/// Value and derivative at 0 of the polynomial through (t_i, p_i): Neville's scheme, differentiated.
void Neville(const std::array<double, kNodes>& t, std::array<Vector3d, kNodes> p, Vector3d* value,
             Vector3d* rate) {
  std::array<Vector3d, kNodes> d;
  d.fill(Vector3d::Zero());
  for (std::size_t span = 1; span < kNodes; ++span) {
    for (std::size_t i = 0; i + span < kNodes; ++i) {
      const double width = t[i] - t[i + span];
      // P = ((x - t_j) P_i - (x - t_i) P_j) / (t_i - t_j) at x = 0, and dP/dx.
      const Vector3d derivative = (-t[i + span] * d[i] + t[i] * d[i + 1] + p[i] - p[i + 1]) / width;
      p[i] = (-t[i + span] * p[i] + t[i] * p[i + 1]) / width;
      d[i] = derivative;
    }
  }
  *value = p[0];
  *rate = d[0];
}

bool InterpolateOrbit(const std::vector<OrbitNode>& nodes, TimeNs stamp_ns, SatelliteState* state) {
  if (nodes.size() < kNodes || stamp_ns < nodes.front().stamp_ns || stamp_ns > nodes.back().stamp_ns) {
    return false;
  }
  const std::size_t after = FirstAfter(nodes, stamp_ns);
  const std::size_t wanted = after < (kNodes + 1) / 2 ? 0 : after - (kNodes + 1) / 2;
  const std::size_t first = std::min(wanted, nodes.size() - kNodes);
  std::array<double, kNodes> t{};
  std::array<Vector3d, kNodes> p;
  TimeNs shortest = kDayNs;
  TimeNs longest = 0;
  for (std::size_t i = 0; i < kNodes; ++i) {
    const OrbitNode& node = nodes[first + i];
    if (i > 0) {
      const TimeNs step = node.stamp_ns - nodes[first + i - 1].stamp_ns;
      shortest = std::min(shortest, step);
      longest = std::max(longest, step);
    }
    t[i] = SecondsBetween(stamp_ns, node.stamp_ns);
    p[i] = Eigen::AngleAxisd(kEarthRotationRate * t[i], Vector3d::UnitZ()) * node.position_m;
  }
  if (2 * longest > 3 * shortest) {
    return false;  // a gap
  }
  Vector3d still;
  Neville(t, p, &state->position_E, &still);
  state->velocity_E = still - Vector3d(0, 0, kEarthRotationRate).cross(state->position_E);
  return true;
}

bool InterpolateClock(const std::map<SatelliteId, std::vector<ClockNode>>& clocks, SatelliteId satellite,
                      TimeNs stamp_ns, TimeNs max_gap_ns, SatelliteState* state) {
  const auto found = clocks.find(satellite);
  if (found == clocks.end()) {
    return false;
  }
  const std::vector<ClockNode>& nodes = found->second;
  const std::size_t after = FirstAfter(nodes, stamp_ns);
  if (after == 0 || after == nodes.size()) {
    return false;
  }
  const ClockNode& before = nodes[after - 1];
  const TimeNs gap = nodes[after].stamp_ns - before.stamp_ns;
  if (gap > max_gap_ns) {
    return false;
  }
  const double rate = (nodes[after].bias_s - before.bias_s) / (static_cast<double>(gap) * kNsToSeconds);
  state->clock_m = kSpeedOfLight * (before.bias_s + rate * SecondsBetween(before.stamp_ns, stamp_ns));
  state->drift_mps = kSpeedOfLight * rate;
  return true;
}

}  // namespace

std::optional<SatelliteState> InterpolatePrecise(const PreciseProducts& products, SatelliteId satellite,
                                                 TimeNs stamp_ns) {
  const auto orbit = products.orbits.find(satellite);
  SatelliteState state;
  if (orbit == products.orbits.end() || !InterpolateOrbit(orbit->second, stamp_ns, &state) ||
      (!InterpolateClock(products.clocks, satellite, stamp_ns, kMaxClockGapNs, &state) &&
       !InterpolateClock(products.coarse_clocks, satellite, stamp_ns, kMaxCoarseClockGapNs, &state))) {
    return std::nullopt;
  }
  // IS-GPS-200 20.3.3.3.3.1: v is relative to axes that stand still, but r.(omega x r) = 0.
  const Vector3d& r = state.position_E;
  const Vector3d still = state.velocity_E + Vector3d(0, 0, kEarthRotationRate).cross(r);
  state.clock_m -= 2 * r.dot(still) / kSpeedOfLight;
  // d(r.v)/dt = v^2 - mu / r for a Kepler orbit.
  constexpr double kMu = 3.986004418e14;
  state.drift_mps -= 2 * (still.squaredNorm() - kMu / r.norm()) / kSpeedOfLight;
  return state;
}

}  // namespace alidade
