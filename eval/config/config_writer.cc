#include "eval/config/config_writer.h"

#include <algorithm>

#include "eval/files/output_file.h"

namespace alidade {
namespace {

/// Text as a YAML scalar: plain when nobody could read it as anything else, otherwise in double quotes.
std::string YamlScalar(const std::string& text) {
  const auto is_safe = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '/' || c == '.' || c == '-';
  };
  const bool starts_with_letter =
      !text.empty() && ((text[0] >= 'a' && text[0] <= 'z') || (text[0] >= 'A' && text[0] <= 'Z'));
  const bool is_word =
      text == "null" || text == "Null" || text == "NULL" || text == "true" || text == "false";
  if (starts_with_letter && !is_word && std::all_of(text.begin(), text.end(), is_safe)) {
    return text;
  }
  std::string quoted = "\"";
  constexpr char kHex[] = "0123456789abcdef";
  for (const char c : text) {
    const unsigned char byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (byte < 0x20) {
      quoted += {'\\', 'x', kHex[byte >> 4], kHex[byte & 15]};
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

/// Prints every described key, two blanks a level.
class YamlWriter final : public ConfigVisitor {
 public:
  explicit YamlWriter(bool with_docs) : with_docs_(with_docs) {}

  [[nodiscard]] const std::string& text() const { return text_; }

  void Section(std::string_view name, std::string_view reason, const std::function<void()>& keys) override {
    if (with_docs_) {
      text_ += "\n" + indent_ + "# " + std::string(reason) + "\n";
    }
    text_ += indent_ + std::string(name) + ":\n";
    indent_ += "  ";
    keys();
    indent_.resize(indent_.size() - 2);
  }
  void Real(const KeyDoc& doc, double* value, double min, double max) override {
    Line(doc, ShortestDouble(*value), Range(ShortestDouble(min), ShortestDouble(max)));
  }
  void Integer(const KeyDoc& doc, int* value, int min, int max) override {
    Line(doc, std::to_string(*value), Range(std::to_string(min), std::to_string(max)));
  }
  void Boolean(const KeyDoc& doc, bool* value) override {
    Line(doc, *value ? "true" : "false", "true | false");
  }
  void Text(const KeyDoc& doc, std::string* value) override { Line(doc, YamlScalar(*value), "text"); }
  void Vector3(const KeyDoc& doc, Eigen::Vector3d* value, double min, double max) override {
    const std::string xy = ShortestDouble(value->x()) + ", " + ShortestDouble(value->y());
    Line(doc, Range(xy, ShortestDouble(value->z())),
         "each " + Range(ShortestDouble(min), ShortestDouble(max)));
  }
  void Choice(const KeyDoc& doc, const std::vector<std::string_view>& options, int* index) override {
    std::string range;
    for (const std::string_view option : options) {
      range += (range.empty() ? "" : " | ") + std::string(option);
    }
    Line(doc, std::string(options[static_cast<size_t>(*index)]), range);
  }

 private:
  static std::string Range(const std::string& min, const std::string& max) {
    return "[" + min + ", " + max + "]";
  }

  void Line(const KeyDoc& doc, const std::string& value, const std::string& range) {
    text_ += indent_ + std::string(doc.name) + ": " + value;
    if (with_docs_) {
      text_ += "  # " + std::string(doc.unit) + ", " + range + "; " + std::string(doc.reason);
    }
    text_ += "\n";
  }

  bool with_docs_;
  std::string indent_;
  std::string text_;
};

}  // namespace

std::string ConfigToYaml(const std::function<void(ConfigVisitor&)>& describe, bool with_docs) {
  YamlWriter writer(with_docs);
  describe(writer);
  return writer.text();
}

}  // namespace alidade
