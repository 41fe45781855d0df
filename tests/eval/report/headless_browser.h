#pragma once

#include <string>

#include "core/status.h"

namespace alidade::test {

/// A page after its scripts have run, and what the browser's console said.
struct PageVisit {
  std::string dom;
  std::string console;  ///< one line a message; empty without messages of the page

  /// Attribute data-`name` of the root element; empty without it.
  [[nodiscard]] std::string Mark(const std::string& name) const;
};

/// Opens pages in a browser of the Chromium family without a window.
///
/// A page counts as drawn once it has loaded: its scripts must be done by then, and timers are not waited
/// for. Chromium's virtual time would run them, but on a busy machine it has failed to end.
///
/// A browser may hang or crash for reasons that are not the page's. Then, and only then, the page is opened
/// again in a fresh profile, `kAttempts` times in all; what a page shows or logs is never asked for twice.
class HeadlessBrowser {
 public:
  static constexpr const char* kChromium = "/usr/bin/chromium";
  static constexpr int kAttempts = 3;

  explicit HeadlessBrowser(std::string program = kChromium, double seconds_per_attempt = 30);

  /// Visits the file at path `page` with `address` ("#...") appended. Error (kInput): how every attempt
  /// ended, and what the browser wrote; a page that never finishes ends so, too.
  [[nodiscard]] Result<PageVisit> Open(const std::string& page, const std::string& address = "") const;

 private:
  std::string program_;
  double seconds_per_attempt_;
};

}  // namespace alidade::test
