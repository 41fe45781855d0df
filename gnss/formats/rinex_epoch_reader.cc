#include "gnss/formats/rinex_epoch_reader.h"

#include <algorithm>

#include "core/format.h"
#include "gnss/base/system_index.h"

namespace alidade {
namespace {

constexpr std::size_t kFieldWidth = 16;  // F14.3, loss of lock, strength
constexpr std::size_t kObservationWidth = 14;
constexpr std::size_t kFieldsALine2 = 5;
constexpr std::size_t kSatellitesALine2 = 12;

}  // namespace

RinexEpochReader::RinexEpochReader(LineReader* lines, ObservationFile* file, ObservationLayout* layout,
                                   ObservationHeaderParser* header, const TakeEpoch& take)
    : lines_(*lines),
      file_(*file),
      layout_(*layout),
      header_(*header),
      take_(take),
      modern_(file->version >= 3) {}

void RinexEpochReader::ReadAll() {
  while (lines_.Next()) {
    if (lines_.trimmed().empty()) {
      continue;
    }
    const Result<EpochLine> epoch = ParseEpochLine(lines_, modern_, layout_.scale);
    if (!epoch.ok()) {
      Warn(epoch.status());
      SkipToEpoch();
    } else if (epoch->flag <= 1) {
      ReadEpoch(*epoch);
    } else {
      ReadEvent(*epoch);
    }
  }
}

void RinexEpochReader::SkipToEpoch() {
  while (modern_ && lines_.Next()) {
    if (lines_.line().starts_with('>')) {
      lines_.PutBack();
      return;
    }
  }
}

void RinexEpochReader::ReadEvent(const EpochLine& event) {
  ++file_.events;
  for (int i = 0; i < event.count && lines_.Next(); ++i) {
    if (modern_ && lines_.line().starts_with('>')) {
      Warn(lines_.Fault("an event record is shorter than its stated number of lines"));
      lines_.PutBack();
      break;
    }
    if (event.flag == 6) {
      continue;  // cycle slips; in RINEX 2 the satellites' own lines fail as epochs and are passed over
    }
    if (const Status status = header_.ParseLine(lines_); !status.ok()) {
      Warn(status);
    }
  }
  header_.Finish();
}

void RinexEpochReader::ReadEpoch(const EpochLine& line) {
  ObservationEpoch epoch;
  epoch.stamp_ns = *line.stamp_ns;
  const bool whole = modern_ ? ReadSatellites3(line.count, &epoch) : ReadSatellites2(line.count, &epoch);
  if (!whole) {
    return;
  }
  if (first_ns_ && epoch.stamp_ns <= last_ns_) {
    Warn(lines_.Fault("the epoch ending here is not later than the previous one; skipped"));
    return;
  }
  std::stable_sort(epoch.satellites.begin(), epoch.satellites.end(),
                   [](const auto& a, const auto& b) { return a.satellite < b.satellite; });
  const auto twin = std::unique(epoch.satellites.begin(), epoch.satellites.end(),
                                [](const auto& a, const auto& b) { return a.satellite == b.satellite; });
  if (twin != epoch.satellites.end()) {
    Warn(lines_.Fault("a satellite occurs twice in the epoch ending here; the first is used"));
    epoch.satellites.erase(twin, epoch.satellites.end());
  }
  first_ns_ = first_ns_.value_or(epoch.stamp_ns);
  last_ns_ = epoch.stamp_ns;
  take_(std::move(epoch));
}

bool RinexEpochReader::ReadSatellites3(int count, ObservationEpoch* epoch) {
  for (int i = 0; i < count; ++i) {
    if (!lines_.Next()) {
      Warn(lines_.Fault("the last epoch is truncated; skipped"));
      return false;
    }
    if (lines_.line().starts_with('>')) {
      Warn(
          lines_.Fault(Format("the previous epoch holds %d satellites, its epoch line states %d", i, count)));
      lines_.PutBack();
      return true;
    }
    const std::optional<SatelliteId> id = ParseSatellite(lines_.line().substr(0, 3));
    if (!id) {
      Warn(
          lines_.Fault("satellite: found " + Excerpt(lines_.line().substr(0, 3)) + ", expected such as G07"));
      continue;
    }
    SatelliteObservation satellite{*id, {}};
    const auto& types = layout_.types[SystemIndex(id->system)];
    for (std::size_t k = 0; k < types.size() && 3 + k * kFieldWidth < lines_.line().size(); ++k) {
      ReadField(types[k], 3 + k * kFieldWidth, &satellite);
    }
    Keep(std::move(satellite), epoch);
  }
  return true;
}

bool RinexEpochReader::ReadSatellites2(int count, ObservationEpoch* epoch) {
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) {
    const std::size_t place = static_cast<std::size_t>(i) % kSatellitesALine2;
    if (i > 0 && place == 0 && !lines_.Next()) {
      return Torn();
    }
    std::string name(lines_.line().substr(std::min(lines_.line().size(), 32 + 3 * place), 3));
    name.resize(3, ' ');
    names.push_back(name);
  }
  const std::size_t fields = layout_.types2.size();
  for (const std::string& name : names) {
    const std::optional<SatelliteId> id = ParseSatellite(name);
    SatelliteObservation satellite{id.value_or(SatelliteId{}), {}};
    const auto& types = layout_.types[SystemIndex(satellite.satellite.system)];
    for (std::size_t k = 0; k < fields; ++k) {
      if (k % kFieldsALine2 == 0 && !lines_.Next()) {
        return Torn();
      }
      ReadField(types[k], k % kFieldsALine2 * kFieldWidth, &satellite);
    }
    if (!id) {
      Warn(lines_.Fault("satellite: found " + Excerpt(name) + ", expected such as G07"));
      continue;
    }
    Keep(std::move(satellite), epoch);
  }
  return true;
}

bool RinexEpochReader::Torn() {
  Warn(lines_.Fault("the last epoch is truncated; skipped"));
  return false;
}

void RinexEpochReader::ReadField(const ObservationType& type, std::size_t column,
                                 SatelliteObservation* satellite) {
  const std::string_view field = Field(lines_.line(), column, kObservationWidth);
  if (field.empty()) {
    return;
  }
  const std::optional<double> number = ParseReal(field);
  // Numbers are right-aligned: one that the line cuts short is torn.
  if (!number || lines_.line().size() < column + kObservationWidth) {
    Warn(lines_.Fault(Format("column %zu: found ", column + 1) + Excerpt(field) +
                      ", expected a number of width 14"));
    return;
  }
  if (*number == 0) {
    return;  // zero means missing
  }
  SignalObservation& signal = SignalOf(type.signal, satellite);
  const double value = *number / type.factor;
  switch (type.kind) {
    case 'C':
      signal.pseudorange_m = value;
      break;
    case 'L': {
      signal.phase_cycles = value;
      const std::optional<int> lock = ParseInteger(Field(lines_.line(), column + kObservationWidth, 1));
      signal.loss_of_lock = static_cast<std::uint8_t>(std::max(lock.value_or(0), 0));
      break;
    }
    case 'D':
      signal.doppler_hz = value;
      break;
    case 'S':
      signal.cn0_dbhz = value;
      break;
    default:
      break;
  }
}

SignalObservation& RinexEpochReader::SignalOf(SignalCode code, SatelliteObservation* satellite) {
  auto& signals = satellite->signals;
  const auto found =
      std::find_if(signals.begin(), signals.end(), [&](const auto& s) { return s.signal == code; });
  if (found != signals.end()) {
    return *found;
  }
  SignalObservation& added = signals.emplace_back();
  added.signal = code;
  return added;
}

void RinexEpochReader::Keep(SatelliteObservation satellite, ObservationEpoch* epoch) {
  if (satellite.signals.empty()) {
    return;
  }
  std::sort(satellite.signals.begin(), satellite.signals.end(),
            [](const auto& a, const auto& b) { return a.signal < b.signal; });
  epoch->satellites.push_back(std::move(satellite));
}

}  // namespace alidade
