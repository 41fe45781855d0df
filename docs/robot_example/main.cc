#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "eval/run/session.h"

// Streams a folder with imu0/data.csv and cam0/tracks.csv into a session, in the order of arrival: samples at
// once, frames 60 ms late. On a robot the drivers take the place of the files.
namespace {
std::vector<alidade::ImuSample> ReadImu(std::ifstream file) {
  std::vector<alidade::ImuSample> samples;
  for (std::string line; std::getline(file, line);) {
    alidade::ImuSample s;
    if (std::sscanf(line.c_str(), "%" SCNd64 ",%lf,%lf,%lf,%lf,%lf,%lf", &s.stamp_ns, &s.gyro[0], &s.gyro[1],
                    &s.gyro[2], &s.accel[0], &s.accel[1], &s.accel[2]) == 7) {
      samples.push_back(s);
    }
  }
  return samples;
}

std::vector<alidade::TrackFrame> ReadTracks(std::ifstream file) {
  std::vector<alidade::TrackFrame> frames;
  for (std::string line; std::getline(file, line);) {
    alidade::TimeNs stamp_ns = 0;
    alidade::TrackObservation o;
    if (std::sscanf(line.c_str(), "%" SCNd64 ",%" SCNd64 ",%lf,%lf", &stamp_ns, &o.track_id, &o.pixel[0],
                    &o.pixel[1]) == 4) {
      if (frames.empty() || frames.back().stamp_ns != stamp_ns) {
        frames.push_back({stamp_ns, {}});
      }
      frames.back().observations.push_back(o);
    }
  }
  return frames;
}
}  // namespace

int main(int argc, char** argv) {
  const std::string folder = argc == 2 ? argv[1] : "";
  const std::string imu_path = folder + "/mav0/imu0/data.csv";
  const std::string tracks_path = folder + "/mav0/cam0/tracks.csv";
  const auto samples = ReadImu(std::ifstream(imu_path));
  const auto frames = ReadTracks(std::ifstream(tracks_path));
  alidade::RigCalibration rig;  // of the simulator; a robot has its own
  rig.camera =
      *alidade::CameraModel::Create(alidade::DistortionModel::kNone, {460, 460, 376, 240}, {}, 752, 480);
  rig.T_BC.rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // the camera looks along the body's x axis
  rig.T_BC.translation << 0.1, -0.05, 0.04;
  alidade::SessionOptions options;
  options.lateness.camera_s = 0.1;
  const auto session = alidade::Session::Make(alidade::EstimatorConfig(), rig, options);
  const std::string error = argc != 2         ? "usage: robot FOLDER"
                            : samples.empty() ? "no IMU samples in " + imu_path
                            : frames.empty()  ? "no tracks in " + tracks_path
                                              : session.message();
  if (argc != 2 || samples.empty() || frames.empty() || !session.ok()) {
    std::fprintf(stderr, "%s\n", error.c_str());
    return 1;
  }
  auto frame = frames.begin();
  for (const alidade::ImuSample& sample : samples) {
    (*session)->AddImu(sample);
    for (; frame != frames.end() && frame->stamp_ns + 60'000'000 <= sample.stamp_ns; ++frame) {
      (*session)->AddFrame(*frame);
    }
    for (const alidade::SessionEvent& event : (*session)->TakeEvents()) {
      std::printf("%s\n", alidade::Describe(event).c_str());
    }
  }
  const auto newest = (*session)->Newest();  // frames of the last 60 ms have not arrived, earlier ones wait
  if (!newest.ok()) {
    std::fprintf(stderr, "no estimate: %s\n", newest.message().c_str());
    return 1;
  }
  std::printf("newest at %s s, speed %.3f m/s\n", alidade::FormatSeconds(newest->estimate.stamp_ns).c_str(),
              newest->v_B.norm());
}
