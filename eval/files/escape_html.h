#pragma once

#include <string>

namespace alidade {

/// The text, escaped for an element or a quoted attribute of HTML or XML.
[[nodiscard]] std::string EscapeHtml(const std::string& text);

}  // namespace alidade
