#include "tests/eval/report/headless_browser.h"

#include <sys/wait.h>

#include <cstdlib>
#include <iostream>
#include <regex>
#include <sstream>

#include "core/format.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

// No window, no sandbox (tests run as root in containers), and nothing at work but the page: no GPU, no
// extensions, no updates, no crash reporter, no network of the browser's own. A page may look into its
// frames.
constexpr const char* kFlags =
    "--headless=new --no-sandbox --disable-gpu --disable-dev-shm-usage --no-first-run "
    "--no-default-browser-check"
    " --disable-extensions --disable-default-apps --disable-component-update --disable-background-networking"
    " --disable-sync --disable-breakpad --disable-crash-reporter --metrics-recording-only "
    "--password-store=basic"
    " --disable-features=MediaRouter,DialMediaRouteProvider,OptimizationHints,Translate"
    " --hide-scrollbars --allow-file-access-from-files --enable-logging=stderr --v=0 --dump-dom";

constexpr int kTimedOut = 124;  // exit code of timeout(1)

/// One run of the browser.
struct Attempt {
  std::string failure;  ///< how the process ended; empty when well
  std::string out;
  std::string log;
};

Attempt Run(const std::string& program, double seconds, const std::string& url) {
  const TemporaryFolder folder;
  // Output goes to files: a pipe would stay open as long as any child of a hung browser lives.
  const std::string command =
      Format("timeout --kill-after=5 %g '%s' %s --user-data-dir='%s' '%s' >'%s' 2>'%s' </dev/null", seconds,
             program.c_str(), kFlags, folder.File("profile").c_str(), url.c_str(), folder.File("out").c_str(),
             folder.File("log").c_str());
  const int status = std::system(command.c_str());
  Attempt attempt{"", ReadFile(folder.File("out")), ReadFile(folder.File("log"))};
  if (WIFEXITED(status) && WEXITSTATUS(status) == kTimedOut) {
    attempt.failure = Format("hung for %g s", seconds);
  } else if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    attempt.failure = Format("ended with wait status %#x", static_cast<unsigned>(status));
  }
  return attempt;
}

}  // namespace

std::string PageVisit::Mark(const std::string& name) const {
  std::smatch match;
  const std::string head = dom.substr(0, dom.find("<head"));
  return std::regex_search(head, match, std::regex("data-" + name + "=\"([^\"]*)\"")) ? match[1].str() : "";
}

HeadlessBrowser::HeadlessBrowser(std::string program, double seconds_per_attempt)
    : program_(std::move(program)), seconds_per_attempt_(seconds_per_attempt) {}

Result<PageVisit> HeadlessBrowser::Open(const std::string& page, const std::string& address) const {
  std::string failures;
  for (int i = 1; i <= kAttempts; ++i) {
    const Attempt attempt = Run(program_, seconds_per_attempt_, "file://" + page + address);
    if (!attempt.failure.empty()) {
      const std::string failure =
          Format("%s, attempt %d of %d: %s", program_.c_str(), i, kAttempts, attempt.failure.c_str());
      std::cout << failure << std::endl;  // a browser that needs a second attempt should not go unseen
      failures += failure + "; it wrote:\n" + attempt.log;
      continue;
    }
    PageVisit visit;
    visit.dom = attempt.out;
    std::istringstream lines(attempt.log);
    for (std::string line; std::getline(lines, line);) {
      visit.console += line.find("CONSOLE") != std::string::npos ? line + "\n" : "";
    }
    return visit;
  }
  return Status::Input(failures);
}

}  // namespace alidade::test
