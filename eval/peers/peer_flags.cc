#include "eval/peers/peer_flags.h"

#include <charconv>
#include <cmath>

#include "core/format.h"
#include "eval/files/suggest.h"

namespace alidade {
namespace {

constexpr char kRequired[] = "required";
constexpr char kOwn[] = "own";

}  // namespace

Result<PeerFlags> PeerFlags::Parse(const std::map<std::string, std::string>& defaults,
                                   const std::vector<std::string>& arguments) {
  PeerFlags flags;
  flags.values_ = defaults;
  std::vector<std::string> names;
  names.reserve(defaults.size());
  for (const auto& [name, value] : defaults) {
    names.push_back(name);
  }
  for (const std::string& argument : arguments) {
    const size_t equals = argument.find('=');
    if (!argument.starts_with("--") || equals == std::string::npos) {
      return Status::Usage("found '" + argument + "', expected --name=value");
    }
    const std::string name = argument.substr(2, equals - 2);
    if (!defaults.contains(name)) {
      return Status::Usage("--" + name + ": no such flag" + Suggestion(name, names));
    }
    flags.values_[name] = argument.substr(equals + 1);
  }
  for (const auto& [name, value] : flags.values_) {
    if (value == kRequired) {
      return Status::Usage("--" + name + ": missing");
    }
  }
  return flags;
}

Status PeerFlags::Real(const std::string& name, double min, double max, double* value) const {
  const std::string& text = Text(name);
  if (text == kOwn) {
    return Status::Ok();
  }
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !(number >= min && number <= max)) {
    return Status::Usage("--" + name + ": found '" + text +
                         Format("', expected a number from %g to %g", min, max));
  }
  *value = number;
  return Status::Ok();
}

Status PeerFlags::Whole(const std::string& name, int min, int max, int* value) const {
  double number = *value;
  ALIDADE_RETURN_IF_ERROR(Real(name, min, max, &number));
  if (number != std::floor(number)) {
    return Status::Usage("--" + name + ": found '" + Text(name) + "', expected a whole number");
  }
  *value = static_cast<int>(number);
  return Status::Ok();
}

Status PeerFlags::OneOf(const std::string& name, const std::string& word_of_true,
                        const std::string& word_of_false, bool* value) const {
  *value = Text(name) == word_of_true;
  return *value || Text(name) == word_of_false
             ? Status::Ok()
             : Status::Usage("--" + name + ": found '" + Text(name) + "', expected " + word_of_true + " or " +
                             word_of_false);
}

}  // namespace alidade
