#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "gnss/base/text_file.h"
#include "gnss/formats/observation.h"
#include "gnss/formats/rinex_epoch_line.h"
#include "gnss/formats/rinex_header.h"

namespace alidade {

/// Epoch by epoch of an observation file.
using TakeEpoch = std::function<void(ObservationEpoch)>;

/// Reads the records behind the header of RINEX 2, 3 and 4 observation files. A damaged one is passed over up
/// to the next epoch and counted in the file's warnings. All must outlive the object.
class RinexEpochReader {
 public:
  RinexEpochReader(LineReader* lines, ObservationFile* file, ObservationLayout* layout,
                   ObservationHeaderParser* header, const TakeEpoch& take);

  /// Of the first epoch; none: there is none.
  [[nodiscard]] std::optional<TimeNs> first_ns() const { return first_ns_; }

  void ReadAll();

 private:
  void Warn(const Status& status) { file_.warnings.Add(status); }
  /// RINEX 3 marks epochs; in RINEX 2 every line is tried.
  void SkipToEpoch();
  void ReadEvent(const EpochLine& event);
  void ReadEpoch(const EpochLine& line);
  /// False when the epoch is torn by the end of the file.
  bool ReadSatellites3(int count, ObservationEpoch* epoch);
  bool ReadSatellites2(int count, ObservationEpoch* epoch);
  bool Torn();
  void ReadField(const ObservationType& type, std::size_t column, SatelliteObservation* satellite);
  static SignalObservation& SignalOf(SignalCode code, SatelliteObservation* satellite);
  static void Keep(SatelliteObservation satellite, ObservationEpoch* epoch);

  LineReader& lines_;
  ObservationFile& file_;
  ObservationLayout& layout_;
  ObservationHeaderParser& header_;
  const TakeEpoch& take_;
  bool modern_;
  std::optional<TimeNs> first_ns_;
  TimeNs last_ns_ = 0;
};

}  // namespace alidade
