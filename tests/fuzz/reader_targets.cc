#include <array>

#include "eval/compare/external_times.h"
#include "eval/compare/plan_parser.h"
#include "eval/comparison/cell_file.h"
#include "eval/config/config_yaml.h"
#include "eval/dataset/calibration_import.h"
#include "eval/dataset/dataset_fix.h"
#include "eval/dataset/dataset_gnss.h"
#include "eval/dataset/dataset_tracks.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/download/catalogue.h"
#include "eval/render/hall_file.h"
#include "eval/rosbag/gnss_messages.h"
#include "eval/rosbag/gnss_navigation_messages.h"
#include "eval/rosbag/gnss_receiver_messages.h"
#include "eval/rosbag/ros_position_messages.h"
#include "eval/rosbag/ros_sensor_messages.h"
#include "eval/rosbag/rosbag_chunk.h"
#include "eval/simulation/simulator_config.h"
#include "eval/trajectory/external_trajectory.h"
#include "eval/trajectory/nmea_reader.h"
#include "eval/trajectory/position_file_reader.h"
#include "eval/trajectory/trajectory_reader.h"
#include "frontend/tracking/image_reader.h"
#include "gnss/formats/compact_rinex.h"
#include "gnss/formats/precise_products.h"
#include "gnss/formats/rinex_navigation.h"
#include "gnss/formats/rinex_observation.h"
#include "gnss/formats/rinex_writer.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

constexpr char kName[] = "input";

/// A refusal states what is wrong, and of texts and files with a name also where.
template <typename T>
void RequireMessage(const Result<T>& result, const std::string& where = kName) {
  Require(result.ok() || result.message().find(where) != std::string::npos,
          "the message names its input: " + result.message());
}

/// Writes the bytes to a file of the right extension and hands its path to `read`.
template <typename Read>
void ReadAsFile(std::string_view bytes, const std::string& name, const Read& read) {
  static const TemporaryFolder folder;
  RequireMessage(read(folder.Write(name, std::string(bytes))), folder.path());
}

void TakeRinexObservation(std::string_view bytes) {
  const Result<ObservationFile> file = ParseRinexObservation(kName, bytes);
  RequireMessage(file);
  if (file.ok()) {  // what was read can be written and read again
    const Result<ObservationFile> again = ParseRinexObservation(kName, FormatRinexObservation(*file));
    Require(!again.ok() || again->epochs.size() <= file->epochs.size(), "no epoch is made by writing");
  }
}

void TakeRinexNavigation(std::string_view bytes) {
  const Result<NavigationData> data = ParseRinexNavigation(kName, bytes);
  RequireMessage(data);
  if (data.ok()) {
    RequireMessage(ParseRinexNavigation(kName, FormatRinexNavigation(*data)));
  }
}

void TakeMessages(std::string_view bytes) {
  std::map<int, int> channels;
  static_cast<void>(DecodeMeasurements(bytes, &channels).ok());
  static_cast<void>(DecodeKeplerEphemeris(bytes).ok());
  static_cast<void>(DecodeGlonassEphemeris(bytes).ok());
  static_cast<void>(DecodeIonosphere(bytes).ok());
  static_cast<void>(DecodeSolution(bytes).ok());
  static_cast<void>(DecodeTimePulse(bytes).ok());
  static_cast<void>(DecodeTrigger(bytes).ok());
  static_cast<void>(DecodeImu(bytes));
  static_cast<void>(DecodeNavSatFix(bytes));
  static_cast<void>(DecodePosition(bytes));
  static_cast<void>(DecodeState(bytes));
  static_cast<void>(DecodeText(bytes));
  static_cast<void>(DecodeCompressedImage(bytes));
  if (const std::optional<TrackFrame> frame = DecodeTracks(bytes)) {
    Require(frame->observations.size() <= bytes.size(), "no more tracks than bytes");
  }
  if (const std::optional<RawImage> image = DecodeImage(bytes)) {
    if (const std::optional<GreyImage> grey = GreyOf(*image)) {
      Require(grey->pixels.size() == static_cast<std::size_t>(grey->width_px) * grey->height_px,
              "an image has its pixels");
    }
  }
}

void TakeChunk(std::string_view bytes) {
  for (const BagCompression compression : {BagCompression::kBz2, BagCompression::kLz4}) {
    for (const std::size_t size : {std::size_t{0}, std::size_t{1000}, std::size_t{1} << 20}) {
      const Result<std::string> unpacked = UnpackChunk(compression, bytes, size);
      Require(!unpacked.ok() || unpacked->size() == size, "a chunk has the stated size");
    }
  }
}

void TakeImage(std::string_view bytes) {
  const std::span<const unsigned char> data(reinterpret_cast<const unsigned char*>(bytes.data()),
                                            bytes.size());
  RequireMessage(DecodeGreyImage(data, kName));
}

void TakeConfig(std::string_view bytes) {
  ReadAsFile(bytes, "config.yaml", [](const std::string& path) { return LoadEstimatorConfig(path, {}); });
}

void TakeSettings(std::string_view bytes) {
  EstimatorConfig config;
  const Status applied =
      ApplySettings(SplitSettings(bytes), [&](ConfigVisitor& visitor) { config.Describe(visitor); });
  Require(applied.ok() || !applied.message().empty(), "a refusal has a message");
}

void TakeSheet(std::string_view bytes) {
  const std::string text(bytes);
  RequireMessage(ParseImuSensor(text, kName));
  RequireMessage(ParseCameraSensor(text, kName));
  RequireMessage(ParseGnssSheet(text, kName));
  RequireMessage(ParseFixSheet(text, kName));
}

void TakeTrajectory(std::string_view bytes) {
  ReadAsFile(bytes, "trajectory.csv", [](const std::string& path) {
    ExternalContext context;
    context.camera_stamps = {1'000'000'000, 2'000'000'000};
    return ReadExternalTrajectory(path, &context);
  });
  ReadAsFile(bytes, "positions.pos", [](const std::string& path) { return ReadPositionRows(path); });
}

constexpr std::array kTargets = {
    FuzzTarget{"rinex_observation", TakeRinexObservation},
    FuzzTarget{"rinex_navigation", TakeRinexNavigation},
    FuzzTarget{"compact_rinex",
               [](std::string_view bytes) {
                 RequireMessage(DecodeCompactRinex(kName, bytes, std::size_t{1} << 22));
               }},
    FuzzTarget{"sp3", [](std::string_view bytes) { RequireMessage(ParseSp3(kName, bytes)); }},
    FuzzTarget{"rinex_clock", [](std::string_view bytes) { RequireMessage(ParseRinexClock(kName, bytes)); }},
    FuzzTarget{"ros_messages", TakeMessages},
    FuzzTarget{"bag_chunk", TakeChunk},
    FuzzTarget{"image", TakeImage},
    FuzzTarget{"config", TakeConfig},
    FuzzTarget{"settings", TakeSettings},
    FuzzTarget{"simulator_config",
               [](std::string_view bytes) {
                 ReadAsFile(bytes, "simulation.yaml",
                            [](const std::string& path) { return LoadSimulatorConfig(path, {}); });
               }},
    FuzzTarget{"plan",
               [](std::string_view bytes) {
                 ReadAsFile(bytes, "plan.yaml",
                            [](const std::string& path) { return ReadPlan(path, ALIDADE_SOURCE_DIR); });
               }},
    FuzzTarget{"catalogue",
               [](std::string_view bytes) {
                 ReadAsFile(bytes, "catalogue.yaml",
                            [](const std::string& path) { return ReadCatalogue(path); });
               }},
    FuzzTarget{"sheet", TakeSheet},
    FuzzTarget{"calibration",
               [](std::string_view bytes) {
                 ReadAsFile(bytes, "calibration.yaml",
                            [](const std::string& path) { return ImportCalibration({path}); });
               }},
    FuzzTarget{"trajectory", TakeTrajectory},
    FuzzTarget{"nmea",
               [](std::string_view bytes) {
                 ReadAsFile(bytes, "receiver.nmea", [](const std::string& path) {
                   return ReadNmeaFile(path, CalendarTime{2024, 2, 29});
                 });
               }},
    FuzzTarget{"tracks",
               [](std::string_view bytes) {
                 ReadAsFile(bytes, "tracks.csv", [](const std::string& path) { return ReadTracks(path); });
               }},
    FuzzTarget{"hall",
               [](std::string_view bytes) {
                 ReadAsFile(bytes, "hall.csv", [](const std::string& path) { return ReadHall(path); });
               }},
    FuzzTarget{"times",
               [](std::string_view bytes) {
                 ReadAsFile(bytes, "timing.csv",
                            [](const std::string& path) { return ReadExternalTimes(path); });
               }},
    FuzzTarget{"cell",
               [](std::string_view bytes) {
                 ReadAsFile(bytes, "cell.cbor", [](const std::string& path) { return ReadCellFile(path); });
               }},
};

}  // namespace

std::span<const FuzzTarget> ReaderTargets() {
  return kTargets;
}

}  // namespace alidade::test
