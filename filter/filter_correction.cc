#include "filter/filter_state.h"

// The correction of every state that FilterState holds.

namespace alidade {

using Eigen::Vector3d;

namespace {

Vector3d& Position(NavState& state) {
  return state.p_WB;
}

Vector3d& Position(Pose& pose) {
  return pose.translation;
}

/// Retract by an error about W's origin, as a turn about `centre`: what the first order neglects does not
/// grow with the distance from W's origin.
template <typename State, typename Error>
State RetractAbout(ErrorConvention convention, const Vector3d& centre, State state, Error xi) {
  Position(state) -= centre;
  xi.template segment<3>(3) += Vector3d(xi.template head<3>()).cross(centre);
  state = Retract(convention, state, xi);
  Position(state) += centre;
  return state;
}

}  // namespace

void FilterState::CorrectStrain(const Eigen::Ref<const Eigen::VectorXd>& correction) {
  if (!strain_.active()) {
    return;
  }
  for (size_t i = 0; i < clones_.size(); ++i) {
    const Pose& T_WB = clones_[i].T_WB;
    strain_.SetClone(i, T_WB.rotation,
                     ChartJacobian(convention_, T_WB) * correction.segment<6>(CloneOffset(i)));
  }
  const Vector9d newest = ChartJacobian(convention_, nav_) * correction.segment<9>(CoreOffset());
  strain_.Correct(newest.tail<3>(), correction.segment<6>(CoreOffset() + 9));
}

void FilterState::Correct(const Eigen::Ref<const Eigen::VectorXd>& correction) {
  CHECK_EQ(correction.size(), covariance_.dimension());
  CorrectStrain(correction);
  const int core = CoreOffset();
  const Vector3d about = TurnsAboutOrigin(convention_) ? centre() : Vector3d::Zero();
  nav_ = RetractAbout(convention_, about, nav_, Vector9d(correction.segment<9>(core)));
  nav_.R_WB = Eigen::Quaterniond(nav_.R_WB).normalized().toRotationMatrix();
  bias_.gyro += correction.segment<3>(core + 9);
  bias_.accel += correction.segment<3>(core + 12);
  if (given_.watched) {
    calibration_error_ += correction.segment(CalibrationOffset(), layout().size());
  } else {
    calibration_is_sound_ =
        Retract(layout(), correction.segment(CalibrationOffset(), layout().size()), &calibration_) &&
        calibration_is_sound_;
  }
  for (size_t i = 0; i < clones_.size(); ++i) {
    Clone& clone = clones_[i];
    clone.T_WB =
        RetractAbout(convention_, about, clone.T_WB, Vector6d(correction.segment<6>(CloneOffset(i))));
    clone.T_WB.rotation = Eigen::Quaterniond(clone.T_WB.rotation).normalized().toRotationMatrix();
    RefreshClone(&clone);
  }
  for (size_t i = 0; i < landmarks_.size(); ++i) {
    Landmark& landmark = landmarks_[i];
    if (landmark_error().anchored()) {
      const auto anchor = static_cast<size_t>(FindClone(landmark.anchor_serial));
      landmark.p_W =
          LandmarkError::Turned(correction.segment<3>(CloneOffset(anchor)), landmark.p_W, centre());
    }
    landmark.p_W += correction.segment<3>(LandmarkOffset(i));
  }
}

}  // namespace alidade
