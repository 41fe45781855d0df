#include "core/batch_config.h"

namespace alidade {

void BatchConfig::Describe(ConfigVisitor& visitor) {
  visitor.Enumeration(
      {"initial", "-", "estimator that gives the initial values; configured in its own section"}, &initial,
      {{"filter", BatchInitial::kFilter}, {"smoother", BatchInitial::kSmoother}});
  visitor.Integer(
      {"max_iterations", "-", "largest number of iterations of one solve; a sequence takes a few solves"},
      &max_iterations, 1, 1000);
  visitor.Real({"tolerance_sigma", "sigma",
                "convergence: largest distance of a state from the minimum, in its own standard deviations"},
               &tolerance_sigma, 1e-8, 1);
  visitor.Enumeration(
      {"robust_kernel", "-", "kernel of the final estimate; any kernel but none loses efficiency"},
      &robust_kernel,
      {{"none", RobustKernel::kNone}, {"huber", RobustKernel::kHuber}, {"cauchy", RobustKernel::kCauchy}});
  visitor.Real(
      {"gate_probability", "-",
       "chi-square gate on whole tracks at the solution; wide, so that it does not reject nominal noise"},
      &gate_probability, 0.5, 1.0);
  visitor.Boolean(
      {"filtering_bound", "-",
       "also compute the covariance of each state given the data up to it: the bound of online estimators"},
      &filtering_bound);
}

}  // namespace alidade
