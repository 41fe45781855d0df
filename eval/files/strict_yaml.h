#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <string_view>
#include <vector>

#include "core/status.h"

namespace alidade {

/// The only call of yaml-cpp's loader: text of at most one document, within CheckYamlBounds. Errors (`code`):
/// "where:line:column: ...".
Result<YAML::Node> LoadYaml(const std::string& text, const std::string& where, StatusCode code);
/// Parses text of one YAML document (OpenCV's first line "%YAML:1.0" is tolerated) and rejects input that
/// yaml-cpp accepts: duplicate keys, keys that are not scalars, several documents. Errors (`code`):
/// "where:line:column: ...".
Result<YAML::Node> ParseYaml(const std::string& text, const std::string& where, StatusCode code);
/// ParseYaml of a file's content.
Result<YAML::Node> ParseYamlFile(const std::string& path, StatusCode code);

/// "where:line:column" of a node, or `where` alone when the position of the node is unknown.
[[nodiscard]] std::string YamlPlace(const std::string& where, const YAML::Node& node);
/// What the node holds, shortened: a scalar in quotes, "the list [1, 2, 3]", "the group {window: 3}" or
/// "nothing".
[[nodiscard]] std::string YamlText(const YAML::Node& node);

/// Strict scalars. Each reads an unquoted decimal number (no octal-looking leading zero, no hexadecimal, no
/// .nan or .inf) or true/false; the Status's message contains only the expectation; the caller adds place and
/// key.
Status ParseYamlReal(const YAML::Node& node, double* value);
Status ParseYamlInteger(const YAML::Node& node, long long* value);
Status ParseYamlBoolean(const YAML::Node& node, bool* value);
/// A sequence of reals; `count` of them unless it is 0.
Status ParseYamlReals(const YAML::Node& node, size_t count, std::vector<double>* values);

}  // namespace alidade
