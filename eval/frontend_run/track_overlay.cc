#include "eval/frontend_run/track_overlay.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "eval/files/output_file.h"

namespace alidade {
namespace {

constexpr std::size_t kTail = 10;
constexpr std::size_t kOldAge = 50;

cv::Point ToPoint(const Eigen::Vector2d& pixel) {
  return {static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))};
}

/// The observation of a track in a frame; null when it is not there. Frames are sorted by track id.
const TrackObservation* Find(const TrackFrame& frame, std::int64_t id) {
  const auto found = std::lower_bound(
      frame.observations.begin(), frame.observations.end(), id,
      [](const TrackObservation& observation, std::int64_t wanted) { return observation.track_id < wanted; });
  return found != frame.observations.end() && found->track_id == id ? &*found : nullptr;
}

void DrawTrack(const std::vector<TrackFrame>& frames, std::size_t index, const TrackObservation& newest,
               cv::Mat* picture) {
  std::vector<cv::Point> places = {ToPoint(newest.pixel)};
  std::size_t age = 1;
  for (; age <= std::min(index, kOldAge); ++age) {
    const TrackObservation* before = Find(frames[index - age], newest.track_id);
    if (before == nullptr) {
      break;
    }
    if (age <= kTail) {
      places.push_back(ToPoint(before->pixel));
    }
  }
  const double old = static_cast<double>(std::min(age, kOldAge)) / kOldAge;
  const cv::Scalar colour(255 * (1 - old), 160 * std::min(1.0, 2 - 2 * old), 255 * old);  // blue green red
  for (std::size_t i = 1; i < places.size(); ++i) {
    cv::line(*picture, places[i - 1], places[i], colour, 1, cv::LINE_AA);
  }
  cv::circle(*picture, places.front(), 3, colour, cv::FILLED, cv::LINE_AA);
}

}  // namespace

Status WriteTrackOverlay(const GreyImage& image, const std::vector<TrackFrame>& frames, std::size_t index,
                         const std::string& path) {
  // OpenCV has no view of constant memory; the pixels are only read.
  const cv::Mat grey(image.height_px, image.width_px, CV_8UC1,
                     const_cast<unsigned char*>(image.pixels.data()));
  cv::Mat picture;
  cv::cvtColor(grey, picture, cv::COLOR_GRAY2BGR);
  for (const TrackObservation& observation : frames[index].observations) {
    DrawTrack(frames, index, observation, &picture);
  }
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", picture, bytes, {cv::IMWRITE_PNG_COMPRESSION, 6})) {
    return Status::Output(path + ": the image cannot be encoded as PNG");
  }
  return WriteFileAtomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace alidade
