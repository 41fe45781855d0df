#include "frontend/initialization/linear_start.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/dense_solvers.h"
#include "core/landmark_reduction.h"
#include "core/robust.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kRounds = 6;
constexpr int kMinConsistentTracks = 8;
constexpr double kFirstDepthM = 4.0;  // only its being equal for all matters
constexpr double kMinRayDepthM = 0.2;
constexpr double kMaxDepthM = 50.0;

/// Where the first body frame sees body frame k, as a function of (v, g): R_0k = motion.gamma, p_0k = v t + g
/// t^2 / 2 + motion.alpha.
struct FramePrediction {
  ImuMotion motion;

  [[nodiscard]] Eigen::Matrix<double, 3, 6> PositionJacobian() const {
    const double t_s = motion.duration_s;
    Eigen::Matrix<double, 3, 6> jacobian;
    jacobian << t_s * Matrix3d::Identity(), 0.5 * t_s * t_s * Matrix3d::Identity();
    return jacobian;
  }
};

std::vector<FramePrediction> ChainFrames(const std::vector<Preintegration>& preintegrations,
                                         const ImuBias& bias) {
  std::vector<FramePrediction> frames(1);
  for (const Preintegration& step : preintegrations) {
    frames.push_back({frames.back().motion * step.Corrected(bias)});
  }
  return frames;
}

/// One ray in the first body frame.
struct Ray {
  int frame;
  Vector3d direction;
  Eigen::Matrix<double, 3, 2> across;
  double sigma;  // angular [rad]
  double depth_m = kFirstDepthM;
  double weight = 1;  // robust
};

struct RayBundle {
  std::vector<Ray> rays;
};

std::vector<RayBundle> CollectBundles(const DynamicWindow& window, const std::vector<FramePrediction>& frames,
                                      const std::vector<bool>& inlier, const Matrix3d& R_BC) {
  std::vector<RayBundle> bundles;
  for (size_t t = 0; t < window.tracks.size(); ++t) {
    if (!inlier[t]) {
      continue;
    }
    RayBundle bundle;
    for (size_t k = 0; k < window.tracks[t].frames.size(); ++k) {
      const NormalizedObservation& observation = window.tracks[t].observations[k];
      Ray ray;
      ray.frame = window.tracks[t].frames[k];
      ray.direction = frames[static_cast<size_t>(ray.frame)].motion.gamma * R_BC * BearingOf(observation);
      ray.across.col(0) = ray.direction.unitOrthogonal();
      ray.across.col(1) = ray.direction.cross(ray.across.col(0));
      ray.sigma = AngularDeviation(observation);
      bundle.rays.push_back(ray);
    }
    bundles.push_back(std::move(bundle));
  }
  return bundles;
}

/// Normal equations over (v, g).
struct NormalEquations {
  Matrix6d matrix = Matrix6d::Zero();
  Vector6d right_side = Vector6d::Zero();
};

NormalEquations Assemble(const std::vector<RayBundle>& bundles, const std::vector<FramePrediction>& frames,
                         const Vector3d& p_BC) {
  NormalEquations equations;
  for (const RayBundle& bundle : bundles) {
    const Eigen::Index rows = 2 * static_cast<Eigen::Index>(bundle.rays.size());
    Eigen::Matrix<double, Eigen::Dynamic, 3> point(rows, 3);
    Eigen::MatrixXd jacobian(rows, 6);
    Eigen::VectorXd offset(rows);
    for (Eigen::Index k = 0; 2 * k < rows; ++k) {
      const Ray& ray = bundle.rays[static_cast<size_t>(k)];
      const FramePrediction& frame = frames[static_cast<size_t>(ray.frame)];
      const Eigen::Matrix<double, 2, 3> weighted =
          ray.across.transpose() * (std::sqrt(ray.weight) / (ray.sigma * ray.depth_m));
      point.middleRows<2>(2 * k) = weighted;
      jacobian.middleRows<2>(2 * k) = weighted * frame.PositionJacobian();
      offset.segment<2>(2 * k) = weighted * (frame.motion.alpha + frame.motion.gamma * p_BC);
    }
    EliminateLandmark(point, jacobian, offset);
    const Eigen::Index left = rows - 3;
    equations.matrix.noalias() += jacobian.bottomRows(left).transpose() * jacobian.bottomRows(left);
    equations.right_side.noalias() -= jacobian.bottomRows(left).transpose() * offset.tail(left);
  }
  return equations;
}

/// argmin g^T S g - 2 s^T g over |g| = magnitude: (S + lambda I) g = s with lambda > -least eigenvalue, where
/// |g| falls monotonically in lambda; bisection.
Vector3d MinimizeOnSphere(const Matrix3d& S, const Vector3d& s, double magnitude) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(S);
  const Vector3d& values = solver.eigenvalues();
  const Vector3d projected = solver.eigenvectors().transpose() * s;
  const auto solve = [&](double lambda) -> Vector3d { return projected.array() / (values.array() + lambda); };
  const double scale = values[2] + projected.norm() / magnitude;
  double low = -values[0] + 1e-12 * scale;
  double high = -values[0] + 2 * scale;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (solve(middle).norm() > magnitude ? low : high) = middle;
  }
  const Vector3d g = solver.eigenvectors() * solve(0.5 * (low + high));
  return g.normalized() * magnitude;
}

/// Solves for (v, g) under |g| = magnitude; false when singular. free_gravity: |g| of the unconstrained
/// solution.
bool Solve(const NormalEquations& equations, double magnitude, Vector6d* solution, double* free_gravity) {
  const SymmetricSolver velocity(equations.matrix.topLeftCorner<3, 3>());
  if (!(velocity.min_pivot() > 0)) {
    return false;
  }
  const Matrix3d cross = equations.matrix.topRightCorner<3, 3>();
  const Matrix3d coupling = velocity.Solve(cross);
  const Vector3d free_velocity = velocity.Solve(equations.right_side.head<3>());
  const Matrix3d S = equations.matrix.bottomRightCorner<3, 3>() - cross.transpose() * coupling;
  const Vector3d s = equations.right_side.tail<3>() - cross.transpose() * free_velocity;
  *free_gravity = SolveSymmetric(S, s).norm();
  const Vector3d g = MinimizeOnSphere(0.5 * (S + S.transpose()), s, magnitude);
  *solution << free_velocity - coupling * g, g;
  return solution->allFinite();
}

/// Depths and robust weights of every ray from the current solution.
void Reweigh(const std::vector<FramePrediction>& frames, const Vector6d& solution, const Vector3d& p_BC,
             std::vector<RayBundle>* bundles) {
  std::vector<Vector3d> cameras;
  cameras.reserve(frames.size());
  for (const FramePrediction& frame : frames) {
    cameras.emplace_back(frame.PositionJacobian() * solution + frame.motion.alpha +
                         frame.motion.gamma * p_BC);
  }
  for (RayBundle& bundle : *bundles) {
    Matrix3d normal = 1e-9 * Matrix3d::Identity();
    Vector3d right_side = Vector3d::Zero();
    for (const Ray& ray : bundle.rays) {
      const double weight = ray.weight / (ray.sigma * ray.sigma * ray.depth_m * ray.depth_m);
      const Matrix3d projector = weight * ray.across * ray.across.transpose();
      normal += projector;
      right_side += projector * cameras[static_cast<size_t>(ray.frame)];
    }
    const Vector3d landmark = SolveSymmetric(normal, right_side);
    for (Ray& ray : bundle.rays) {
      const Vector3d offset = landmark - cameras[static_cast<size_t>(ray.frame)];
      const double depth = offset.dot(ray.direction);
      ray.depth_m = std::clamp(depth, kMinRayDepthM, kMaxDepthM);
      const double residual = (ray.across.transpose() * offset).norm() / (ray.sigma * ray.depth_m);
      ray.weight = depth > 0 ? RobustWeight(RobustKernel::kCauchy, kCauchyScale, residual * residual) : 0.01;
    }
  }
}

/// Turns the first body frame into a world with z up and no yaw.
LinearStart ToWorld(const std::vector<FramePrediction>& frames, const Vector6d& solution,
                    const ImuBias& bias) {
  const Vector3d v = solution.head<3>();
  const Vector3d g = solution.tail<3>();
  const Matrix3d R_W0 = so3::Between(-g, Vector3d::UnitZ());
  LinearStart start;
  start.bias = bias;
  for (const FramePrediction& frame : frames) {
    NavState state;
    state.R_WB = R_W0 * frame.motion.gamma;
    state.p_WB = R_W0 * (frame.PositionJacobian() * solution + frame.motion.alpha);
    state.v_WB = R_W0 * (v + g * frame.motion.duration_s + frame.motion.beta);
    start.states.push_back(state);
  }
  return start;
}

}  // namespace

Result<LinearStart> SolveLinearStart(const DynamicWindow& window,
                                     const std::vector<Preintegration>& preintegrations, const ImuBias& bias,
                                     const std::vector<bool>& inlier, const Pose& T_BC, double gravity_mps2) {
  const std::vector<FramePrediction> frames = ChainFrames(preintegrations, bias);
  std::vector<RayBundle> bundles = CollectBundles(window, frames, inlier, T_BC.rotation);
  if (static_cast<int>(bundles.size()) < kMinConsistentTracks) {
    return Status::Diverged("moving: only " + std::to_string(bundles.size()) + " consistent tracks, need " +
                            std::to_string(kMinConsistentTracks));
  }
  Vector6d solution;
  double free_gravity = 0;
  for (int round = 0; round < kRounds; ++round) {
    const NormalEquations equations = Assemble(bundles, frames, T_BC.translation);
    if (!Solve(equations, gravity_mps2, &solution, &free_gravity)) {
      return Status::Diverged("moving: velocity and gravity are not determined by these tracks");
    }
    Reweigh(frames, solution, T_BC.translation, &bundles);
  }
  LinearStart start = ToWorld(frames, solution, bias);
  start.free_gravity_mps2 = free_gravity;
  return start;
}

}  // namespace alidade
