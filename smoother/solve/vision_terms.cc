#include "smoother/solve/vision_terms.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/predicted_observation.h"
#include "smoother/solve/window_problem.h"

namespace alidade {
namespace {

/// The kernel as Ceres asks for it.
class KernelLoss final : public ceres::LossFunction {
 public:
  explicit KernelLoss(const ObservationKernel& kernel) : kernel_(kernel) {}
  void Evaluate(double s, double rho[3]) const override {
    rho[0] = kernel_.Rho(s);
    rho[1] = kernel_.Weight(s);
    rho[2] = kernel_.SecondDerivative(s);
  }

 private:
  ObservationKernel kernel_;
};

std::unique_ptr<ceres::LossFunction> MakeLoss(const ObservationKernel& kernel) {
  return kernel.kernel == RobustKernel::kNone ? nullptr : std::make_unique<KernelLoss>(kernel);
}

}  // namespace

PoseOnlyTerm::PoseOnlyTerm(const Window& window, std::vector<const WindowTrack*> tracks,
                           const WindowCalibration& calibration, const ObservationKernel& kernel,
                           LandmarkMotion motion)
    : window_(&window),
      tracks_(std::move(tracks)),
      calibration_(&calibration),
      kernel_(kernel),
      cost_(window, tracks_, calibration, kernel, motion) {
  for (int i = 0; i < window.size(); ++i) {
    AddPart({Unknown::Kind::kFrame, i}, kPoseColumns);
  }
  AddPart({Unknown::Kind::kCalibration, 0}, calibration.size());
}

const PoseSystem& PoseOnlyTerm::system() const {
  if (!system_) {
    if (const PoseSystem* solved = cost_.SystemAt(Present())) {
      system_ = *solved;
      used_ = cost_.used();
    } else {
      system_ = SystemOf(tracks_, &used_);
    }
  }
  return *system_;
}

WindowPoint PoseOnlyTerm::Present() const {
  return PointOf(*window_, calibration_->mean);
}

PoseSystem PoseOnlyTerm::SystemOf(std::span<const WindowTrack* const> tracks,
                                  std::vector<const WindowTrack*>* used) const {
  PoseSystem system(window_->size(), calibration_);
  const std::vector<FrameGeometry> geometry = MakeGeometry(*window_, calibration_->mean);
  TrackWorkspace workspace;
  for (const WindowTrack* track : tracks) {
    if (AddTrack(track->views, geometry, kernel_, track->landmark, &workspace, &system, track->depth_prior)) {
      used->push_back(track);
    }
  }
  return system;
}

std::span<const std::optional<Eigen::Vector3d>> PoseOnlyTerm::SolvedLandmarks() const {
  return cost_.SystemAt(Present()) != nullptr ? cost_.landmarks()
                                              : std::span<const std::optional<Eigen::Vector3d>>();
}

void PoseOnlyTerm::Remove(std::span<const WindowTrack* const> tracks) {
  (void)system();
  std::vector<const WindowTrack*> held;
  std::erase_if(used_, [&](const WindowTrack* track) {
    const bool removed = std::find(tracks.begin(), tracks.end(), track) != tracks.end();
    if (removed) {
      held.push_back(track);
    }
    return removed;
  });
  std::vector<const WindowTrack*> counted;
  const PoseSystem gone = SystemOf(held, &counted);
  system_->hessian -= gone.hessian;
  system_->gradient -= gone.gradient;
  system_->robust_cost -= gone.robust_cost;
  system_->chi2 -= gone.chi2;
  system_->dof -= gone.dof;
  system_->tracks -= gone.tracks;
}

const std::vector<const WindowTrack*>& PoseOnlyTerm::used() const {
  (void)system();
  return used_;
}

Status PoseOnlyTerm::Linearize(LinearTerm* linear) const {
  linear->SetInformation(parts(), {system().hessian, system().gradient});
  return Status::Ok();
}

ViewContext::ViewContext(const WindowFrames& frames, const WindowCalibration& camera,
                         const ObservationKernel& of_views)
    : calibration(&camera),
      kernel(of_views),
      loss(MakeLoss(of_views)),
      cache(std::make_unique<GeometryCache>(camera, frames.size())) {
  geometry.reserve(frames.size());
  for (const std::unique_ptr<WindowFrame>& frame : frames) {
    geometry.push_back(MakeGeometry(*frame, frame->nav_state(), camera.mean));
  }
}

ViewTerm::ViewTerm(std::shared_ptr<const ViewContext> context, const WindowTrack* track, int landmark,
                   size_t view)
    : context_(std::move(context)), track_(track), landmark_(landmark), view_(view) {
  AddPart({Unknown::Kind::kFrame, track->views[view].frame->index}, kPoseColumns);
  AddPart({Unknown::Kind::kLandmark, landmark}, kLandmarkColumns);
  AddPart({Unknown::Kind::kCalibration, 0}, context_->calibration->size());
}

Status ViewTerm::Linearize(LinearTerm* linear) const {
  const WindowView& view = track_->views[view_];
  FrameGeometry base_row;
  FrameGeometry view_row;
  const FrameGeometry& base = AtRow(context_->geometry, track_->views.front(), &base_row);
  const FrameGeometry& frame = AtRow(context_->geometry, view, &view_row);
  ViewRows rows;
  if (!LinearizeView(base, frame, view.observation, context_->kernel, track_->landmark, &rows,
                     track_->plane())) {
    return Status::Diverged("smoother: track " + std::to_string(track_->id) + " lies behind the camera at " +
                            FormatSeconds(view.frame->stamp_ns) + " s");
  }
  linear->ResizeRows(parts(), 2);
  const WindowCalibration& camera = *context_->calibration;
  const double root = std::sqrt(rows.weight);
  linear->residual = root * rows.residual;
  linear->jacobian.leftCols<kPoseColumns>() = root * rows.pose;
  linear->jacobian.middleCols<kLandmarkColumns>(kPoseColumns) = root * rows.landmark;
  CalibrationRows(camera.layout, camera.mean.camera, frame.R_WB,
                  {&frame.camera_from_time, &frame.camera_from_line_delay}, root * rows.camera,
                  Predicted(view.observation, rows.residual), linear->jacobian.rightCols(camera.size()));
  return Status::Ok();
}

void ViewTerm::AddTo(WindowProblem* problem) {
  const WindowView& base = track_->views.front();
  const WindowView& view = track_->views[view_];
  const WindowCalibration* calibration = context_->calibration;
  std::vector<double*> parameters = {problem->blocks().Landmark(landmark_)};
  if (view_ == 0) {
    cost_ = std::make_unique<LiftedCost<BaseBearingFactor>>(BaseBearingFactor(&base, calibration));
  } else {
    cost_ = std::make_unique<LiftedCost<InverseDepthFactor>>(InverseDepthFactor(
        base.frame, &view, calibration, track_->plane(), base.observation.row_px, context_->cache.get()));
    parameters.insert(parameters.begin(),
                      {problem->blocks().Nav(base.frame->index), problem->blocks().Nav(view.frame->index)});
  }
  parameters.push_back(problem->blocks().Calibration());
  problem->ceres().AddResidualBlock(cost_.get(), context_->loss.get(), parameters);
}

DepthPriorTerm::DepthPriorTerm(std::shared_ptr<const ViewContext> context, const WindowTrack* track,
                               int landmark)
    : context_(std::move(context)),
      track_(track),
      landmark_(landmark),
      cost_(DepthPriorFactor(track->depth_prior)) {
  AddPart({Unknown::Kind::kFrame, track->views.front().frame->index}, kPoseColumns);
  AddPart({Unknown::Kind::kLandmark, landmark}, kLandmarkColumns);
  AddPart({Unknown::Kind::kCalibration, 0}, context_->calibration->size());
}

Status DepthPriorTerm::Linearize(LinearTerm* linear) const {
  FrameGeometry row;
  const FrameGeometry& base = AtRow(context_->geometry, track_->views.front(), &row);
  const double* landmark = track_->landmark.data();
  const Eigen::Matrix<double, 1, 6> camera =
      track_->depth_prior.sqrt_information * InverseDepthRow(base, track_->landmark, track_->plane());
  linear->ResizeRows(parts(), DepthPriorFactor::kRows);
  cost_.factor().Evaluate(&landmark, linear->residual.data(), nullptr);
  linear->jacobian.leftCols<kPoseColumns>() = camera * base.camera_from_body;
  linear->jacobian(0, kPoseColumns + 2) = track_->depth_prior.sqrt_information;
  const CalibrationLayout& layout = context_->calibration->layout;
  linear->jacobian.rightCols(layout.size()) = camera * CalibrationChain(layout, base);
  return Status::Ok();
}

void DepthPriorTerm::AddTo(WindowProblem* problem) {
  problem->ceres().AddResidualBlock(&cost_, nullptr, problem->blocks().Landmark(landmark_));
}

void AddTrackTerms(const WindowFrames& frames, const std::vector<WindowTrack*>& tracks,
                   const WindowCalibration& calibration, const ObservationKernel& kernel,
                   WindowTerms* terms) {
  const auto context = std::make_shared<const ViewContext>(frames, calibration, kernel);
  for (size_t i = 0; i < tracks.size(); ++i) {
    const WindowTrack& track = *tracks[i];
    const int landmark = static_cast<int>(i);
    terms->push_back(std::make_unique<ViewTerm>(context, &track, landmark, 0));
    if (track.depth_prior.sqrt_information > 0) {
      terms->push_back(std::make_unique<DepthPriorTerm>(context, &track, landmark));
    }
    for (size_t k = 1; k < track.views.size(); ++k) {
      terms->push_back(std::make_unique<ViewTerm>(context, &track, landmark, k));
    }
  }
}

}  // namespace alidade
