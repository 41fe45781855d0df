#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "gnss/formats/observation.h"

namespace alidade {

/// Where the label of a header line begins.
inline constexpr std::size_t kLabelColumn = 60;

/// One column of a satellite's record: what is measured on which signal.
struct ObservationType {
  char kind = 'X';  ///< C pseudorange, L phase, D Doppler, S strength, anything else is passed over
  SignalCode signal;
  double factor = 1;  ///< the file holds the value times this
};

/// What the header of an observation file states about its records.
struct ObservationLayout {
  TimeScale scale = TimeScale::kGps;
  bool scale_given = false;
  std::array<std::vector<ObservationType>, kGnssSystems> types;
  std::vector<std::string> types2;  ///< RINEX 2: one list for all systems
};

/// Reads header lines of RINEX 2, 3 and 4 observation files, in the header and in event records.
/// Sources: RINEX 2.11 table A1, RINEX 3.05 table A2, RINEX 4.00 table A2.
class ObservationHeaderParser {
 public:
  ObservationHeaderParser(ObservationFile* file, ObservationLayout* layout) : file_(file), layout_(layout) {}

  /// Everything up to END OF HEADER. Errors: no RINEX observation file, an unknown version, no end, no types.
  Status ParseHeader(LineReader* lines);
  /// One line. Errors name the line; the header so far stays as it was.
  Status ParseLine(const LineReader& lines);
  /// To be called after lines of an event record: RINEX 2's types are turned into types by system.
  void Finish();

 private:
  Status ParseVersion(const LineReader& lines);
  Status ParseTypes3(const LineReader& lines);
  Status ParseTypes2(const LineReader& lines);
  Status ParseScaleFactor(const LineReader& lines);
  Status ParseGlonassChannels(const LineReader& lines);
  Status ParseVector(const LineReader& lines, Eigen::Vector3d* value);

  ObservationFile* file_;
  ObservationLayout* layout_;
  char file_system_ = 'G';
  // State of lists that go on in the next line.
  int system3_ = -1;
  std::size_t expected3_ = 0;
  std::size_t expected2_ = 0;
};

}  // namespace alidade
