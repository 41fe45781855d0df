#pragma once

// The sources of this folder are compiled for OpenVINS and, with ALIDADE_SQRT_VINS, for sqrtVINS: the same
// program with a square-root filter in single precision. What the two call differently stands here alone.

#include <cam/CamBase.h>
#include <core/VioManagerOptions.h>
#include <state/State.h>

namespace alidade::open_vins {

#ifdef ALIDADE_SQRT_VINS

namespace vio = ov_srvins;
using Real = DataType;
inline constexpr char kSystem[] = "sqrtVINS";
inline constexpr char kProgram[] = "alidade_sqrt_vins";

inline ov_type::IMU& ImuOf(const vio::State& state) {
  return *state.imu;
}
inline double TimestampOf(const vio::State& state) {
  return state.timestamp;
}
inline double TimeOffsetOf(const vio::State& state) {
  return static_cast<double>(state.calib_dt_CAMtoIMU->value()(0));
}
inline const auto& CamerasOf(const vio::State& state) {
  return state.cam_intrinsics_cameras;
}
/// The pixel on the normalised plane.
inline cv::Point2f Undistorted(ov_core::CamBase& camera, const cv::Point2f& pixel) {
  return camera.undistort(pixel);
}
/// Deviation and gate again, with the powers of the deviation that the settings keep.
inline void SetPowers(vio::UpdaterOptions* updater) {
  *updater = vio::UpdaterOptions(updater->chi2_multipler, updater->sigma_pix);
}

#else

namespace vio = ov_msckf;
using Real = double;
inline constexpr char kSystem[] = "OpenVINS";
inline constexpr char kProgram[] = "alidade_open_vins";

inline ov_type::IMU& ImuOf(const vio::State& state) {
  return *state._imu;
}
inline double TimestampOf(const vio::State& state) {
  return state._timestamp;
}
inline double TimeOffsetOf(const vio::State& state) {
  return state._calib_dt_CAMtoIMU->value()(0);
}
inline const auto& CamerasOf(const vio::State& state) {
  return state._cam_intrinsics_cameras;
}
inline cv::Point2f Undistorted(ov_core::CamBase& camera, const cv::Point2f& pixel) {
  return camera.undistort_cv(pixel);
}
inline void SetPowers(vio::UpdaterOptions* updater) {
  updater->sigma_pix_sq = updater->sigma_pix * updater->sigma_pix;
}

#endif

}  // namespace alidade::open_vins
