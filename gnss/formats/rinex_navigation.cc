#include "gnss/formats/rinex_navigation.h"

#include <algorithm>

#include "core/format.h"
#include "gnss/formats/navigation_message.h"
#include "gnss/formats/rinex_header.h"

namespace alidade {
namespace {

constexpr std::size_t kRecordWidth = 19;
constexpr std::size_t kMaxLines = 12;  // the longest message, BeiDou CNAV, has ten

class NavigationReader {
 public:
  NavigationReader(const std::string& path, std::string_view text) : lines_(path, text) {}

  Result<NavigationData> Read() {
    ALIDADE_RETURN_IF_ERROR(ReadHeader());
    while (lines_.Next()) {
      if (lines_.trimmed().empty()) {
        continue;
      }
      if (const Status status = version_ >= 4 ? ReadFrame() : ReadMessage(std::nullopt); !status.ok()) {
        data_.warnings.Add(status);
      }
    }
    if (data_.ephemerides() == 0) {
      return data_.warnings.Nothing(lines_.path(), "ephemeris of a kind that is used");
    }
    NavigationData sorted;
    sorted.Merge(std::move(data_));
    return sorted;
  }

 private:
  Status ReadHeader() {
    if (!lines_.Next()) {
      return Status::Input(lines_.path() + ": is empty, expected RINEX navigation data");
    }
    ALIDADE_RETURN_IF_ERROR(ReadVersion());
    while (lines_.Next()) {
      const std::string_view label = Field(lines_.line(), kLabelColumn, 20);
      if (label == "END OF HEADER") {
        return Status::Ok();
      }
      if (const Status status = ReadHeaderLine(label); !status.ok()) {
        data_.warnings.Add(status);
      }
    }
    return lines_.Fault("the header has no END OF HEADER");
  }

  Status ReadVersion() {
    const std::optional<double> version = ParseReal(Field(lines_.line(), 0, 9));
    if (Field(lines_.line(), kLabelColumn, 20) != "RINEX VERSION / TYPE" || !version) {
      return lines_.Fault("found " + Excerpt(lines_.trimmed()) + ", expected RINEX VERSION / TYPE");
    }
    if (!(*version >= 2 && *version < 5)) {
      return lines_.Fault(Format("RINEX version: found %.2f, expected 2.00 to 4.99", *version));
    }
    version_ = *version;
    const std::string_view type = Field(lines_.line(), 20, 20);
    // RINEX 2 has a file type a system, RINEX 3 and 4 have N for all.
    constexpr std::pair<char, GnssSystem> kTypes2[] = {{'N', GnssSystem::kGps},
                                                       {'G', GnssSystem::kGlonass},
                                                       {'E', GnssSystem::kGalileo},
                                                       {'H', GnssSystem::kSbas}};
    for (const auto& [letter, system] : kTypes2) {
      if (type.starts_with(letter) && (version_ < 3 || letter == 'N')) {
        system2_ = system;
        return Status::Ok();
      }
    }
    return lines_.Fault("file type: found " + Excerpt(type) + ", expected NAVIGATION DATA");
  }

  Status ReadHeaderLine(std::string_view label) {
    const std::string_view line = lines_.line();
    if (label == "LEAP SECONDS") {
      data_.leap_seconds = ParseInteger(Field(line, 0, 6));
    } else if (label == "ION ALPHA" || label == "ION BETA") {
      return ReadKlobucharLine(2, label == "ION ALPHA", &data_.gps_ionosphere);
    } else if (label == "IONOSPHERIC CORR") {
      const std::string_view name = Field(line, 0, 4);
      if (name == "GPSA" || name == "GPSB") {
        return ReadKlobucharLine(5, name == "GPSA", &data_.gps_ionosphere);
      }
      if (name == "BDSA" || name == "BDSB") {
        return ReadKlobucharLine(5, name == "BDSA", &data_.beidou_ionosphere);
      }
      if (name == "GAL") {
        std::array<double, 3> a{};
        for (std::size_t i = 0; i < 3; ++i) {
          a[i] = ParseReal(Field(line, 5 + 12 * i, 12)).value_or(0);
        }
        data_.galileo_ionosphere = a;
      }
    }
    return Status::Ok();
  }

  Status ReadKlobucharLine(std::size_t start, bool alpha, std::optional<KlobucharParameters>* target) {
    std::array<double, 4> values{};
    for (std::size_t i = 0; i < 4; ++i) {
      const std::string_view field = Field(lines_.line(), start + 12 * i, 12);
      const std::optional<double> value = ParseReal(field);
      if (!value) {
        return lines_.Fault("ionosphere: found " + Excerpt(field) + ", expected a number");
      }
      values[i] = *value;
    }
    KlobucharParameters parameters = target->value_or(KlobucharParameters{});
    (alpha ? parameters.alpha : parameters.beta) = values;
    *target = parameters;
    return Status::Ok();
  }

  /// A line that goes on with a message begins with blanks where a new one has its satellite.
  static bool Continues(std::string_view line) { return line.size() > 3 && Field(line, 0, 3).empty(); }

  /// RINEX 4: "> EPH G01 LNAV", then the message.
  Status ReadFrame() {
    std::string_view words = lines_.line();
    if (NextWord(&words) != ">") {
      return SkipTo(
          lines_.Fault("found " + Excerpt(lines_.line()) + ", expected a record that begins with '>'"));
    }
    const std::string_view kind = NextWord(&words);
    const std::string_view satellite = NextWord(&words);
    const std::string_view type = NextWord(&words);
    if (kind == "ION") {
      return ReadIonosphere(satellite, type);
    }
    constexpr std::pair<std::string_view, NavMessage> kTypes[] = {
        {"LNAV", NavMessage::kLnav}, {"INAV", NavMessage::kInav}, {"FNAV", NavMessage::kFnav},
        {"D1", NavMessage::kD1},     {"D2", NavMessage::kD2},     {"FDMA", NavMessage::kFdma}};
    const auto found =
        std::find_if(std::begin(kTypes), std::end(kTypes), [&](const auto& t) { return t.first == type; });
    if (kind != "EPH" || found == std::end(kTypes) || satellite.starts_with('I')) {
      ++data_.passed_over;
      return SkipTo(Status::Ok());
    }
    if (!lines_.Next()) {
      return lines_.Fault("the last message is torn");
    }
    if (lines_.line().starts_with('>')) {
      lines_.PutBack();
      return lines_.Fault("the message before is empty");
    }
    return ReadMessage(found->second);
  }

  /// Passes over lines up to the next frame of RINEX 4.
  Status SkipTo(Status status) {
    while (lines_.Next()) {
      if (lines_.line().starts_with('>')) {
        lines_.PutBack();
        break;
      }
    }
    return status;
  }

  Status ReadMessage(std::optional<NavMessage> message) {
    const bool modern = version_ >= 3;
    const std::string_view line = lines_.line();
    const int first_line = lines_.number();
    RawNavMessage raw;
    std::optional<SatelliteId> satellite;
    if (modern) {
      satellite = ParseSatellite(line.substr(0, 3));
    } else if (const std::optional<int> number = ParseInteger(Field(line, 0, 2)); number && *number > 0) {
      satellite = SatelliteId{system2_, *number};
    }
    if (!satellite || Continues(line)) {
      return lines_.Fault("satellite: found " + Excerpt(line.substr(0, 3)) + ", expected such as G07");
    }
    raw.satellite = *satellite;
    const Result<CalendarTime> epoch = ParseCalendar(modern ? Field(line, 3, 20) : Field(line, 2, 20));
    ReadNumbers(modern ? 23 : 22, 3, &raw);
    for (std::size_t i = 0; i < kMaxLines && lines_.Next(); ++i) {
      if (!Continues(lines_.line())) {
        lines_.PutBack();
        break;
      }
      ReadNumbers(modern ? 4 : 3, 4, &raw);
    }
    Status status = epoch.ok() ? bad_number_ : Status::Input("epoch: " + epoch.message());
    bad_number_ = Status::Ok();
    if (status.ok()) {
      raw.epoch = *epoch;
      status = Keep(raw, message);
    }
    return status.ok() ? status
                       : Status::Input(lines_.path() + Format(":%d: ", first_line) + status.message());
  }

  void ReadNumbers(std::size_t start, int count, RawNavMessage* raw) {
    for (int i = 0; i < count; ++i) {
      const std::string_view field =
          Field(lines_.line(), start + static_cast<std::size_t>(i) * kRecordWidth, kRecordWidth);
      const std::optional<double> value = ParseReal(field);
      if (!value && !field.empty() && bad_number_.ok()) {
        bad_number_ =
            Status::Input(ToString(raw->satellite) + ": found " + Excerpt(field) + ", expected a number");
      }
      raw->numbers.push_back(value);
    }
  }

  Status Keep(const RawNavMessage& raw, std::optional<NavMessage> message) {
    switch (raw.satellite.system) {
      case GnssSystem::kGlonass: {
        Result<GlonassEphemeris> ephemeris = MakeGlonassEphemeris(raw);
        if (!ephemeris.ok()) {
          return ephemeris.status();
        }
        data_.glonass[raw.satellite.number].push_back(*ephemeris);
        return Status::Ok();
      }
      case GnssSystem::kSbas:
      case GnssSystem::kNavic:
        ++data_.passed_over;
        return Status::Ok();
      default:
        break;
    }
    Result<KeplerEphemeris> ephemeris = MakeKeplerEphemeris(raw, message);
    if (!ephemeris.ok()) {
      return ephemeris.status();
    }
    data_.kepler[raw.satellite].push_back(*ephemeris);
    return Status::Ok();
  }

  /// ION: a time and three numbers, then four a line.
  Status ReadIonosphere(std::string_view satellite, std::string_view type) {
    RawNavMessage raw;
    if (!lines_.Next() || lines_.line().starts_with('>')) {
      lines_.PutBack();
      return lines_.Fault("an ionosphere message is torn");
    }
    ReadNumbers(23, 3, &raw);
    while (lines_.Next()) {
      if (lines_.line().starts_with('>') || raw.numbers.size() > 4 * kMaxLines) {
        lines_.PutBack();
        break;
      }
      ReadNumbers(4, 4, &raw);
    }
    bad_number_ = Status::Ok();
    const std::size_t wanted = type == "IFNV" ? 3 : 8;
    raw.numbers.resize(std::max(raw.numbers.size(), wanted));
    if (!std::all_of(raw.numbers.begin(), raw.numbers.begin() + static_cast<std::ptrdiff_t>(wanted),
                     [](const auto& number) { return number.has_value(); })) {
      return lines_.Fault("an ionosphere message lacks parameters");
    }
    if (type == "IFNV") {
      data_.galileo_ionosphere = {*raw.numbers[0], *raw.numbers[1], *raw.numbers[2]};
      return Status::Ok();
    }
    KlobucharParameters parameters;
    for (std::size_t i = 0; i < 4; ++i) {
      parameters.alpha[i] = *raw.numbers[i];
      parameters.beta[i] = *raw.numbers[i + 4];
    }
    if (satellite.starts_with('G') && type == "LNAV") {
      data_.gps_ionosphere = parameters;
    } else if (satellite.starts_with('C') && type == "D1D2") {
      data_.beidou_ionosphere = parameters;
    }
    return Status::Ok();
  }

  LineReader lines_;
  double version_ = 0;
  GnssSystem system2_ = GnssSystem::kGps;
  Status bad_number_;
  NavigationData data_;
};

}  // namespace

Result<NavigationData> ParseRinexNavigation(const std::string& path, std::string_view text) {
  return NavigationReader(path, text).Read();
}

Result<NavigationData> ReadRinexNavigation(const std::string& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text.ok()) {
    return text.status();
  }
  return ParseRinexNavigation(path, *text);
}

}  // namespace alidade
