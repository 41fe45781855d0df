#include "eval/files/strict_yaml.h"

#include <charconv>
#include <cmath>
#include <set>

#include "eval/files/csv.h"
#include "eval/files/input_file.h"
#include "eval/files/yaml_bounds.h"

namespace alidade {
namespace {

Status CheckKeys(const YAML::Node& node, const std::string& where, StatusCode code) {
  if (node.IsSequence()) {
    for (const YAML::Node& entry : node) {
      ALIDADE_RETURN_IF_ERROR(CheckKeys(entry, where, code));
    }
  }
  if (!node.IsMap()) {
    return Status::Ok();
  }
  std::set<std::string> seen;
  for (const auto& entry : node) {
    const YAML::Node& key = entry.first;
    const YAML::Node& value = entry.second;
    if (!key.IsScalar()) {
      return Status(code, YamlPlace(where, key) + ": found a key that is not text, expected a name");
    }
    if (!seen.insert(key.Scalar()).second) {
      return Status(code, YamlPlace(where, key) + ": " + key.Scalar() + ": duplicate key, expected it once");
    }
    ALIDADE_RETURN_IF_ERROR(CheckKeys(value, where, code));
  }
  return Status::Ok();
}

/// An unquoted scalar without a tag of its own.
bool IsPlain(const YAML::Node& node) {
  return node.IsScalar() && (node.Tag() == "?" || node.Tag().empty());
}

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

bool LooksOctal(std::string_view digits) {
  return digits.size() > 1 && digits[0] == '0' && IsDigit(digits[1]);
}

std::string_view WithoutSign(std::string_view text) {
  text.remove_prefix(text.starts_with('+') || text.starts_with('-') ? 1 : 0);
  return text;
}

bool IsNotFiniteWord(std::string_view text) {
  text = WithoutSign(text);
  text.remove_prefix(text.starts_with('.') ? 1 : 0);
  std::string lower;
  for (const char c : text) {
    lower.push_back(c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c);
  }
  return lower == "nan" || lower == "inf" || lower == "infinity";
}

/// Appends the node on one line, as YAML writes lists and groups in brackets, while there is room in `text`.
void AppendOnOneLine(const YAML::Node& node, size_t room, std::string* text) {
  if (!node.IsMap() && !node.IsSequence()) {
    for (const char c : node.IsScalar() ? node.Scalar() : std::string()) {
      text->push_back(static_cast<unsigned char>(c) < ' ' ? ' ' : c);
    }
    return;
  }
  const char* separator = "";
  text->push_back(node.IsMap() ? '{' : '[');
  for (auto entry = node.begin(); entry != node.end() && text->size() <= room; ++entry) {
    *text += separator;
    separator = ", ";
    if (node.IsMap()) {
      AppendOnOneLine(entry->first, room, text);
      *text += ": ";
      AppendOnOneLine(entry->second, room, text);
    } else {
      AppendOnOneLine(*entry, room, text);
    }
  }
  text->push_back(node.IsMap() ? '}' : ']');
}

}  // namespace

Result<YAML::Node> LoadYaml(const std::string& text, const std::string& where, StatusCode code) {
  ALIDADE_RETURN_IF_ERROR(CheckYamlBounds(text, where, code));
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    return Status(code, where + ": is not valid YAML: " + error.msg);
  }
}

Result<YAML::Node> ParseYaml(const std::string& text, const std::string& where, StatusCode code) {
  std::string content = text;
  if (content.starts_with(
          "%YAML:")) {  // OpenCV writes a colon where YAML needs a blank; a comment keeps the line count
    content[0] = '#';
  }
  Result<YAML::Node> root = LoadYaml(content, where, code);
  ALIDADE_RETURN_IF_ERROR(root.status());
  if (root->IsNull()) {
    return Status(code, where + ": is empty, expected keys and values");
  }
  if (!root->IsMap()) {
    return Status(code,
                  YamlPlace(where, *root) + ": found " + YamlText(*root) + ", expected keys and values");
  }
  ALIDADE_RETURN_IF_ERROR(CheckKeys(*root, where, code));
  return root;
}

Result<YAML::Node> ParseYamlFile(const std::string& path, StatusCode code) {
  const Result<std::string> text = ReadWholeFile(path, code, kMaxYamlBytes);
  return text.ok() ? ParseYaml(*text, path, code) : Result<YAML::Node>(text.status());
}

std::string YamlPlace(const std::string& where, const YAML::Node& node) {
  const YAML::Mark mark = node.Mark();
  if (mark.is_null()) {
    return where;
  }
  return where + ":" + std::to_string(mark.line + 1) + ":" + std::to_string(mark.column + 1);
}

std::string YamlText(const YAML::Node& node) {
  if (node.IsScalar()) {
    return Quoted(node.Scalar());
  }
  if (node.IsNull()) {
    return "nothing";
  }
  constexpr size_t kLongest = 40;
  std::string text;
  AppendOnOneLine(node, kLongest, &text);
  if (text.size() > kLongest) {
    text = text.substr(0, kLongest) + "...";
  }
  return (node.IsMap() ? "the group " : "the list ") + text;
}

Status ParseYamlReal(const YAML::Node& node, double* value) {
  if (!IsPlain(node)) {
    return Status::Input("a number");
  }
  const std::string_view text = node.Scalar();
  if (IsNotFiniteWord(text)) {
    return Status::Input("a finite number");
  }
  const std::string_view digits = WithoutSign(text);
  if (LooksOctal(digits)) {
    return Status::Input("a decimal number without leading zeros (YAML would read it as octal)");
  }
  // from_chars takes no plus sign; the sign of "+-1" must not slip through either.
  const std::string_view number = text.starts_with('+') ? digits : text;
  double parsed = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), parsed);
  const bool starts_like_a_number = !digits.empty() && (IsDigit(digits[0]) || digits[0] == '.');
  if (!starts_like_a_number || error != std::errc() || end != number.data() + number.size() ||
      !std::isfinite(parsed)) {
    return Status::Input("a number");
  }
  *value = parsed;
  return Status::Ok();
}

Status ParseYamlInteger(const YAML::Node& node, long long* value) {
  if (!IsPlain(node)) {
    return Status::Input("an integer");
  }
  const std::string_view text = node.Scalar();
  const std::string_view digits = WithoutSign(text);
  if (LooksOctal(digits)) {
    return Status::Input("a decimal integer without leading zeros (YAML would read it as octal)");
  }
  const std::string_view number = text.starts_with('+') ? digits : text;
  long long parsed = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), parsed);
  if (digits.empty() || !IsDigit(digits[0]) || error != std::errc() || end != number.data() + number.size()) {
    return Status::Input("an integer");
  }
  *value = parsed;
  return Status::Ok();
}

Status ParseYamlBoolean(const YAML::Node& node, bool* value) {
  if (IsPlain(node) && (node.Scalar() == "true" || node.Scalar() == "false")) {
    *value = node.Scalar() == "true";
    return Status::Ok();
  }
  return Status::Input("true or false");
}

Status ParseYamlReals(const YAML::Node& node, size_t count, std::vector<double>* values) {
  const std::string expected =
      "a list of " + (count > 0 ? std::to_string(count) + " " : std::string()) + "numbers";
  if (!node.IsSequence()) {
    return Status::Input(expected);
  }
  values->clear();
  for (const YAML::Node& entry : node) {
    double value = 0;
    if (const Status parsed = ParseYamlReal(entry, &value); !parsed.ok()) {
      return Status::Input(expected + "; entry " + std::to_string(values->size() + 1) + " is " +
                           YamlText(entry) + ", not " + parsed.message());
    }
    values->push_back(value);
  }
  if (count > 0 && values->size() != count) {
    return Status::Input(expected + ", not " + std::to_string(values->size()));
  }
  return Status::Ok();
}

}  // namespace alidade
