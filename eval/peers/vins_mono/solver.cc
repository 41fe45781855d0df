#include "eval/peers/vins_mono/solver.h"

#include <estimator.h>

#include "eval/peers/vins/unhurried_solve.h"

namespace alidade::vins_mono {
namespace {

Estimator estimator;

}  // namespace

Solver::Solver(const RigCalibration& rig, const VinsSettings& settings) {
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
  ROLLING_SHUTTER = 0;
  TR = 0;
  TD = rig.camera_time_offset_s;
  RIC = {rig.T_BC.rotation};
  TIC = {rig.T_BC.translation};
  estimator.clearState();
  estimator.setParameter();
}

void Solver::AddImu(double step_s, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel) {
  estimator.processIMU(step_s, accel, gyro);
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
  estimator.processImage(image, header);
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

}  // namespace alidade::vins_mono
