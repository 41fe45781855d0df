#include "eval/simulation/spline_equations.h"

namespace alidade {
namespace {

// Weight of a squared second difference of control points against a squared residual: decides where no sample
// does, and elsewhere moves the spline by far less than any sample's noise.
constexpr double kEvenness = 1e-6;
// Weight of the second (rotation) or third (position) difference at either end. The outermost control point
// counts for 1/120 at most and only at the very end: held by that alone it would swing by radians, and the
// fit of a real flight would not settle. Tied to its neighbours it moves the spline by 1/120 of that
// difference. Rotation takes the lower order because it must settle even where the recording ends with a hard
// landing.
constexpr double kEndStiffness = 1e-2;

Eigen::Index Count(std::size_t value) {
  return static_cast<Eigen::Index>(value);
}

}  // namespace

SplineEquations::SplineEquations(std::size_t control_count, int end_order)
    : right_(Eigen::MatrixXd::Zero(Count(control_count), 3)) {
  for (std::size_t i = 0; i + 2 < control_count; ++i) {
    wishes_.push_back({i, {1, -2, 1, 0}, 3, kEvenness});
  }
  if (end_order == 2) {
    wishes_.push_back({0, {1, -2, 1, 0}, 3, kEndStiffness});
    wishes_.push_back({control_count - 3, {1, -2, 1, 0}, 3, kEndStiffness});
  } else {
    wishes_.push_back({0, {-1, 3, -3, 1}, 4, kEndStiffness});
    wishes_.push_back({control_count - 4, {-1, 3, -3, 1}, 4, kEndStiffness});
  }
  for (const Wish& wish : wishes_) {
    const Eigen::Index i = Count(wish.first);
    for (std::size_t a = 0; a < wish.count; ++a) {
      for (std::size_t b = 0; b < wish.count; ++b) {
        entries_.emplace_back(i + Count(a), i + Count(b),
                              wish.weight * wish.difference[a] * wish.difference[b]);
      }
    }
  }
}

void SplineEquations::AddRow(const SplinePlace& place, const SplineWeights& weights) {
  const Eigen::Index i = Count(place.segment);
  for (int a = 0; a < kSplineWeights; ++a) {
    for (int b = 0; b < kSplineWeights; ++b) {
      entries_.emplace_back(i + a, i + b,
                            weights[static_cast<std::size_t>(a)] * weights[static_cast<std::size_t>(b)]);
    }
  }
}

bool SplineEquations::Factorize() {
  Eigen::SparseMatrix<double> matrix(right_.rows(), right_.rows());
  matrix.setFromTriplets(entries_.begin(), entries_.end());
  entries_.clear();
  solver_.compute(matrix);
  return solver_.info() == Eigen::Success;
}

void SplineEquations::AddRight(const SplinePlace& place, const SplineWeights& weights,
                               const Eigen::Vector3d& residual) {
  for (int a = 0; a < kSplineWeights; ++a) {
    right_.row(Count(place.segment) + a) += weights[static_cast<std::size_t>(a)] * residual.transpose();
  }
}

void SplineEquations::AddWishes(const std::vector<Eigen::Vector3d>& steps) {
  for (const Wish& wish : wishes_) {
    // A difference of control points is one order less of steps: its coefficients are the sums so far.
    Eigen::Vector3d difference = Eigen::Vector3d::Zero();
    double sum = 0;
    for (std::size_t a = 0; a + 1 < wish.count; ++a) {
      sum -= wish.difference[a];
      difference += sum * steps[wish.first + a];
    }
    for (std::size_t a = 0; a < wish.count; ++a) {
      right_.row(Count(wish.first + a)) -= wish.weight * wish.difference[a] * difference.transpose();
    }
  }
}

}  // namespace alidade
