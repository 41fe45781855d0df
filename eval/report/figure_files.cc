#include "eval/report/figure_files.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <vector>

#include "eval/files/output_file.h"
#include "eval/report/paper_figures.h"

namespace alidade {
namespace {

constexpr const char* kConverter = "rsvg-convert";

/// Whether a folder of PATH holds the converter.
bool ConverterIsThere() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((std::filesystem::path(folder) / kConverter).c_str(), X_OK) == 0) {
      return true;
    }
  }
  return false;
}

/// Runs the converter without a shell: names need no quoting. Its date is fixed, for equal bytes.
Status Convert(const std::string& svg, const std::string& pdf) {
  std::vector<std::string> words = {kConverter, "--format=pdf", "--output=" + pdf, svg};
  std::vector<std::string> settings = {"SOURCE_DATE_EPOCH=0"};
  for (char** entry = environ; *entry != nullptr; ++entry) {
    if (std::strncmp(*entry, "SOURCE_DATE_EPOCH=", 18) != 0) {
      settings.emplace_back(*entry);
    }
  }
  const auto pointers = [](std::vector<std::string>* texts) {
    std::vector<char*> list;
    for (std::string& text : *texts) {
      list.push_back(text.data());
    }
    list.push_back(nullptr);
    return list;
  };
  pid_t process = 0;
  const int error = posix_spawnp(&process, kConverter, nullptr, nullptr, pointers(&words).data(),
                                 pointers(&settings).data());
  if (error != 0) {
    return Status::Output(std::string(kConverter) + ": " + std::strerror(error));
  }
  int ended = 0;
  while (waitpid(process, &ended, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(ended) && WEXITSTATUS(ended) == 0
             ? Status::Ok()
             : Status::Output(std::string(kConverter) + " could not make " + pdf);
}

}  // namespace

Result<FigureFormats> ParseFigureFormats(const std::string& text) {
  FigureFormats formats;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    if (word != "svg" && word != "pdf") {
      return Status::Usage("--figures: found \"" + word + "\", expected svg, pdf or svg,pdf");
    }
    (word == "svg" ? formats.svg : formats.pdf) = true;
  }
  if (formats.pdf && !ConverterIsThere()) {
    return Status::Usage(
        std::string("--figures: pdf is made by ") + kConverter +
        ", which is not in PATH: install the Debian package librsvg2-bin, or request only svg");
  }
  return formats;
}

Status WriteFigureFiles(const Comparison& comparison, const FigureFormats& formats,
                        const std::string& folder) {
  if (!formats.svg && !formats.pdf) {
    return Status::Ok();
  }
  for (const PaperFigure& figure : DrawPaperFigures(comparison)) {
    const std::string path = folder + "/figures/" + figure.name;
    ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(path + ".svg", figure.svg));
    if (formats.pdf) {
      const std::string unfinished = path + ".pdf.part";
      ALIDADE_RETURN_IF_ERROR(Convert(path + ".svg", unfinished));
      std::error_code error;
      std::filesystem::rename(unfinished, path + ".pdf", error);
      if (error) {
        return Status::Output(path + ".pdf: " + error.message());
      }
    }
    if (!formats.svg) {
      std::error_code ignored;
      std::filesystem::remove(path + ".svg", ignored);
    }
  }
  return Status::Ok();
}

}  // namespace alidade
