#include "gnss/formats/rinex_observation.h"

#include "core/format.h"
#include "gnss/formats/compact_rinex.h"
#include "gnss/formats/rinex_epoch_reader.h"
#include "gnss/formats/rinex_header.h"

namespace alidade {
namespace {

Result<ObservationFile> ParseLines(LineReader* lines, const TakeEpoch& take) {
  const std::string& path = lines->path();
  ObservationFile file;
  ObservationLayout layout;
  ObservationHeaderParser header(&file, &layout);
  ALIDADE_RETURN_IF_ERROR(header.ParseHeader(lines));
  RinexEpochReader reader(lines, &file, &layout, &header, take);
  reader.ReadAll();
  if (!reader.first_ns()) {
    return file.warnings.Nothing(path, "epoch of observations");
  }
  const int expected = LeapSeconds(*reader.first_ns());
  if (file.leap_seconds && *file.leap_seconds != expected) {
    file.warnings.Add(
        Status::Input(path + Format(": LEAP SECONDS: found %d, expected %d", *file.leap_seconds, expected)));
  }
  return file;
}

Result<ObservationFile> ParseEpochs(const std::string& path, std::string_view text, const TakeEpoch& take) {
  std::string plain;
  if (IsCompactRinex(text)) {
    Result<std::string> unpacked = DecodeCompactRinex(path, text);
    ALIDADE_RETURN_IF_ERROR(unpacked.status());
    plain = *std::move(unpacked);
    text = plain;
  }
  LineReader lines(path, text);
  return ParseLines(&lines, take);
}

}  // namespace

Result<ObservationFile> ParseRinexObservation(const std::string& path, std::string_view text) {
  std::vector<ObservationEpoch> epochs;
  Result<ObservationFile> file =
      ParseEpochs(path, text, [&epochs](ObservationEpoch epoch) { epochs.push_back(std::move(epoch)); });
  if (file.ok()) {
    file->epochs = std::move(epochs);
  }
  return file;
}

Result<ObservationFile> ScanRinexObservation(const std::string& path, const TakeEpoch& take,
                                             std::size_t* epochs) {
  *epochs = 0;
  const TakeEpoch count = [&](ObservationEpoch epoch) {
    ++*epochs;
    if (take) {
      take(std::move(epoch));
    }
  };
  Result<TextStream> stream = TextStream::Open(path);
  ALIDADE_RETURN_IF_ERROR(stream.status());
  std::string begin;
  stream->Read(&begin);
  if (IsCompactRinex(begin)) {
    const Result<std::string> text = ReadTextFile(path);
    ALIDADE_RETURN_IF_ERROR(text.status());
    return ParseEpochs(path, *text, count);
  }
  LineReader lines(path, &*stream, std::move(begin));
  Result<ObservationFile> file = ParseLines(&lines, count);
  ALIDADE_RETURN_IF_ERROR(stream->status());
  return file;
}

Result<ObservationFile> ReadRinexObservation(const std::string& path) {
  const Result<std::string> text = ReadTextFile(path);
  ALIDADE_RETURN_IF_ERROR(text.status());
  Result<ObservationFile> file = ParseRinexObservation(path, *text);
  // A cut between two fields leaves a line that is valid, since blank fields at its end may be left out.
  if (file.ok() && !text->ends_with('\n')) {
    file->warnings.Add(
        Status::Input(path + ": the last line has no line end, expected one: is the file cut?"));
  }
  return file;
}

}  // namespace alidade
