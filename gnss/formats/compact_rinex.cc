#include "gnss/formats/compact_rinex.h"

#include <algorithm>
#include <map>
#include <vector>

#include "core/format.h"
#include "gnss/base/satellite_id.h"
#include "gnss/base/text_file.h"
#include "gnss/formats/differenced_number.h"

namespace alidade {
namespace {

struct SatelliteArc {
  std::vector<DifferencedNumber> numbers;
  std::string flags;
};

/// Columns of an epoch line.
struct EpochColumns {
  std::size_t flag, count, satellites, clock;
  int clock_width, clock_decimals;
};
constexpr EpochColumns kColumns1 = {28, 29, 32, 68, 12, 9};
constexpr EpochColumns kColumns3 = {31, 32, 41, 41, 15, 12};

class Decoder {
 public:
  Decoder(const std::string& path, std::string_view text, std::size_t max_bytes)
      : lines_(path, text), max_bytes_(max_bytes) {
    if (!text.ends_with('\n')) {
      torn_line_ = 1 + std::count(text.begin(), text.end(), '\n');
    }
  }

  Result<std::string> Decode() {
    ALIDADE_RETURN_IF_ERROR(ReadHeader());
    while (Next()) {
      if (lines_.trimmed().empty() && epoch_.empty()) {
        continue;
      }
      ALIDADE_RETURN_IF_ERROR(ReadEpochLine());
      const std::size_t before = out_.size();
      bool whole = false;
      ALIDADE_RETURN_IF_ERROR(flag_ > 1 ? CopyEvent(&whole) : ReadEpoch(&whole));
      if (!whole) {
        out_.resize(before);
        break;
      }
    }
    return std::move(out_);
  }

 private:
  bool Next() { return lines_.Next() && lines_.number() != torn_line_; }

  /// The fault of a text that grows beyond its bound, reported where it does.
  Status CheckSize() const {
    return out_.size() <= max_bytes_ ? Status::Ok()
                                     : lines_.Fault(Format("unpacks to more than %zu bytes", max_bytes_));
  }

  void Emit(std::string_view line) {
    const std::size_t end = line.find_last_not_of(' ');
    out_.append(line.substr(0, end == std::string_view::npos ? 0 : end + 1));
    out_.push_back('\n');
  }

  Status ReadHeader() {
    if (!Next()) {
      return Status::Input(lines_.path() + ": is empty");
    }
    const std::string_view version = Field(lines_.line(), 0, 20);
    if (version != "1.0" && version != "3.0" && version != "3.1") {
      return lines_.Fault("Compact RINEX version: found " + Excerpt(version) + ", expected 1.0 or 3.0");
    }
    modern_ = version[0] == '3';
    Next();  // which program packed it
    while (Next()) {
      Emit(lines_.line());
      ReadTypes();
      if (Field(lines_.line(), 60, 20) == "END OF HEADER") {
        return Status::Ok();
      }
    }
    return lines_.Fault("the header has no END OF HEADER");
  }

  /// The number of types decides how a satellite's line splits.
  void ReadTypes() {
    const std::string_view line = lines_.line();
    const std::string_view label = Field(line, 60, 20);
    if (label == "SYS / # / OBS TYPES" && line[0] != ' ') {
      types_[line[0]] =
          static_cast<std::size_t>(std::clamp(ParseInteger(Field(line, 3, 3)).value_or(0), 0, 999));
    } else if (label == "# / TYPES OF OBSERV" && !Field(line, 0, 6).empty()) {
      types2_ = static_cast<std::size_t>(std::clamp(ParseInteger(Field(line, 0, 6)).value_or(0), 0, 999));
    }
  }

  const EpochColumns& columns() const { return modern_ ? kColumns3 : kColumns1; }

  Status ReadEpochLine() {
    const std::string_view line = lines_.line();
    if (line.starts_with(modern_ ? '>' : '&')) {
      epoch_ = line;
      epoch_[0] = modern_ ? '>' : ' ';
      std::replace(epoch_.begin(), epoch_.end(), '&', ' ');
      arcs_.clear();
    } else if (epoch_.empty()) {
      return lines_.Fault("found " + Excerpt(line) + ", expected the first epoch");
    } else {
      ApplyTextDifference(line, &epoch_);
    }
    const std::optional<int> flag = ParseInteger(Field(epoch_, columns().flag, 1));
    const std::optional<int> count = ParseInteger(Field(epoch_, columns().count, 3));
    if (!flag || *flag < 0 || !count || *count < 0) {
      return lines_.Fault("epoch: found " + Excerpt(epoch_) + ", expected a flag and a number of satellites");
    }
    flag_ = *flag;
    count_ = static_cast<std::size_t>(*count);
    return Status::Ok();
  }

  Status CopyEvent(bool* whole) {
    Emit(epoch_);
    for (std::size_t i = 0; i < count_; ++i) {
      if (!Next()) {
        return Status::Ok();
      }
      Emit(lines_.line());
      ReadTypes();
    }
    epoch_.clear();  // the next epoch begins anew
    *whole = true;
    return Status::Ok();
  }

  Status ReadEpoch(bool* whole) {
    if (epoch_.size() < columns().satellites + 3 * count_) {
      return lines_.Fault(Format("epoch: announces %zu satellites and lists fewer", count_));
    }
    if (!Next()) {
      return Status::Ok();
    }
    if (!clock_.Apply(lines_.trimmed())) {
      return lines_.Fault("receiver clock: found " + Excerpt(lines_.line()) +
                          ", expected a number or its difference");
    }
    EmitEpochLine();
    std::map<std::string, SatelliteArc> next;
    for (std::size_t i = 0; i < count_; ++i) {
      if (!Next()) {
        return Status::Ok();
      }
      const std::string name = epoch_.substr(columns().satellites + 3 * i, 3);
      const auto found = arcs_.find(name);
      SatelliteArc arc = found == arcs_.end() ? SatelliteArc{} : std::move(found->second);
      ALIDADE_RETURN_IF_ERROR(ReadSatellite(name, &arc));
      next[name] = std::move(arc);
    }
    arcs_ = std::move(next);
    *whole = true;
    return Status::Ok();
  }

  void EmitEpochLine() {
    std::string clock = clock_.present() ? clock_.Text(columns().clock_width, columns().clock_decimals) : "";
    if (modern_) {
      std::string line = epoch_.substr(0, columns().satellites);
      Emit(line + clock);
      return;
    }
    constexpr std::size_t kSatellitesALine = 12;
    for (std::size_t i = 0; i == 0 || i < count_; i += kSatellitesALine) {
      std::string line =
          i == 0 ? epoch_.substr(0, columns().satellites) : std::string(columns().satellites, ' ');
      line += epoch_.substr(columns().satellites + 3 * i, 3 * std::min(kSatellitesALine, count_ - i));
      if (i == 0 && !clock.empty()) {
        line.resize(columns().clock, ' ');
        line += clock;
      }
      Emit(line);
    }
  }

  Status ReadSatellite(const std::string& name, SatelliteArc* arc) {
    const auto known = types_.find(name[0]);
    const std::size_t types = modern_ ? (known == types_.end() ? 0 : known->second) : types2_;
    arc->numbers.resize(types);
    std::string_view rest = lines_.line();
    for (std::size_t i = 0; i < types; ++i) {
      const std::size_t end = std::min(rest.find(' '), rest.size());
      if (!arc->numbers[i].Apply(rest.substr(0, end))) {
        return lines_.Fault(name + ": found " + Excerpt(rest.substr(0, end)) +
                            ", expected a number or its difference");
      }
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    if (rest.size() > 2 * types) {
      rest = rest.substr(0, 2 * types);
    }
    ApplyTextDifference(rest, &arc->flags);
    EmitSatellite(name, *arc);
    return CheckSize();
  }

  void EmitSatellite(const std::string& name, const SatelliteArc& arc) {
    constexpr std::size_t kFieldsALine2 = 5;
    std::string line = modern_ ? name : "";
    for (std::size_t i = 0; i < arc.numbers.size(); ++i) {
      if (!modern_ && i > 0 && i % kFieldsALine2 == 0) {
        Emit(line);
        line.clear();
      }
      if (!arc.numbers[i].present()) {
        line.append(16, ' ');
        continue;
      }
      line += arc.numbers[i].Text(14, 3);
      for (std::size_t k = 2 * i; k < 2 * i + 2; ++k) {
        line.push_back(k < arc.flags.size() ? arc.flags[k] : ' ');
      }
    }
    Emit(line);
  }

  LineReader lines_;
  std::size_t max_bytes_;
  std::ptrdiff_t torn_line_ = -1;  ///< the last line, when its end is missing
  bool modern_ = false;
  std::map<char, std::size_t> types_;
  std::size_t types2_ = 0;
  std::string epoch_;
  int flag_ = 0;
  std::size_t count_ = 0;
  DifferencedNumber clock_;
  std::map<std::string, SatelliteArc> arcs_;
  std::string out_;
};

}  // namespace

bool IsCompactRinex(std::string_view text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  return Field(line, 60, 20) == "CRINEX VERS   / TYPE";
}

Result<std::string> DecodeCompactRinex(const std::string& path, std::string_view text,
                                       std::size_t max_bytes) {
  return Decoder(path, text, max_bytes).Decode();
}

}  // namespace alidade
