#pragma once

#include <string>
#include <vector>

#include "eval/frontend_run/image_pipeline.h"
#include "eval/render/hall_renderer.h"
#include "eval/render/image_fault.h"
#include "eval/simulation/simulation.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// What the camera of a simulated sequence sees: one image a camera stamp, of the hall around its path. The
/// exposure's middle is the stamp plus the camera's time offset; with a rolling shutter, that of the middle
/// row. A fault of the camera (eval/render/image_fault.h) acts on them.
class RenderedSequence {
 public:
  /// Errors: those of MakeHall.
  static Result<RenderedSequence> Create(const SimulatorConfig& config, const Simulation& simulation,
                                         unsigned seed);

  [[nodiscard]] const std::vector<TimeNs>& stamps() const { return stamps_; }
  [[nodiscard]] const Hall& hall() const { return renderer_.hall(); }
  /// Text that differs whenever the images or the gyroscope beside them may: keys, seed, lens, motion, IMU.
  [[nodiscard]] const std::string& Fingerprint() const { return fingerprint_; }
  /// Poses T_WC of the camera in the middle of each exposure, at the camera's stamps; with a rolling shutter
  /// kPosesOfRows more, evenly from the first row to the last.
  [[nodiscard]] Trajectory CameraPoses() const;
  /// How the images are exposed, one a stamp; empty without exposure control.
  [[nodiscard]] const std::vector<Exposure>& exposures() const { return exposures_; }
  /// Any frame, from any thread.
  [[nodiscard]] GreyImage Frame(std::size_t index) const;

 private:
  static constexpr int kPosesOfRows = 8;

  RenderedSequence(const SimulatorConfig& config, const Simulation& simulation, Hall hall, unsigned seed);

  [[nodiscard]] Pose CameraPose(double time_s) const;  ///< time since the motion's start
  [[nodiscard]] double LightAt(double time_s) const;   ///< of the scene
  [[nodiscard]] Shot ShotOf(std::size_t index) const;  ///< with the exposure that the keys give
  [[nodiscard]] double MiddleOfExposure(std::size_t index) const;

  RenderConfig config_;
  std::string fingerprint_;
  std::shared_ptr<const ContinuousTrajectory> motion_;
  TimeNs motion_start_ns_;
  RigCalibration rig_;
  std::vector<TimeNs> stamps_;
  ImageFault fault_;
  HallRenderer renderer_;
  std::vector<Exposure> exposures_;
};

/// Writes the images as mav0/cam0/data/<stamp>.png below `path`, what was drawn (eval/render/hall_file.h),
/// with exposure control mav0/cam0/exposure.csv, and the list mav0/cam0/data.csv last. Errors: kOutput;
/// kDiverged: stopped.
Status WriteRenderedImages(const RenderedSequence& sequence, const std::string& path,
                           const PipelineOptions& options);

/// Runs the front end over the images without writing them. frontend_ms is the tracker's time alone.
Result<std::vector<TrackFrame>> TrackRenderedImages(const RenderedSequence& sequence, const Dataset& dataset,
                                                    const FrontendConfig& config,
                                                    const PipelineOptions& options);

}  // namespace alidade
