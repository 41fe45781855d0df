#pragma once

#include <string_view>

namespace alidade {

/// Texts that the build embeds (assets.cmake).
extern const std::string_view kReportHtml;  ///< page template with {{NAME}} places
extern const std::string_view kReportCss;
extern const std::string_view kReportScript;  ///< our scripts, in the order in which they must run
extern const std::string_view kReportD3;      ///< D3 version 3, minified

}  // namespace alidade
