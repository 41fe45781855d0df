#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/status.h"

namespace alidade {

/// The flags of a driver, `--name=value`, each with a default. A default of "required" has to be given.
class PeerFlags {
 public:
  /// kUsage: an argument that is not `--name=value`, an unknown name (with a suggestion), a required flag
  /// that is missing.
  static Result<PeerFlags> Parse(const std::map<std::string, std::string>& defaults,
                                 const std::vector<std::string>& arguments);

  /// The flag must be one of the defaults.
  [[nodiscard]] const std::string& Text(const std::string& name) const { return values_.at(name); }
  /// A decimal within [min, max]; `value` is untouched when the text is "own": the other system's setting.
  /// kUsage: anything else.
  Status Real(const std::string& name, double min, double max, double* value) const;
  Status Whole(const std::string& name, int min, int max, int* value) const;
  /// True or false of a flag that is one of these two words. kUsage: another word.
  Status OneOf(const std::string& name, const std::string& word_of_true, const std::string& word_of_false,
               bool* value) const;

 private:
  std::map<std::string, std::string> values_;
};

}  // namespace alidade
