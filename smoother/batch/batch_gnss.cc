#include "smoother/batch/batch_gnss.h"

#include <utility>

namespace alidade {

void BatchGnss::Clear() {
  window_.Reset();
  epochs_.clear();
  statistics_.clear();
}

void BatchGnss::Align(const GnssAlignment& alignment, const WindowFrames& frames, LinearPrior* prior) {
  window_.Align(alignment, frames.front().get(), prior);
  for (size_t i = 1; i < frames.size(); ++i) {
    window_.PredictClock(*frames[i - 1], frames[i].get());
  }
}

void BatchGnss::AddFrame(const WindowFrames& frames) {
  if (frames.size() > 1) {
    window_.PredictClock(*frames[frames.size() - 2], frames.back().get());
  }
}

void BatchGnss::AddEpoch(const GnssEpoch& epoch, std::vector<ImuSample> imu, const ImuNoise& noise,
                         WindowFrame* frame) {
  if (imu.empty() && !frame->imu.empty()) {
    imu = {frame->imu.back()};  // the gyroscope at the frame
  }
  if (!window_.Attach(epoch, std::move(imu), noise, frame)) {
    return;
  }
  epochs_.push_back({std::move(frame->epochs.back()), frame->index, {}});
  frame->epochs.pop_back();
  (*frame->clock)[ClockState::kClock] += window_.step_m();
}

bool BatchGnss::Select(bool gate, const ImuNoise& noise, const WindowFrames& frames) {
  statistics_.assign(frames.size(), {});
  for (const std::unique_ptr<WindowFrame>& frame : frames) {
    frame->epochs.clear();
  }
  for (const Epoch& epoch : epochs_) {
    WindowFrame& frame = *frames[static_cast<size_t>(epoch.frame)];
    frame.epochs.push_back(epoch.attached);
    frame.epochs.back().Set(epoch.attached.imu, frame.imu_bias(), noise);
  }
  if (!gate) {
    return false;
  }
  for (const std::unique_ptr<WindowFrame>& frame : frames) {
    window_.Gate(frame.get(), &statistics_[static_cast<size_t>(frame->index)]);
  }
  bool changed = false;
  size_t on_frame = 0;
  for (size_t i = 0; i < epochs_.size(); ++i) {
    on_frame = i > 0 && epochs_[i].frame == epochs_[i - 1].frame ? on_frame + 1 : 0;
    const WindowFrame& frame = *frames[static_cast<size_t>(epochs_[i].frame)];
    const std::vector<bool>& used = frame.epochs[on_frame].used;
    changed = changed || used != epochs_[i].used;
    epochs_[i].used = used;
  }
  return changed;
}

void BatchGnss::Count(int frame, FrameStatistics* statistics) const {
  if (static_cast<size_t>(frame) < statistics_.size()) {
    const FrameStatistics& counted = statistics_[static_cast<size_t>(frame)];
    statistics->satellites_used = counted.satellites_used;
    statistics->satellites_gated = counted.satellites_gated;
    statistics->gnss_nis = counted.gnss_nis;
    statistics->gnss_nis_dof = counted.gnss_nis_dof;
  }
}

}  // namespace alidade
