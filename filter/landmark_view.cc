#include "filter/landmark_view.h"

#include "core/landmark_reduction.h"
#include "core/predicted_observation.h"

namespace alidade {

bool LinearizeView(const FilterState& state, const Clone& clone, const NormalizedObservation& observation,
                   const Eigen::Vector3d& p_W, const Eigen::Vector3d& jacobian_p_W, LandmarkViewRows* rows) {
  ObservationRows view;
  if (!LinearizeObservation(clone.T_WC, observation, p_W, &view)) {
    return false;
  }
  rows->residual = view.residual;
  if (state.first_estimates() &&
      !LinearizeObservation(clone.T_WC_jacobian, observation, jacobian_p_W, &view)) {
    return false;
  }
  rows->clone.noalias() = view.pose_jacobian * clone.camera_from_error;
  rows->landmark = view.point_jacobian;
  rows->calibration.resize(2, state.layout().size());
  if (state.layout().size() > 0) {
    state.FillCalibrationRows(clone, view.pose_jacobian, Predicted(observation, rows->residual),
                              rows->calibration);
  }
  return true;
}

}  // namespace alidade
