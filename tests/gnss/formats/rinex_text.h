#pragma once

#include <cstdio>
#include <string>

namespace alidade::test {

/// A RINEX header line: content to column 60, then the label.
inline std::string HeaderLine(std::string content, const std::string& label) {
  content.resize(60, ' ');
  return content + label + "\n";
}

/// Content of a header line of RINEX VERSION / TYPE.
inline std::string VersionLine(const std::string& version, const std::string& type,
                               const std::string& system) {
  std::string content = "     " + version;
  content.resize(20, ' ');
  content += type;
  content.resize(40, ' ');
  return HeaderLine(content + system, "RINEX VERSION / TYPE");
}

/// F14.3 with its two flags; the flags are blank.
inline std::string Value(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%14.3f  ", value);
  return text;
}

/// A number as D19.12 has it.
inline std::string Number19(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%19.12E", value);
  return text;
}

}  // namespace alidade::test
