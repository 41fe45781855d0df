#include "eval/dataset/stale_parts.h"

#include <charconv>
#include <filesystem>

namespace alidade {
namespace {

namespace fs = std::filesystem;

Status Removed(const fs::path& path, const std::error_code& error) {
  return error ? Status::Output(path.string() + ": cannot be removed: " + error.message() +
                                ", but it belongs to the sequence that is overwritten")
               : Status::Ok();
}

}  // namespace

bool IsItsOwnFolder(const Dataset& dataset, const std::string& mav) {
  std::error_code error;
  return !dataset.path.empty() && fs::equivalent(fs::path(dataset.path) / "mav0", mav, error) && !error;
}

Status RemoveStaleFiles(const std::string& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    const fs::path path = fs::path(folder) / name;
    std::error_code error;
    fs::remove(path, error);
    ALIDADE_RETURN_IF_ERROR(Removed(path, error));
  }
  return Status::Ok();
}

Status RemoveStaleFolder(const std::string& folder) {
  std::error_code error;
  fs::remove_all(folder, error);
  return Removed(folder, error);
}

std::vector<std::string> NumberedFolders(const std::string& mav, const std::string& stem, std::size_t first) {
  std::vector<std::string> folders;
  std::error_code ignored;
  for (fs::directory_iterator it(mav, ignored), end; !ignored && it != end; it.increment(ignored)) {
    const std::string name = it->path().filename().string();
    std::size_t number = 0;
    const char* last = name.data() + name.size();
    if (name.starts_with(stem) && name.size() > stem.size()) {
      const auto [stop, error] = std::from_chars(name.data() + stem.size(), last, number);
      if (error == std::errc() && stop == last && number >= first) {
        folders.push_back(it->path().string());
      }
    }
  }
  return folders;
}

}  // namespace alidade
