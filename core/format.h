#pragma once

#include <string>

namespace alidade {

/// printf into a string: sentences with rounded figures. The compiler checks the arguments against `format`.
[[nodiscard]] __attribute__((format(printf, 1, 2))) std::string Format(const char* format, ...);

}  // namespace alidade
