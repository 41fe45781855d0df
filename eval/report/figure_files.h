#pragma once

#include <string>

#include "eval/comparison/comparison.h"

namespace alidade {

/// Formats in which `compare` writes figures for papers.
struct FigureFormats {
  bool svg = false;
  bool pdf = false;  ///< made of the SVG by rsvg-convert
};

/// "svg", "pdf" or both, separated by a comma; empty: none. kUsage, before anything runs: another word, or
/// pdf when the program rsvg-convert (Debian package librsvg2-bin) is not found.
Result<FigureFormats> ParseFigureFormats(const std::string& text);

/// Writes the figures of eval/report/paper_figures.h into `folder`/figures. Equal comparisons give equal
/// bytes. kOutput: a file could not be written, or rsvg-convert failed.
Status WriteFigureFiles(const Comparison& comparison, const FigureFormats& formats,
                        const std::string& folder);

}  // namespace alidade
