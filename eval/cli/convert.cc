#include <cstdio>
#include <filesystem>

#include "core/format.h"
#include "eval/bag_export.h"
#include "eval/bag_folder.h"
#include "eval/cli/command.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"

namespace alidade::cli {
namespace {

int FolderToBag(const BagTopics& topics, BagCompression compression) {
  const Result<Dataset> dataset = ReadDataset(FLAGS_dataset);
  if (!dataset.ok()) {
    return Report(dataset.status());
  }
  if (!FLAGS_overwrite && std::filesystem::exists(FLAGS_output)) {
    return Report(Status::Output(FLAGS_output + ": exists, expected a new file or --overwrite"));
  }
  BagExportOptions options{topics, compression, InstallInterruptHandler(), {}};
  ProgressLine progress("messages");
  options.progress = [&progress](size_t done, size_t total) { progress.Update(done, total); };
  const Status written = WriteBag(*dataset, options, FLAGS_output);
  return options.stop->load() ? kExitInterrupted : Report(written);
}

int BagToFolder(const BagTopics& topics) {
  if (const Status status = PrepareOutputFolder(FLAGS_output, FLAGS_overwrite); !status.ok()) {
    return Report(status);
  }
  BagImportOptions options;
  options.topics = topics;
  options.stop = InstallInterruptHandler();
  ProgressLine progress("messages");
  options.progress = [&progress](std::int64_t done, std::int64_t total) {
    progress.Update(static_cast<size_t>(done), static_cast<size_t>(total));
  };
  const Result<std::vector<std::string>> remarks = ConvertBagToFolder(FLAGS_dataset, options, FLAGS_output);
  if (options.stop->load()) {
    return kExitInterrupted;
  }
  if (!remarks.ok()) {
    return Report(remarks.status());
  }
  for (const std::string& remark : *remarks) {
    Say(remark);
  }
  return kExitDone;
}

}  // namespace

int RunConvert(const std::vector<std::string>&) {
  BagTopics topics;
  if (const Status status = topics.Set(FLAGS_topics); !status.ok()) {
    return Report(Status(status.code(), "convert: " + status.message()));
  }
  const std::optional<BagCompression> compression = ParseBagCompression(FLAGS_compression);
  if (!compression) {
    return Report(Status::Usage("convert: --compression: found '" + FLAGS_compression +
                                "', expected none, bz2 or lz4"));
  }
  if (IsBag(FLAGS_dataset)) {
    return BagToFolder(topics);
  }
  if (!FLAGS_output.ends_with(".bag")) {
    return Report(
        Status::Usage("convert: --output: found '" + FLAGS_output +
                      "', expected a name that ends in .bag (a folder becomes a bag, a bag a folder)"));
  }
  return FolderToBag(topics, *compression);
}

}  // namespace alidade::cli
