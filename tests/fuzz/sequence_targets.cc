#include <array>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/check.h"
#include "eval/bag/bag_import.h"
#include "eval/bag/bag_import_options.h"
#include "eval/dataset/dataset_check.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/record/recorder.h"
#include "eval/record/recorder_reader.h"
#include "eval/record/runner.h"
#include "tests/fuzz/fuzz_scene.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

/// Input: the name of a file in the folder, a line feed, and what is in the file instead. Nothing for a name
/// that the folder does not have.
struct FileInput {
  std::filesystem::path path;
  std::string_view content;
};
std::optional<FileInput> SplitInput(const std::string& folder, std::string_view bytes) {
  const std::size_t end = bytes.substr(0, 200).find('\n');
  if (end == std::string_view::npos) {
    return {};
  }
  const std::string_view name = bytes.substr(0, end);
  if (name.find("..") != std::string_view::npos || name.find('\0') != std::string_view::npos) {
    return {};
  }
  FileInput input{std::filesystem::path(folder) / std::filesystem::path(name).relative_path(),
                  bytes.substr(end + 1)};
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(input.path, ignored)) {
    return {};
  }
  return input;
}

/// Puts the content in place while `read` is called.
template <typename Read>
void ReadReplaced(const FileInput& input, const Read& read) {
  std::stringstream kept;
  kept << std::ifstream(input.path, std::ios::binary).rdbuf();
  std::ofstream(input.path, std::ios::binary) << input.content;
  read();
  std::ofstream(input.path, std::ios::binary) << kept.str();
}

void TakeSequence(std::string_view bytes) {
  static const TemporaryFolder folder;
  static const bool written = WriteDataset(FuzzScene(), folder.path()).ok();
  CHECK(written);
  const std::optional<FileInput> input = SplitInput(folder.path(), bytes);
  if (!input) {
    return;
  }
  ReadReplaced(*input, [] {
    const Result<Dataset> dataset = ReadDataset(folder.path());
    if (!dataset.ok()) {
      Require(dataset.message().find(folder.path()) != std::string::npos,
              "the message names its input: " + dataset.message());
      return;
    }
    static_cast<void>(CheckDataset(*dataset));
    for (std::size_t i = 1; i < dataset->imu.size(); ++i) {
      Require(dataset->imu[i - 1].stamp_ns < dataset->imu[i].stamp_ns, "IMU stamps increase");
    }
    for (const ImuSample& sample : dataset->imu) {
      Require(sample.gyro.allFinite() && sample.accel.allFinite(), "IMU samples are finite");
    }
    for (std::size_t i = 1; i < dataset->frames.size(); ++i) {
      Require(dataset->frames[i - 1].stamp_ns < dataset->frames[i].stamp_ns, "stamps of frames increase");
    }
  });
}

void TakeRun(std::string_view bytes) {
  static const TemporaryFolder folder;
  static const bool written = [] {
    RunIdentity identity;
    identity.config.init.method = InitMethod::kTruth;
    const Dataset& scene = FuzzScene();
    return WriteRun(identity, RunEstimator(identity.config, MeasurementsOf(scene), &*scene.truth, 1),
                    folder.path())
        .ok();
  }();
  CHECK(written);
  const std::optional<FileInput> input = SplitInput(folder.path(), bytes);
  if (!input) {
    return;
  }
  ReadReplaced(*input, [] {
    const Result<RunResult> run = ReadRun(folder.path());
    Require(run.ok() || run.message().find(folder.path()) != std::string::npos,
            "the message names its input: " + run.message());
  });
}

void TakeBag(std::string_view bytes) {
  static const TemporaryFolder folder;
  const std::string path = folder.Write("recording.bag", std::string(bytes));
  BagImportOptions options;
  options.imu = ImuSensor{};
  options.camera = CameraSensor{};
  std::size_t image_bytes = 0;
  options.take_image = [&](const BagImage& image) {
    image_bytes += image.grey.pixels.size() + image.file.size();
    return Status();
  };
  const Result<BagImport> bag = ReadBag(path, options);
  Require(bag.ok() || bag.message().find(path) != std::string::npos,
          "the message names its input: " + bag.message());
  if (bag.ok()) {
    static_cast<void>(CheckDataset(bag->dataset));
  }
}

constexpr std::array kTargets = {
    FuzzTarget{"sequence", TakeSequence},
    FuzzTarget{"run", TakeRun},
    FuzzTarget{"bag", TakeBag},
};

}  // namespace

std::span<const FuzzTarget> SequenceTargets() {
  return kTargets;
}

}  // namespace alidade::test
