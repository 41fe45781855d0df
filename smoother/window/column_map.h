#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace alidade {

/// A group of a window's unknowns.
struct Unknown {
  enum class Kind {
    kFrame,        ///< (phi, dp, dv, dbg, dba) of a frame, or the first of them
    kClock,        ///< of a frame (core/clock_state.h)
    kCalibration,  ///< in the coordinates of its layout; there is one
    kLandmark,     ///< (x, y, rho)
  };
  Kind kind = Kind::kFrame;
  int index = 0;  ///< of the frame, or of the landmark
};

inline constexpr Eigen::Index kPoseColumns = 6;
inline constexpr Eigen::Index kNavColumns = 9;
inline constexpr Eigen::Index kBiasColumns = 6;
inline constexpr Eigen::Index kStateColumns = kNavColumns + kBiasColumns;
inline constexpr Eigen::Index kClockColumns = 6;
inline constexpr Eigen::Index kLandmarkColumns = 3;

/// Which columns of a matrix belong to which unknowns. Groups are laid out in the order in which they are
/// added.
class ColumnMap {
 public:
  using Index = Eigen::Index;
  struct Range {
    Index first = 0;
    Index size = 0;  ///< 0: the unknown has no columns
  };

  void Add(const Unknown& unknown, Index size);
  /// A frame with all of its coordinates, or with those of its pose.
  void AddState(int frame) { Add({Unknown::Kind::kFrame, frame}, kStateColumns); }
  void AddPose(int frame) { Add({Unknown::Kind::kFrame, frame}, kPoseColumns); }
  void AddClock(int frame) { Add({Unknown::Kind::kClock, frame}, kClockColumns); }
  void AddCalibration(Index size) { Add({Unknown::Kind::kCalibration, 0}, size); }
  void AddLandmark(int landmark) { Add({Unknown::Kind::kLandmark, landmark}, kLandmarkColumns); }

  [[nodiscard]] Range Find(const Unknown& unknown) const;
  [[nodiscard]] Range Frame(int frame) const { return Find({Unknown::Kind::kFrame, frame}); }
  [[nodiscard]] Range Clock(int frame) const { return Find({Unknown::Kind::kClock, frame}); }
  [[nodiscard]] Range Calibration() const { return Find({Unknown::Kind::kCalibration, 0}); }
  [[nodiscard]] Range Landmark(int landmark) const { return Find({Unknown::Kind::kLandmark, landmark}); }
  /// Number of columns.
  [[nodiscard]] Index size() const { return size_; }

 private:
  struct Group {
    int first_index = 0;
    std::vector<Range> ranges;  ///< from first_index on
  };

  std::array<Group, 4> groups_;  ///< by kind
  Index size_ = 0;
};

}  // namespace alidade
