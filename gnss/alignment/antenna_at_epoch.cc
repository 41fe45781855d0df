#include "gnss/alignment/antenna_at_epoch.h"

namespace alidade {

AntennaAtEpoch PredictAntenna(const AntennaMount& mount, const Preintegration* interval,
                              const Eigen::Vector3d& gravity_W, const NavState& nav, const ImuBias& bias,
                              const Eigen::Vector3d& gyro_radps) {
  AntennaAtEpoch at;
  const NavState carried = interval != nullptr ? CarryState(*interval, nav, bias, gravity_W, &at.chain) : nav;
  at.position_E = mount.Position(carried, &at.position_jacobian);
  at.velocity_E = mount.Velocity(carried, bias, gyro_radps, &at.velocity_jacobian);
  return at;
}

}  // namespace alidade
