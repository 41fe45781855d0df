#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/calibration.h"
#include "core/pixel_noise.h"
#include "core/track_frame.h"
#include "core/visual_observation.h"
#include "filter/track_memory.h"

namespace alidade {

/// Tracks of a frame for which memory is set aside; more make vectors grow.
inline constexpr std::size_t kUsualTracks = 256;

/// One view of a track that still waits to be used (or is kept as base).
struct TrackView {
  int serial = 0;  ///< of the clone that saw it
  NormalizedObservation observation;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< what was seen, whatever the intrinsics are
  double noise_ratio = 1;                           ///< PixelNoise::Ratio
};

/// A feature track and what the filter has done with it. views.front() is the base.
struct Track {
  std::int64_t id = 0;
  std::vector<TrackView> views;
  int base_rounds = 0;    ///< updates the present base has already served
  int last_serial = -1;   ///< newest frame that saw the track
  int observations = 0;   ///< of its life, also those used and forgotten
  bool in_state = false;  ///< its landmark is in the state; views then holds the newest observation only
  TrackMemory memory;
};

/// Live tracks sorted by id. Storage of ended tracks is re-used, so that the steady state does not allocate.
class TrackStore {
 public:
  TrackStore() = default;
  /// Sets memory aside for the usual number of tracks of up to max_views views, each with a memory of
  /// max_views clones if so wished, and of an error of calibration_size.
  TrackStore(int max_views, bool with_memory, int calibration_size = 0);

  /// Merges a frame's observations (sorted by id) into the tracks; returns how many lay outside the camera's
  /// domain or had no valid noise.
  int AddFrame(const CameraModel& camera, const PixelNoise& noise, int serial,
               const std::vector<TrackObservation>& observations);
  /// Observations of all views anew, after the camera's intrinsics have changed. A view that the camera's
  /// domain no longer holds stays as it is. Nothing where the layout has no intrinsics.
  void Renormalize(const CalibrationLayout& layout, const CameraModel& camera, double pixel_noise_px);
  /// Removes tracks that have ended (not seen by `serial`) and those without views.
  void RemoveEnded(int serial);
  /// Forgets the views of a clone; a base that goes takes its round count with it.
  void RemoveClone(int serial);
  void Clear();

  /// The live track of this id, or nullptr.
  [[nodiscard]] Track* Find(std::int64_t id);
  [[nodiscard]] std::vector<Track>& tracks() { return tracks_; }
  [[nodiscard]] const std::vector<Track>& tracks() const { return tracks_; }

 private:
  [[nodiscard]] Track MakeTrack() const;
  Track TakeSpare(std::int64_t id);

  int max_views_ = 0;
  int memory_columns_ = 0;
  std::vector<Track> tracks_;
  std::vector<Track> merged_;
  std::vector<Track> spare_;
};

}  // namespace alidade
