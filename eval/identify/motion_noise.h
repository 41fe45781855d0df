#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/estimator/measurement_log.h"
#include "core/estimator_config.h"
#include "eval/identify/innovation_likelihood.h"
#include "eval/record/run_options.h"

namespace alidade {

/// One noise, as identified.
struct IdentifiedNoise {
  NoiseSource source = NoiseSource::kGyro;
  double assumed = 0;  ///< by configuration and sensor sheet
  double value = 0;    ///< in the unit of UnitOf
  double low = 0;      ///< 95 % interval; 0: the likelihood has no lower bound
  double high = 0;     ///< likewise; infinity: no upper bound
  bool weak =
      false;  ///< the likelihood is far from a parabola: the interval is where it falls by 1.92, others held
};

/// Normalised innovation squared over its rows, of frames that were not used for the noises behind it.
struct HalfFit {
  std::string name;                      ///< first | second
  std::array<double, 4> nis_ratio = {};  ///< by RowSource; 0 without rows
  std::array<int, 4> dof = {};
};

/// The noise of a recording's sensors from the innovations of a filter in motion.
struct MotionNoise {
  std::vector<IdentifiedNoise> noises;
  ImuNoise sheet;  ///< to be used with imu.noise_scale and imu.random_walk_scale 1
  double pixel_noise_px = 0;
  std::array<HalfFit, 2> halves;
  std::vector<FrameFit> frames;  ///< at the identified noises
  double gain = 0;  ///< of the log-likelihood, from the first to the last factors of the last round
  int rounds = 0;
  int runs = 0;  ///< evaluations of the likelihood
  bool converged = false;
  std::vector<std::string> remarks;
};

struct MotionOptions {
  RunOptions run;
  int jobs = 1;
  int most_rounds = 6;
  std::function<void(const std::string& line)> progress;  ///< may be empty
};

/// Maximum likelihood of the innovations over the logarithms of the noises. A round runs the filter, records
/// what it does as a linear system (LinearSystem), and takes Newton steps on it (ScaleFit); the next round
/// starts from the noises found, until they change by less than 1 %. Intervals come from the observed
/// information. At last each half of the frames is predicted by the noises of the other half.
///
/// Errors: those of the run (kDiverged, kConfig); kInput: fewer than 20 frames had innovations.
Result<MotionNoise> IdentifyInMotion(const EstimatorConfig& config, const MeasurementLog& log,
                                     const MotionOptions& options);

}  // namespace alidade
