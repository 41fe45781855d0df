#include "filter/landmark_view.h"

#include <optional>

#include "core/landmark_reduction.h"
#include "core/predicted_observation.h"

namespace alidade {

bool LinearizeView(const FilterState& state, const Clone& clone, const NormalizedObservation& observation,
                   const Eigen::Vector3d& p_W, const Eigen::Vector3d& jacobian_p_W, LandmarkViewRows* rows) {
  std::optional<ExposedCamera> exposed;
  if (state.has_rolling_shutter()) {
    exposed = state.CameraAt(clone, observation);
  }
  ObservationRows view;
  if (!LinearizeObservation(exposed ? exposed->T_WC : clone.T_WC, observation, p_W, &view)) {
    return false;
  }
  rows->residual = view.residual;
  if (state.first_estimates() && !LinearizeObservation(exposed ? exposed->T_WC_jacobian : clone.T_WC_jacobian,
                                                       observation, jacobian_p_W, &view)) {
    return false;
  }
  rows->clone.noalias() =
      view.pose_jacobian * (exposed ? exposed->camera_from_error : clone.camera_from_error);
  rows->landmark = view.point_jacobian;
  rows->calibration.resize(2, state.layout().size());
  state.FillCalibrationRows(clone, exposed ? &*exposed : nullptr, view.pose_jacobian,
                            Predicted(observation, rows->residual), rows->calibration);
  return true;
}

}  // namespace alidade
