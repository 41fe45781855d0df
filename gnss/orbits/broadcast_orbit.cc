#include "gnss/orbits/broadcast_orbit.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/check.h"
#include "core/lie.h"
#include "gnss/base/constants.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

/// Gravity and rotation constants that each system's message is fitted with.
struct EarthModel {
  double mu;     ///< [m^3/s^2]
  double omega;  ///< [rad/s]
};

EarthModel ModelOf(GnssSystem system) {
  switch (system) {
    case GnssSystem::kGalileo:
      return {3.986004418e14, 7.2921151467e-5};
    case GnssSystem::kBeidou:
      return {3.986004418e14, 7.2921150e-5};
    default:
      return {3.986005e14, 7.2921151467e-5};
  }
}

double SolveKepler(double mean_anomaly, double eccentricity) {
  double anomaly = mean_anomaly;
  for (int i = 0; i < 30; ++i) {
    const double step =
        (anomaly - eccentricity * std::sin(anomaly) - mean_anomaly) / (1 - eccentricity * std::cos(anomaly));
    anomaly -= step;
    if (std::abs(step) < 1e-14) {
      break;
    }
  }
  return anomaly;
}

/// A vector in the orbital plane, x towards the ascending node, and its rate.
struct PlaneState {
  double x, y, dx, dy;
  double inclination, inclination_rate;
};

PlaneState InPlane(const KeplerEphemeris& e, double tk, double anomaly, double anomaly_rate) {
  const double a = e.sqrt_a * e.sqrt_a;
  const double cos_e = std::cos(anomaly);
  const double sin_e = std::sin(anomaly);
  const double minor = std::sqrt(1 - e.eccentricity * e.eccentricity);
  const double phi = std::atan2(minor * sin_e, cos_e - e.eccentricity) + e.omega;
  const double phi_rate = minor * anomaly_rate / (1 - e.eccentricity * cos_e);
  const double c = std::cos(2 * phi);
  const double s = std::sin(2 * phi);
  const double u = phi + e.cus * s + e.cuc * c;
  const double r = a * (1 - e.eccentricity * cos_e) + e.crs * s + e.crc * c;
  const double u_rate = phi_rate * (1 + 2 * (e.cus * c - e.cuc * s));
  const double r_rate = a * e.eccentricity * sin_e * anomaly_rate + 2 * phi_rate * (e.crs * c - e.crc * s);
  PlaneState state{};
  state.x = r * std::cos(u);
  state.y = r * std::sin(u);
  state.dx = r_rate * std::cos(u) - state.y * u_rate;
  state.dy = r_rate * std::sin(u) + state.x * u_rate;
  state.inclination = e.i0 + e.i_dot * tk + e.cis * s + e.cic * c;
  state.inclination_rate = e.i_dot + 2 * phi_rate * (e.cis * c - e.cic * s);
  return state;
}

/// Rotates the orbital plane by node and inclination into the axes the node refers to.
void OutOfPlane(const PlaneState& p, double node, double node_rate, SatelliteState* state) {
  const double ci = std::cos(p.inclination);
  const double si = std::sin(p.inclination);
  const double cn = std::cos(node);
  const double sn = std::sin(node);
  const double yc = p.y * ci;  // along the equator, 90 deg before the node
  const double z = p.y * si;
  const double yc_rate = p.dy * ci - z * p.inclination_rate;
  state->position_E = {p.x * cn - yc * sn, p.x * sn + yc * cn, z};
  state->velocity_E = {p.dx * cn - yc_rate * sn - state->position_E.y() * node_rate,
                       p.dx * sn + yc_rate * cn + state->position_E.x() * node_rate,
                       p.dy * si + yc * p.inclination_rate};
}

/// BeiDou GEO: the elements stand in axes that do not turn, tilted by 5 deg (BDS-SIS-ICD-B1I 5.2.4.12).
void RotateGeo(double omega, double tk, SatelliteState* state) {
  // The ICD's R_Z(angle) R_X(-5 deg) turn axes: as rotations of vectors the signs change.
  const Eigen::AngleAxisd tilt(5.0 * M_PI / 180, Vector3d::UnitX());
  const Eigen::AngleAxisd turn(-omega * tk, Vector3d::UnitZ());
  const Eigen::Matrix3d rotation = (turn * tilt).toRotationMatrix();
  const Vector3d position = rotation * state->position_E;
  state->velocity_E = rotation * state->velocity_E - Vector3d(0, 0, omega).cross(position);
  state->position_E = position;
}

using GlonassState = Eigen::Matrix<double, 6, 1>;

GlonassState GlonassRate(const GlonassState& s, const Vector3d& acceleration) {
  constexpr double kMu = 3.986004418e14;
  constexpr double kRadius = 6378136.0;
  constexpr double kJ2 = 1.08262575e-3;
  constexpr double kOmega = 7.292115e-5;
  const Vector3d p = s.head<3>();
  const double r2 = p.squaredNorm();
  const double r3 = r2 * std::sqrt(r2);
  const double flattening = 1.5 * kJ2 * kMu * kRadius * kRadius / (r2 * r3);
  const double lift = 5 * p.z() * p.z() / r2;
  GlonassState rate;
  rate.head<3>() = s.tail<3>();
  rate[3] =
      (-kMu / r3 - flattening * (1 - lift) + kOmega * kOmega) * p.x() + 2 * kOmega * s[4] + acceleration.x();
  rate[4] =
      (-kMu / r3 - flattening * (1 - lift) + kOmega * kOmega) * p.y() - 2 * kOmega * s[3] + acceleration.y();
  rate[5] = (-kMu / r3 - flattening * (3 - lift)) * p.z() + acceleration.z();
  return rate;
}

}  // namespace

SatelliteState PropagateKepler(const KeplerEphemeris& e, TimeNs stamp_ns) {
  const EarthModel earth = ModelOf(e.satellite.system);
  const double tk = SecondsBetween(e.toe_ns, stamp_ns);
  const double a = e.sqrt_a * e.sqrt_a;
  const double rate = std::sqrt(earth.mu / (a * a * a)) + e.delta_n;
  const double anomaly = SolveKepler(e.m0 + rate * tk, e.eccentricity);
  const double anomaly_rate = rate / (1 - e.eccentricity * std::cos(anomaly));

  SatelliteState state;
  const bool geo = e.message == NavMessage::kD2;
  const double node_rate = e.omega_dot - (geo ? 0 : earth.omega);
  const double node = e.omega0 + node_rate * tk - earth.omega * e.toe_of_week_s;
  OutOfPlane(InPlane(e, tk, anomaly, anomaly_rate), node, node_rate, &state);
  if (geo) {
    RotateGeo(earth.omega, tk, &state);
  }

  const double tc = SecondsBetween(e.toc_ns, stamp_ns);
  const double relativity = -2 * std::sqrt(earth.mu) / kSpeedOfLight * e.eccentricity * e.sqrt_a;  // [m]
  state.clock_m = kSpeedOfLight * (e.af0 + (e.af1 + e.af2 * tc) * tc) + relativity * std::sin(anomaly);
  state.drift_mps = kSpeedOfLight * (e.af1 + 2 * e.af2 * tc) + relativity * std::cos(anomaly) * anomaly_rate;
  return state;
}

SatelliteState PropagateGlonass(const GlonassEphemeris& e, TimeNs stamp_ns) {
  const double tk = SecondsBetween(e.toe_ns, stamp_ns);
  CHECK_LE(std::abs(tk), 3600.0);
  const int steps = static_cast<int>(std::ceil(std::abs(tk) / 60));
  const double h = steps == 0 ? 0 : tk / steps;
  GlonassState s;
  s << e.position_m, e.velocity_mps;
  for (int i = 0; i < steps; ++i) {
    const GlonassState k1 = GlonassRate(s, e.acceleration_mps2);
    const GlonassState k2 = GlonassRate(s + 0.5 * h * k1, e.acceleration_mps2);
    const GlonassState k3 = GlonassRate(s + 0.5 * h * k2, e.acceleration_mps2);
    const GlonassState k4 = GlonassRate(s + h * k3, e.acceleration_mps2);
    s += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return {s.head<3>(), s.tail<3>(), kSpeedOfLight * (e.clock_bias_s + e.clock_drift * tk),
          kSpeedOfLight * e.clock_drift};
}

}  // namespace alidade
