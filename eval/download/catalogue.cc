#include "eval/download/catalogue.h"

#include <algorithm>
#include <functional>
#include <set>

#include "eval/files/strict_yaml.h"
#include "eval/files/suggest.h"

namespace alidade {
namespace {

using YAML::Node;

constexpr std::size_t kSha256Digits = 64, kMd5Digits = 32;

/// Reads one catalogue; every fault names file and position.
class Reader {
 public:
  explicit Reader(std::string path) : path_(std::move(path)) {}

  Result<std::vector<CatalogueDataset>> Read() {
    const Result<Node> root = ParseYamlFile(path_, StatusCode::kConfig);
    ALIDADE_RETURN_IF_ERROR(root.status());
    std::vector<CatalogueDataset> datasets;
    ALIDADE_RETURN_IF_ERROR(Map(*root, {{"datasets", [&](const Node& node) {
                                           return Each(node, [&](const Node& entry) {
                                             return ReadDataset(entry, &datasets.emplace_back());
                                           });
                                         }}}));
    ALIDADE_RETURN_IF_ERROR(CheckDistinct(datasets, *root));
    return datasets;
  }

 private:
  using Read1 = std::function<Status(const Node&)>;

  [[nodiscard]] Status Fault(const Node& node, const std::string& expected) const {
    return Status::Config(YamlPlace(path_, node) + ": found " + YamlText(node) + ", expected " + expected);
  }

  Status Map(const Node& node, const std::vector<std::pair<std::string, Read1>>& keys) const {
    if (!node.IsMap()) {
      return Fault(node, "keys and values");
    }
    std::vector<std::string> names;
    names.reserve(keys.size());
    for (const auto& [name, read] : keys) {
      names.push_back(name);
    }
    for (const auto& entry : node) {
      const std::string& found = entry.first.Scalar();
      const auto at = std::find(names.begin(), names.end(), found);
      if (at == names.end()) {
        return Status::Config(YamlPlace(path_, entry.first) + ": " + found + ": unknown key" +
                              Suggestion(found, names));
      }
      ALIDADE_RETURN_IF_ERROR(keys[static_cast<std::size_t>(at - names.begin())].second(entry.second));
    }
    return Status::Ok();
  }

  Status Each(const Node& node, const Read1& read) const {
    if (!node.IsSequence()) {
      return Fault(node, "a list");
    }
    for (const Node& entry : node) {
      ALIDADE_RETURN_IF_ERROR(read(entry));
    }
    return Status::Ok();
  }

  Read1 Text(std::string* value) const {
    return [this, value](const Node& node) {
      if (!node.IsScalar() || node.Scalar().empty()) {
        return Fault(node, "text");
      }
      *value = node.Scalar();
      return Status::Ok();
    };
  }

  /// A part of a path that stays in its folder.
  Read1 Name(std::string* value) const {
    return [this, value](const Node& node) {
      ALIDADE_RETURN_IF_ERROR(Text(value)(node));
      const auto allowed = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
               c == '-' || c == '.';
      };
      if (value->front() == '.' || !std::all_of(value->begin(), value->end(), allowed)) {
        return Fault(node, "letters, digits, '.', '_' and '-' only, not '.' first");
      }
      return Status::Ok();
    };
  }

  Read1 Digest(std::string* value, std::size_t digits) const {
    return [this, value, digits](const Node& node) {
      ALIDADE_RETURN_IF_ERROR(Text(value)(node));
      const auto hexadecimal = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
      if (value->size() != digits || !std::all_of(value->begin(), value->end(), hexadecimal)) {
        return Fault(node, std::to_string(digits) + " lower-case hexadecimal digits");
      }
      return Status::Ok();
    };
  }

  Read1 Bytes(std::optional<std::uint64_t>* value) const {
    return [this, value](const Node& node) {
      long long bytes = 0;
      const Status parsed = ParseYamlInteger(node, &bytes);
      if (!parsed.ok() || bytes <= 0) {
        return Fault(node, "a whole number of bytes above 0");
      }
      *value = static_cast<std::uint64_t>(bytes);
      return Status::Ok();
    };
  }

  Status ReadFile(const Node& node, CatalogueFile* file) const {
    ALIDADE_RETURN_IF_ERROR(Map(node, {{"name", Name(&file->name)},
                                       {"file", Name(&file->file)},
                                       {"path", Text(&file->path)},
                                       {"bytes", Bytes(&file->expected.bytes)},
                                       {"sha256", Digest(&file->expected.sha256, kSha256Digits)},
                                       {"md5", Digest(&file->expected.md5, kMd5Digits)},
                                       {"size", Text(&file->size)},
                                       {"contents", Text(&file->contents)}}));
    return file->name.empty() || file->path.empty() || file->file.empty()
               ? Status::Config(YamlPlace(path_, node) + ": expected name, file and path")
               : Status::Ok();
  }

  Status ReadDataset(const Node& node, CatalogueDataset* dataset) const {
    const auto files = [&](const Node& list) {
      return Each(list, [&](const Node& entry) { return ReadFile(entry, &dataset->files.emplace_back()); });
    };
    ALIDADE_RETURN_IF_ERROR(Map(node, {{"name", Name(&dataset->name)},
                                       {"title", Text(&dataset->title)},
                                       {"page", Text(&dataset->page)},
                                       {"licence", Text(&dataset->licence)},
                                       {"size", Text(&dataset->size)},
                                       {"convert", Text(&dataset->convert)},
                                       {"base", Text(&dataset->base)},
                                       {"files", files}}));
    if (dataset->name.empty() || dataset->title.empty() || dataset->page.empty()) {
      return Status::Config(YamlPlace(path_, node) + ": expected name, title and page");
    }
    const bool is_url = dataset->base.starts_with("http://") || dataset->base.starts_with("https://");
    if (!dataset->files.empty() && !is_url) {
      return Status::Config(YamlPlace(path_, node) +
                            ": base: expected a URL that begins with http:// or https://, for its files");
    }
    return CheckDistinct(dataset->files, node);
  }

  template <typename Entry>
  Status CheckDistinct(const std::vector<Entry>& entries, const Node& node) const {
    std::set<std::string> names;
    for (const Entry& entry : entries) {
      if (!names.insert(entry.name).second) {
        return Status::Config(YamlPlace(path_, node) + ": name: '" + entry.name +
                              "' is used twice, expected once");
      }
    }
    return Status::Ok();
  }

  std::string path_;
};

template <typename Entry>
const Entry* Find(const std::vector<Entry>& entries, const std::string& name,
                  std::vector<std::string>* names) {
  for (const Entry& entry : entries) {
    if (entry.name == name) {
      return &entry;
    }
    names->push_back(entry.name);
  }
  return nullptr;
}

}  // namespace

Result<std::vector<CatalogueDataset>> ReadCatalogue(const std::string& path) {
  return Reader(path).Read();
}

Result<CatalogueChoice> ChooseFiles(const std::vector<CatalogueDataset>& catalogue, const std::string& name) {
  const std::size_t slash = name.find('/');
  std::vector<std::string> names;
  CatalogueChoice choice;
  choice.dataset = Find(catalogue, name.substr(0, slash), &names);
  if (choice.dataset == nullptr) {
    return Status::Usage("unknown data set '" + name.substr(0, slash) + "'" +
                         Suggestion(name.substr(0, slash), names) + " (alidade data list names them)");
  }
  if (slash == std::string::npos) {
    for (const CatalogueFile& file : choice.dataset->files) {
      choice.files.push_back(&file);
    }
    return choice;
  }
  const std::string wanted = name.substr(slash + 1);
  names.clear();
  const CatalogueFile* file = Find(choice.dataset->files, wanted, &names);
  if (file == nullptr) {
    return Status::Usage("unknown file '" + wanted + "' of " + choice.dataset->name +
                         Suggestion(wanted, names) + " (alidade data list " + choice.dataset->name +
                         " names them)");
  }
  choice.files.push_back(file);
  return choice;
}

}  // namespace alidade
