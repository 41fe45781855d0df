#include "eval/peers/gvins/solver.h"

#include <estimator.h>

#include "eval/peers/vins/unhurried_solve.h"

namespace alidade::gvins {
namespace {

Estimator estimator;

void SetGnss(const GnssSettings& settings) {
  GNSS_ENABLE = settings.enabled;
  GNSS_ELEVATION_THRES = settings.elevation_deg;
  GNSS_PSR_STD_THRES = settings.max_pseudorange_std_m;
  GNSS_DOPP_STD_THRES = settings.max_doppler_std_hz;
  GNSS_TRACK_NUM_THRES = static_cast<uint32_t>(settings.min_tracked_epochs);
  GNSS_DDT_WEIGHT = 1 / settings.drift_step_mps;
  GNSS_LOCAL_ONLINE_SYNC = false;
  // Its published ones are of another day: without a broadcast there is no ionosphere.
  GNSS_IONO_DEFAULT_PARAMS.assign(8, 0.0);
}

}  // namespace

Solver::Solver(const RigCalibration& rig, const VinsSettings& settings, const GnssSettings& gnss_settings,
               const PeerGnss& gnss)
    : gnss_(gnss), uses_gnss_(gnss_settings.enabled) {
  constexpr double kUnknownDepth = 5, kBiasThreshold = 0.1, kSolveLimitS = 0.04;
  INIT_DEPTH = kUnknownDepth;
  BIAS_ACC_THRESHOLD = BIAS_GYR_THRESHOLD = kBiasThreshold;
  MIN_PARALLAX = settings.keyframe_parallax_px / FOCAL_LENGTH;
  NUM_ITERATIONS = settings.max_iterations;
  SOLVER_TIME = kSolveLimitS;
  vins::SetRealTime(settings.real_time);
  ACC_N = settings.accel_noise;
  ACC_W = settings.accel_walk;
  GYR_N = settings.gyro_noise;
  GYR_W = settings.gyro_walk;
  G = Eigen::Vector3d(0, 0, settings.gravity_mps2);
  ROW = rig.camera.height_px();
  COL = rig.camera.width_px();
  ESTIMATE_EXTRINSIC = settings.calibrate_extrinsics ? 1 : 0;
  ESTIMATE_TD = settings.calibrate_time_offset ? 1 : 0;
  TD = rig.camera_time_offset_s;
  RIC = {rig.T_BC.rotation};
  TIC = {rig.T_BC.translation};
  SetGnss(gnss_settings);
  estimator.clearState();
  estimator.setParameter();
  DeliverNavigation();
}

void Solver::DeliverNavigation() {
  if (!uses_gnss_) {
    return;
  }
  for (const auto& message : gnss_.ephemerides) {
    estimator.inputEphem(gnss_comm::msg2ephem(message));
  }
  for (const auto& message : gnss_.glonass) {
    estimator.inputEphem(gnss_comm::msg2glo_ephem(message));
  }
  for (const auto& message : gnss_.ionosphere) {
    estimator.inputIonoParams(0, message->data);
  }
  estimator.inputGNSSTimeDiff(gpst_less_local_s_);
}

double Solver::GpstOf(const PeerGnss::Epoch& epoch) {
  const gnss_comm::GnssTimeMsg& time = epoch.message->meas.front().time;
  return gnss_comm::time2sec(gnss_comm::gpst2time(time.week, time.tow));
}

void Solver::SetClock(double gpst_s, double local_s) {
  gpst_less_local_s_ = gpst_s - local_s;
  estimator.inputGNSSTimeDiff(gpst_less_local_s_);
}

void Solver::AddImu(double step_s, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel) {
  estimator.processIMU(step_s, accel, gyro);
}

void Solver::AddEpoch(const PeerGnss::Epoch& epoch) {
  estimator.processGNSS(gnss_comm::msg2meas(epoch.message));
}

void Solver::AddImage(const std::vector<VinsFeature>& features, double time_s) {
  std::map<int, std::vector<std::pair<int, Eigen::Matrix<double, 7, 1>>>> image;
  for (const VinsFeature& feature : features) {
    Eigen::Matrix<double, 7, 1> row;
    row << feature.plane, 1, feature.pixel, feature.velocity;
    image[feature.id].emplace_back(0, row);
  }
  std_msgs::Header header;
  header.stamp = ros::Time(time_s);
  const bool was_running = running();
  estimator.processImage(image, header);
  if (was_running && !running()) {
    // Starting anew it forgets what receivers repeat every 30 s.
    DeliverNavigation();
  }
}

bool Solver::running() const {
  return estimator.solver_flag == Estimator::NON_LINEAR;
}

double Solver::time_offset_s() const {
  return estimator.td;
}

TrajectoryPoint Solver::Newest() const {
  TrajectoryPoint point;
  point.nav.R_WB = estimator.Rs[WINDOW_SIZE];
  point.nav.p_WB = estimator.Ps[WINDOW_SIZE];
  point.nav.v_WB = estimator.Vs[WINDOW_SIZE];
  point.bias.gyro = estimator.Bgs[WINDOW_SIZE];
  point.bias.accel = estimator.Bas[WINDOW_SIZE];
  return point;
}

std::optional<Pose> Solver::T_EW() const {
  if (!uses_gnss_ || !estimator.gnss_ready) {
    return std::nullopt;
  }
  const Eigen::Matrix3d R_NW =
      Eigen::AngleAxisd(estimator.yaw_enu_local, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return Pose{estimator.R_ecef_enu * R_NW, estimator.anc_ecef};
}

}  // namespace alidade::gvins
