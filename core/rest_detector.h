#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/camera_model.h"
#include "core/imu_sample.h"
#include "core/init_config.h"
#include "core/navigation_state.h"
#include "core/robust.h"
#include "core/track_frame.h"
#include "core/vision_config.h"

namespace alidade {

/// What a RestDetector found.
struct RestVerdict {
  bool no_translation = false;  ///< the camera's velocity is zero
  bool no_rotation = false;     ///< gyro mean = bias may be used; implies no_translation
  /// The largest part of the flow that was taken for none, in standard deviations of what the tracks' noise
  /// makes of it. At rest nine in ten are below 2.5; more indicates slow motion.
  double flow_deviations = 0;
  /// Speed of the camera over depth of the scenery up to which the flow is explained: the flow plus one
  /// deviation of the tracks' noise, as the share of one frame of a window that many frames measure [1/s].
  /// The longer the rest lasts, the less.
  double speed_per_depth = 0;
};

/// Measured angular rates, bias included; rad/s, in B.
struct RestRates {
  Eigen::Vector3d mean_radps = Eigen::Vector3d::Zero();    ///< over the window
  Eigen::Vector3d at_end_radps = Eigen::Vector3d::Zero();  ///< at its last frame
};

/// Detects rest from tracks and IMU. At rest tracks have no parallax and are rejected by the parallax gate,
/// so an estimator would drift with its accelerometer. Tracks alone cannot separate translation from
/// rotation, an IMU alone cannot separate rest from constant velocity.
///
/// No translation: the image flow since the oldest frame of the window and since its middle one, freed of the
/// rig's turn by the gyroscope, fitted by shift, zoom and roll over the common tracks, stays below
/// VisionConfig::rest_max_flow_px at the image's corner, and the specific force spreads less than
/// rest_max_accel_std_mps2. No rotation: so does the uncompensated flow, and the angular rate spreads less
/// than InitConfig allows. While the bias is not known well enough to decide whether the rig turns (the mean
/// rate is within three of its deviations), with a calm gyroscope the uncompensated flow decides both.
///
/// Far scenery hides a motion that the IMU has measured. While the estimated velocity of the camera
/// contradicts rest, the flow must have been below the limit for four windows.
///
/// A motion so slow, or scenery so far, that tracks move by less than the limit in that time is taken for
/// rest; MakeRestMeasurement allows for it. Neglected: a turn that hides a translation.
class RestDetector {
 public:
  RestDetector(const VisionConfig& vision, const InitConfig& init, const CameraModel& camera);

  /// Inertial samples since the previous frame (ends included).
  void AddImu(std::span<const ImuSample> samples);
  /// Verdict on the window that ends with this frame, at whose IMU time the samples end. The gyroscope and
  /// not the estimate gives the turn: at rest corrections of the estimated attitude would look like motion.
  /// pixel_noise_px: of the tracks. estimate: a recent one; its gyroscope bias and its velocity are used,
  /// with their covariance.
  RestVerdict AddFrame(const TrackFrame& frame, double pixel_noise_px, const NavEstimate& estimate,
                       const Pose& T_BC);
  void Clear();
  /// Whether the estimated velocity of the camera, at the last inertial sample, is larger than its error is
  /// expected to be.
  [[nodiscard]] bool TellsMotion(const NavEstimate& estimate, const Eigen::Vector3d& p_BC) const;

  /// Over the present window.
  [[nodiscard]] RestRates Rates() const;

 private:
  struct OrientedFrame {
    TrackFrame frame;
    Eigen::Matrix3d R_0B;  ///< attitude against that of the first sample
  };
  /// The frames since which the flow is asked for; those that are not are null.
  struct StillSince {
    const OrientedFrame* before;
    const OrientedFrame* middle;
    const OrientedFrame* doubted;
    const OrientedFrame* anchor;  ///< need not be still
  };
  struct CommonTrack {
    Eigen::Vector2d before;
    Eigen::Vector2d flow;
  };
  /// Adds the frame and forgets what is older than is asked for.
  void Keep(const TrackFrame& frame);
  /// The newest frame that is at least this much older than the newest one; null when none is.
  [[nodiscard]] const OrientedFrame* FrameBefore(double seconds) const;
  /// Squared deviations of the camera's velocity from zero, `least_mps` added to its own in each axis.
  [[nodiscard]] double NormalizedSpeedSquared(const NavEstimate& estimate, const Eigen::Vector3d& p_BC,
                                              double least_mps) const;
  /// Whether the camera moves according to the estimate, beyond doubt.
  [[nodiscard]] bool ContradictsRest(const NavEstimate& estimate, const Eigen::Vector3d& p_BC) const;
  /// Whether the estimate has contradicted rest from the frame `since`, if there is one, to the one at hand.
  [[nodiscard]] bool DoubtHasLasted(TimeNs stamp_ns, const OrientedFrame* since);
  /// Carries R_0B_ on to the last sample.
  void Turn(const Eigen::Vector3d& gyro_bias_radps);
  /// Whether the flow since these frames is zero. R_BC: attitude of the camera in B; null: the rig's turn
  /// stays in the flow.
  [[nodiscard]] bool StoodStill(const TrackFrame& frame, const StillSince& since, const Eigen::Matrix3d* R_BC,
                                double pixel_noise_px, RestVerdict* flow);
  /// R_now_before: turn of the camera between the frames; identity compensates nothing. What the verdict says
  /// of the flow becomes that of all pairs of frames so far.
  [[nodiscard]] bool FlowIsZero(const TrackFrame& before, const TrackFrame& now,
                                const Eigen::Matrix3d& R_now_before, double pixel_noise_px,
                                RestVerdict* verdict);
  /// Fills common_.
  void FindCommon(const TrackFrame& before, const TrackFrame& now, const Eigen::Matrix3d& R_now_before);

  VisionConfig vision_;
  InitConfig init_;
  ChiSquareGate doubt_;
  CameraModel camera_;
  Eigen::Vector2d image_center_;
  double image_radius_px_;
  std::vector<OrientedFrame> frames_;  ///< the first frame_count_, oldest first; the rest is spare memory
  size_t frame_count_ = 0;
  std::vector<ImuSample> imu_;
  OrientedFrame anchor_;  ///< the first frame of the rest that lasts, unless tracks or flow since then ended
  bool anchored_ = false;
  Eigen::Matrix3d R_0B_ = Eigen::Matrix3d::Identity();
  TimeNs turned_ns_ = INT64_MIN;         ///< stamp of the sample up to which R_0B_ was carried
  TimeNs doubted_since_ns_ = INT64_MAX;  ///< stamp of the first frame of those that the estimate contradicts
  std::vector<CommonTrack> common_;
};

}  // namespace alidade
