#include "gnss/positioning/single_point_options.h"

namespace alidade {

void SinglePointOptions::Describe(ConfigVisitor& visitor) {
  visitor.Enumeration(
      {"kernel", "-", "robust kernel of the residuals"}, &kernel,
      {{"none", RobustKernel::kNone}, {"huber", RobustKernel::kHuber}, {"cauchy", RobustKernel::kCauchy}});
  visitor.Real({"kernel_scale_sigma", "sigma", "whitened residual above which the kernel reduces the weight"},
               &kernel_scale_sigma, 0.1, 100);
  visitor.Real(
      {"gate_probability", "-", "chi-square gate of one satellite at the epoch's robust scale; 1 = no gate"},
      &gate_probability, 0.5, 1);
  visitor.Real({"inter_system_walk", "m/sqrt(s)",
                "random walk of the inter-system biases that are carried between epochs"},
               &inter_system_walk, 0, 1e6);
  visitor.Real({"max_position_std_m", "m",
                "largest position standard deviation of a solution; with weaker geometry an epoch has none"},
               &max_position_std_m, 1, 1e6);
  visitor.Integer({"max_iterations", "-", "largest number of iterations of the robust least squares"},
                  &max_iterations, 2, 1000);
}

}  // namespace alidade
