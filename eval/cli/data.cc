#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "core/format.h"
#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/shipped_configs.h"
#include "eval/cli/support.h"
#include "eval/download/catalogue.h"
#include "eval/download/download.h"

namespace alidade::cli {
namespace {

Result<std::vector<CatalogueDataset>> LoadCatalogue() {
  if (!FLAGS_catalogue.empty()) {
    return ReadCatalogue(FLAGS_catalogue);
  }
  const Result<std::string> configs = ShippedConfigsFolder();
  ALIDADE_RETURN_IF_ERROR(configs.status());
  return ReadCatalogue(*configs + "/data/catalogue.yaml");
}

std::string OrDash(const std::string& text) {
  return text.empty() ? "-" : text;
}

std::string SizeText(const CatalogueFile& file) {
  return file.expected.bytes ? std::to_string(*file.expected.bytes) + " bytes" : OrDash(file.size);
}

std::string ChecksText(const ExpectedFile& expected) {
  std::string text = expected.bytes ? "size" : "";
  for (const auto& [name, digest] : {std::pair("SHA-256", expected.sha256), std::pair("MD5", expected.md5)}) {
    text += digest.empty() ? "" : (text.empty() ? "" : ", ") + std::string(name);
  }
  return OrDash(text);
}

void PrintAll(const std::vector<CatalogueDataset>& catalogue) {
  std::printf("%-11s %7s  %-40s %s\n", "name", "files", "licence", "published at");
  for (const CatalogueDataset& dataset : catalogue) {
    std::printf("%-11s %7zu  %-40s %s\n", dataset.name.c_str(), dataset.files.size(),
                OrDash(dataset.licence).c_str(), dataset.page.c_str());
  }
}

void PrintOne(const CatalogueChoice& choice) {
  const CatalogueDataset& dataset = *choice.dataset;
  std::printf("%s: %s\n  published at  %s\n  licence       %s\n", dataset.name.c_str(), dataset.title.c_str(),
              dataset.page.c_str(), OrDash(dataset.licence).c_str());
  if (!dataset.size.empty()) {
    std::printf("  size          %s\n", dataset.size.c_str());
  }
  if (!dataset.convert.empty()) {
    std::printf("  how to read   %s\n", dataset.convert.c_str());
  }
  if (choice.files.empty()) {
    std::printf("  files         to be downloaded by hand from the page above\n");
  }
  for (const CatalogueFile* file : choice.files) {
    std::printf("  %-24s %-20s checked by: %s%s\n", file->name.c_str(), SizeText(*file).c_str(),
                ChecksText(file->expected).c_str(),
                file->contents.empty() ? "" : ("; " + file->contents).c_str());
  }
}

std::string WithSlash(const std::string& base) {
  return base.ends_with('/') ? base : base + "/";
}

Status Fetch(const CatalogueChoice& choice, const std::string& folder) {
  const CatalogueDataset& dataset = *choice.dataset;
  if (choice.files.empty()) {
    return Status::Usage(dataset.name + ": cannot be fetched directly; download it by hand from " +
                         dataset.page);
  }
  if (!dataset.licence.empty()) {
    PrintNote(dataset.name + ": licence " + dataset.licence + " (" + dataset.page + ")");
  }
  const std::string base = FLAGS_mirror.empty() ? dataset.base : FLAGS_mirror;
  const std::atomic<bool>* stop = InstallInterruptHandler();
  for (const CatalogueFile* file : choice.files) {
    DownloadRequest request;
    request.url = WithSlash(base) + file->path;
    request.path = (std::filesystem::path(folder) / dataset.name / file->file).string();
    request.expected = file->expected;
    PrintNote(request.url);
    ProgressLine line(file->file);
    ALIDADE_RETURN_IF_ERROR(Download(
        request,
        [&line](std::uint64_t done, std::uint64_t total) {
          if (total > 0) {
            line.Update(done, total);
          }
        },
        stop));
    std::printf("%s%s\n", request.path.c_str(),
                file->expected.States() ? "" : ": no size or checksum is known");
  }
  return Status::Ok();
}

Status Verify(const CatalogueChoice& choice, const std::string& folder) {
  const CatalogueDataset& dataset = *choice.dataset;
  if (choice.files.empty()) {
    return Status::Usage(dataset.name + ": the catalogue lists no files");
  }
  std::size_t faults = 0;
  for (const CatalogueFile* file : choice.files) {
    const std::filesystem::path path = std::filesystem::path(folder) / dataset.name / file->file;
    const Status checked = CheckFile(path.string(), file->expected);
    faults += checked.ok() ? 0 : 1;
    const std::string verdict =
        checked.ok() ? path.string() + (file->expected.States() ? ": ok (" + ChecksText(file->expected) + ")"
                                                                : ": present; no size or checksum is known")
                     : checked.message();
    std::printf("%s\n", verdict.c_str());
  }
  return faults == 0 ? Status::Ok()
                     : Status::Input(Format("%zu of %zu files of ", faults, choice.files.size()) +
                                     dataset.name + " are missing or not as published");
}

Status RunAction(const std::vector<std::string>& words) {
  const std::string action = words.empty() ? "" : words[0];
  const bool known = action == "list" || action == "fetch" || action == "verify";
  if (!known || (action != "list" && words.size() != 2)) {
    return Status::Usage("data: expected list [NAME], fetch NAME --output=DIR or verify NAME --data=DIR");
  }
  const Result<std::vector<CatalogueDataset>> catalogue = LoadCatalogue();
  ALIDADE_RETURN_IF_ERROR(catalogue.status());
  if (words.size() == 1) {
    PrintAll(*catalogue);
    return Status::Ok();
  }
  const Result<CatalogueChoice> choice = ChooseFiles(*catalogue, words[1]);
  ALIDADE_RETURN_IF_ERROR(choice.status());
  if (action == "list") {
    PrintOne(*choice);
    return Status::Ok();
  }
  if (action == "fetch") {
    ALIDADE_RETURN_IF_ERROR(RequireFlag("data", "output", FLAGS_output));
    return Fetch(*choice, FLAGS_output);
  }
  ALIDADE_RETURN_IF_ERROR(RequireFlag("data", "data", FLAGS_data));
  return Verify(*choice, FLAGS_data);
}

}  // namespace

int RunData(const std::vector<std::string>& words) {
  const Status status = RunAction(words);
  const int code = Report(status);
  return !status.ok() && InstallInterruptHandler()->load() ? kExitInterrupted : code;
}

}  // namespace alidade::cli
