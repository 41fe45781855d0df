#include "gnss/formats/rinex_header.h"

#include <algorithm>

#include "core/format.h"
#include "gnss/base/system_index.h"

namespace alidade {
namespace {

constexpr std::size_t kMaxTypes = 999;  // the format's I3

/// The signal a RINEX 2 code or phase of `band` belongs to; kind 'P' is the P(Y) code, 'C' the civil one.
SignalCode SignalOfRinex2(GnssSystem system, char kind, char band) {
  switch (system) {
    case GnssSystem::kGps:
    case GnssSystem::kQzss:
      if (kind == 'P') {
        return {band, 'W'};
      }
      return {band, band == '1' ? 'C' : 'X'};
    case GnssSystem::kGlonass:
      return {band, kind == 'P' ? 'P' : 'C'};
    case GnssSystem::kBeidou:
      return {band == '1' ? '2' : band, 'I'};
    case GnssSystem::kSbas:
      return {band, band == '1' ? 'C' : 'X'};
    case GnssSystem::kGalileo:
    case GnssSystem::kNavic:
      break;
  }
  return {band, 'X'};
}

/// The code a RINEX 2 phase, Doppler or strength of `band` was measured on, by what the file holds.
char CodeKindOfBand(const std::vector<std::string>& types, char band) {
  const bool p = std::find(types.begin(), types.end(), std::string{'P', band}) != types.end();
  const bool c = std::find(types.begin(), types.end(), std::string{'C', band}) != types.end();
  return p && (band == '2' || !c) ? 'P' : 'C';
}

ObservationType TypeOfRinex2(GnssSystem system, const std::string& name,
                             const std::vector<std::string>& all) {
  const char kind = name[0];
  const char band = name[1];
  if (band >= 'A' && band <= 'F') {  // RINEX 2.12: CA = L1 C/A, CB = L1C, CC = L2C, CD = GLONASS L2 C/A
    const char digit = band <= 'B' ? '1' : '2';
    const char attribute = band == 'A' || band == 'D' ? 'C' : 'X';
    return {kind == 'P' ? 'X' : kind, {digit, attribute}, 1};
  }
  if (kind == 'P' || kind == 'C') {
    return {'C', SignalOfRinex2(system, kind, band), 1};
  }
  return {kind, SignalOfRinex2(system, CodeKindOfBand(all, band), band), 1};
}

}  // namespace

Status ObservationHeaderParser::ParseHeader(LineReader* lines) {
  if (!lines->Next()) {
    return Status::Input(lines->path() + ": is empty, expected RINEX observations");
  }
  ALIDADE_RETURN_IF_ERROR(ParseVersion(*lines));
  bool ended = false;
  while (!ended && lines->Next()) {
    ended = Field(lines->line(), kLabelColumn, 20) == "END OF HEADER";
    if (const Status status = ParseLine(*lines); !status.ok()) {
      file_->warnings.Add(status);
    }
  }
  if (!ended) {
    return lines->Fault("the header has no END OF HEADER");
  }
  Finish();
  const bool any =
      std::any_of(layout_->types.begin(), layout_->types.end(), [](const auto& t) { return !t.empty(); });
  if (!any) {
    return lines->Fault("the header names no observation types");
  }
  if (!layout_->scale_given) {
    constexpr std::pair<char, TimeScale> kDefaults[] = {{'R', TimeScale::kUtc}, {'C', TimeScale::kBeidou}};
    for (const auto& [letter, scale] : kDefaults) {
      layout_->scale = letter == file_system_ ? scale : layout_->scale;
    }
  }
  return Status::Ok();
}

Status ObservationHeaderParser::ParseVersion(const LineReader& lines) {
  const std::optional<double> version = ParseReal(Field(lines.line(), 0, 9));
  if (Field(lines.line(), kLabelColumn, 20) != "RINEX VERSION / TYPE" || !version) {
    return lines.Fault("found " + Excerpt(lines.trimmed()) + ", expected RINEX VERSION / TYPE");
  }
  if (!(*version >= 2 && *version < 5)) {
    return lines.Fault(Format("RINEX version: found %.2f, expected 2.00 to 4.99", *version));
  }
  const std::string_view type = Field(lines.line(), 20, 20);
  if (!type.starts_with('O')) {
    return lines.Fault("file type: found " + Excerpt(type) + ", expected OBSERVATION DATA");
  }
  file_->version = *version;
  const std::string_view system = Field(lines.line(), 40, 20);
  file_system_ = system.empty() ? 'G' : system[0];
  return Status::Ok();
}

Status ObservationHeaderParser::ParseLine(const LineReader& lines) {
  const std::string_view label = Field(lines.line(), kLabelColumn, 20);
  const std::string_view line = lines.line();
  if (label == "SYS / # / OBS TYPES") {
    return ParseTypes3(lines);
  }
  if (label == "# / TYPES OF OBSERV") {
    return ParseTypes2(lines);
  }
  if (label == "SYS / SCALE FACTOR") {
    return ParseScaleFactor(lines);
  }
  if (label == "GLONASS SLOT / FRQ #") {
    return ParseGlonassChannels(lines);
  }
  if (label == "MARKER NAME") {
    file_->marker = std::string(Field(line, 0, 60));
  } else if (label == "APPROX POSITION XYZ") {
    Eigen::Vector3d position;
    ALIDADE_RETURN_IF_ERROR(ParseVector(lines, &position));
    if (position.norm() > 1e6) {
      file_->approximate_position_E = position;
    }
  } else if (label == "ANTENNA: DELTA H/E/N") {
    return ParseVector(lines, &file_->antenna_delta_hen);
  } else if (label == "TIME OF FIRST OBS") {
    if (const std::optional<TimeScale> scale = ParseTimeScale(Field(line, 48, 3))) {
      layout_->scale = *scale;
      layout_->scale_given = true;
    }
  } else if (label == "LEAP SECONDS") {
    file_->leap_seconds = ParseInteger(Field(line, 0, 6));
    const std::string_view counted_in = Field(line, 24, 3);
    if (file_->leap_seconds && (counted_in == "BDS" || counted_in == "BDT")) {
      *file_->leap_seconds += kGpstLessBdtS;
    }
  }
  return Status::Ok();
}

Status ObservationHeaderParser::ParseVector(const LineReader& lines, Eigen::Vector3d* value) {
  Eigen::Vector3d parsed;
  for (int i = 0; i < 3; ++i) {
    const std::string_view field = Field(lines.line(), static_cast<std::size_t>(14 * i), 14);
    const std::optional<double> number = ParseReal(field);
    if (!number) {
      return lines.Fault("found " + Excerpt(field) + ", expected a length in metres");
    }
    parsed[i] = *number;
  }
  *value = parsed;
  return Status::Ok();
}

Status ObservationHeaderParser::ParseTypes3(const LineReader& lines) {
  const std::string_view line = lines.line();
  if (line[0] != ' ') {
    const std::optional<GnssSystem> system = ParseSystem(line[0]);
    const std::optional<int> count = ParseInteger(Field(line, 3, 3));
    system3_ = -1;
    if (!system || !count || *count < 0 || *count > static_cast<int>(kMaxTypes)) {
      return lines.Fault("found " + Excerpt(line.substr(0, 6)) + ", expected a system and a number of types");
    }
    system3_ = static_cast<int>(*system);
    expected3_ = static_cast<std::size_t>(*count);
    layout_->types[SystemIndex(*system)].clear();
  }
  if (system3_ < 0) {
    return lines.Fault("continues a list of observation types that has not begun");
  }
  std::vector<ObservationType>& types = layout_->types[static_cast<std::size_t>(system3_)];
  std::string_view words = line.substr(6, kLabelColumn - 6);
  for (std::string_view word = NextWord(&words); !word.empty() && types.size() < expected3_;
       word = NextWord(&words)) {
    ObservationType type;
    if (word.size() >= 2) {
      // Early 3.00 files leave the attribute out where there is one signal only.
      const SignalCode signal{word[1], word.size() > 2 ? word[2] : 'X'};
      type = {word[0], CanonicalSignal(static_cast<GnssSystem>(system3_), signal, file_->version), 1};
    }
    types.push_back(type);
  }
  return Status::Ok();
}

Status ObservationHeaderParser::ParseTypes2(const LineReader& lines) {
  const std::string_view first = Field(lines.line(), 0, 6);
  if (!first.empty()) {
    const std::optional<int> count = ParseInteger(first);
    if (!count || *count < 0 || *count > static_cast<int>(kMaxTypes)) {
      return lines.Fault("found " + Excerpt(first) + ", expected a number of types");
    }
    expected2_ = static_cast<std::size_t>(*count);
    layout_->types2.clear();
  }
  std::string_view words = lines.line().substr(6, kLabelColumn - 6);
  for (std::string_view word = NextWord(&words); !word.empty() && layout_->types2.size() < expected2_;
       word = NextWord(&words)) {
    layout_->types2.push_back(word.size() == 2 ? std::string(word) : "XX");
  }
  return Status::Ok();
}

void ObservationHeaderParser::Finish() {
  if (file_->version >= 3) {
    return;
  }
  for (int i = 0; i < kGnssSystems; ++i) {
    std::vector<ObservationType>& types = layout_->types[static_cast<std::size_t>(i)];
    types.clear();
    for (const std::string& name : layout_->types2) {
      types.push_back(TypeOfRinex2(static_cast<GnssSystem>(i), name, layout_->types2));
    }
  }
}

Status ObservationHeaderParser::ParseScaleFactor(const LineReader& lines) {
  std::string_view words = lines.line().substr(0, kLabelColumn);
  const std::string_view letter = NextWord(&words);
  const std::string_view factor_word = NextWord(&words);
  const std::optional<GnssSystem> system = letter.size() == 1 ? ParseSystem(letter[0]) : std::nullopt;
  const std::optional<int> factor = ParseInteger(factor_word);
  if (!system || !factor || *factor < 1) {
    return lines.Fault("found " + Excerpt(lines.trimmed()) + ", expected a system and a factor");
  }
  (void)NextWord(&words);  // the number of types, which the list shows
  bool listed = false;
  for (std::string_view word = NextWord(&words); word.size() >= 3; word = NextWord(&words)) {
    listed = true;
    const SignalCode signal = CanonicalSignal(*system, {word[1], word[2]}, file_->version);
    for (ObservationType& type : layout_->types[SystemIndex(*system)]) {
      type.factor = type.kind == word[0] && type.signal == signal ? *factor : type.factor;
    }
  }
  for (ObservationType& type : layout_->types[SystemIndex(*system)]) {
    type.factor = listed ? type.factor : *factor;
  }
  return Status::Ok();
}

Status ObservationHeaderParser::ParseGlonassChannels(const LineReader& lines) {
  // The count is not needed: what is there is read.
  for (std::size_t column = 4; column + 6 <= kLabelColumn; column += 7) {
    const std::string_view satellite = Field(lines.line(), column, 3);
    const std::optional<int> channel = ParseInteger(Field(lines.line(), column + 4, 2));
    if (satellite.empty() || !channel) {
      continue;
    }
    const std::optional<SatelliteId> id = ParseSatellite(satellite);
    if (!id || id->system != GnssSystem::kGlonass || *channel < -7 || *channel > 13) {
      return lines.Fault("found " + Excerpt(satellite) +
                         Format(" on channel %d, expected R01 to R99 on -7 to 13", *channel));
    }
    file_->glonass_channels[id->number] = *channel;
  }
  return Status::Ok();
}

}  // namespace alidade
