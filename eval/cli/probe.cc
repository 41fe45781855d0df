#include "eval/probe/probe.h"

#include <cstdio>
#include <iostream>
#include <iterator>

#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/files/input_file.h"
#include "eval/files/suggest.h"

namespace alidade::cli {

int RunProbe(const std::vector<std::string>&) {
  const std::optional<ErrorConvention> convention = ParseErrorConvention(FLAGS_error);
  if (!convention) {
    std::vector<std::string> names;
    names.reserve(kErrorConventions.size());
    for (const ErrorConvention known : kErrorConventions) {
      names.emplace_back(ToString(known));
    }
    return Report(Status::Usage("probe: --error: found '" + FLAGS_error + "', expected " +
                                ErrorConventionNames(", ") + Suggestion(FLAGS_error, names)));
  }
  Result<std::string> input = std::string();
  if (FLAGS_input == "-") {
    input = std::string(std::istreambuf_iterator<char>(std::cin), {});
  } else {
    input = ReadWholeFile(FLAGS_input);
  }
  if (!input.ok()) {
    return Report(input.status());
  }
  const Result<std::string> answer = Probe(FLAGS_model, *input, *convention);
  if (!answer.ok()) {
    const bool about_file = answer.code() == StatusCode::kInput;
    return Report(Status(answer.code(), (about_file ? FLAGS_input : "probe") + ": " + answer.message()));
  }
  std::fputs(answer->c_str(), stdout);
  return kExitDone;
}

}  // namespace alidade::cli
