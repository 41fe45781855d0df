#pragma once

#include <span>
#include <string>
#include <string_view>

namespace alidade::test {

/// A part of the program that must bear any bytes: it takes them or refuses them with a message. Its other
/// properties are checked by Require, which ends the program.
struct FuzzTarget {
  const char* name;
  void (*take)(std::string_view bytes);
};

[[nodiscard]] std::span<const FuzzTarget> ReaderTargets();    ///< one text or file
[[nodiscard]] std::span<const FuzzTarget> SequenceTargets();  ///< a file of a sequence, a bag
[[nodiscard]] std::span<const FuzzTarget> SessionTargets();   ///< messages of a session

/// The target of this name, or null.
[[nodiscard]] const FuzzTarget* FindFuzzTarget(std::string_view name);

/// Aborts with the text where a property does not hold.
void Require(bool kept, const std::string& property);

}  // namespace alidade::test
