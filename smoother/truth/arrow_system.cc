#include "smoother/truth/arrow_system.h"

#include <Eigen/Cholesky>

namespace alidade {

void ArrowSystem::Reset() {
  nodes_.assign(nodes_.size(), Node());
  border_.setZero();
  border_gradient_.setZero();
}

void ArrowSystem::AddLink(size_t k, const Vector15d& residual, const Matrix15d& of_k,
                          const Matrix15d& of_next, const LinkBorderRows& of_border) {
  Node& node = nodes_[k];
  Node& next = nodes_[k + 1];
  node.own.noalias() += of_k.transpose() * of_k;
  node.next.noalias() += of_k.transpose() * of_next;
  next.own.noalias() += of_next.transpose() * of_next;
  node.gradient.noalias() += of_k.transpose() * residual;
  next.gradient.noalias() += of_next.transpose() * residual;
  if (!of_border.isZero(0)) {
    node.border.noalias() += of_k.transpose() * of_border;
    next.border.noalias() += of_next.transpose() * of_border;
    border_.noalias() += of_border.transpose() * of_border;
    border_gradient_.noalias() += of_border.transpose() * residual;
  }
}

void ArrowSystem::AddPose(size_t k, const Vector6d& residual, const PoseRows& of_k,
                          const BorderRows& of_border) {
  Node& node = nodes_[k];
  node.own.noalias() += of_k.transpose() * of_k;
  node.border.noalias() += of_k.transpose() * of_border;
  node.gradient.noalias() += of_k.transpose() * residual;
  border_.noalias() += of_border.transpose() * of_border;
  border_gradient_.noalias() += of_border.transpose() * residual;
}

void ArrowSystem::AddPrior(size_t k, const Vector15d& residual, const Vector15d& root) {
  nodes_[k].own.diagonal() += root.cwiseAbs2();
  nodes_[k].gradient += root.cwiseProduct(residual);
}

void ArrowSystem::AddBorderPrior(const Border& residual, const Border& root) {
  border_.diagonal() += root.cwiseAbs2();
  border_gradient_ += root.cwiseProduct(residual);
}

bool ArrowSystem::Factorize() {
  newton_decrement_ = 0;
  for (size_t k = 0; k < nodes_.size(); ++k) {
    Node& node = nodes_[k];
    const Eigen::LLT<Matrix15d> factor(node.own);
    if (factor.info() != Eigen::Success || !node.own.allFinite()) {
      return false;
    }
    const Matrix15d next = factor.solve(node.next);
    const Coupling border = factor.solve(node.border);
    const Vector15d step = factor.solve(node.gradient);
    newton_decrement_ += node.gradient.dot(step);
    if (k + 1 < nodes_.size()) {
      Node& following = nodes_[k + 1];
      following.own.noalias() -= node.next.transpose() * next;
      following.border.noalias() -= node.next.transpose() * border;
      following.gradient.noalias() -= node.next.transpose() * step;
    }
    border_.noalias() -= node.border.transpose() * border;
    border_gradient_.noalias() -= node.border.transpose() * step;
    node = {factor.solve(Matrix15d::Identity()), next, border, step};
  }
  const Eigen::LLT<BorderMatrix> factor(border_);
  if (factor.info() != Eigen::Success || !border_.allFinite()) {
    return false;
  }
  border_covariance_ = factor.solve(BorderMatrix::Identity());
  border_step_ = -factor.solve(border_gradient_);
  newton_decrement_ -= border_gradient_.dot(border_step_);
  return true;
}

void ArrowSystem::Solve(const std::function<void(const Solution&)>& visit) const {
  Solution solution;
  for (size_t k = nodes_.size(); k-- > 0;) {
    const Node& node = nodes_[k];
    const Solution later = solution;
    solution.k = k;
    solution.next_covariance = later.covariance;
    solution.next_with_border = later.with_border;
    solution.step = -node.gradient - node.next * later.step - node.border * border_step_;
    solution.with_border = -node.next * later.with_border - node.border * border_covariance_;
    solution.with_next = -node.next * later.covariance - node.border * later.with_border.transpose();
    const Matrix15d own = node.own - solution.with_next * node.next.transpose() -
                          solution.with_border * node.border.transpose();
    solution.covariance = 0.5 * (own + own.transpose());
    visit(solution);
  }
}

}  // namespace alidade
