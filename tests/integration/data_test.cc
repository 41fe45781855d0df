#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "eval/files/hash.h"
#include "tests/eval/download/fault_server.h"
#include "tests/integration/command.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

class DataCommand : public testing::Test {
 protected:
  void SetUp() override { setenv("no_proxy", "*", 1); }

  /// A catalogue of one file, published where nothing is.
  [[nodiscard]] std::string Catalogue() const {
    return folder_.Write("catalogue.yaml",
                         "datasets:\n  - name: walk\n    title: a walk\n    page: https://example.org/walk\n"
                         "    licence: CC BY 4.0\n    base: http://127.0.0.1:9/none/\n    files:\n"
                         "      - {name: one, file: one.bag, path: a/one.bag, bytes: " +
                             std::to_string(content_.size()) + ", sha256: " + Sha256Hex(content_) + "}\n");
  }
  [[nodiscard]] CommandResult Data(const std::string& words) const {
    return Alidade("data " + words + " --catalogue=" + Catalogue());
  }
  [[nodiscard]] std::string Answer(const std::string& body) const {
    return "HTTP/1.1 200 OK\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
  }

  const TemporaryFolder folder_;
  const std::string content_ = std::string(50'000, 'd');
};

TEST_F(DataCommand, FetchesFromAMirrorAndVerifies) {
  const FaultServer server([this](int, const HttpRequest&) { return Answer(content_); });
  const std::string out = folder_.File("out");
  const CommandResult fetched = Data("fetch walk/one --output=" + out + " --mirror=" + server.Url("/mirror"));
  EXPECT_EQ(fetched.code, 0) << fetched.output;
  EXPECT_THAT(fetched.output, HasSubstr("licence CC BY 4.0"));
  ASSERT_EQ(server.Requests().size(), 1U);
  EXPECT_EQ(server.Requests()[0].path, "/mirror/a/one.bag");
  EXPECT_TRUE(ReadFile(out + "/walk/one.bag") == content_);
  const CommandResult verified = Data("verify walk --data=" + out);
  EXPECT_EQ(verified.code, 0) << verified.output;
  EXPECT_THAT(verified.output, HasSubstr("ok (size, SHA-256)"));

  folder_.Write("out/walk/one.bag", std::string(50'000, 'e'));
  const CommandResult spoilt = Data("verify walk --data=" + out);
  EXPECT_EQ(spoilt.code, 4) << spoilt.output;
  EXPECT_THAT(spoilt.output, HasSubstr("SHA-256: found"));
}

TEST_F(DataCommand, RefusesWhatIsNotAsPublished) {
  const FaultServer server(
      [this](int, const HttpRequest&) { return Answer(std::string(content_.size(), 'x')); });
  const std::string out = folder_.File("out");
  const CommandResult fetched = Data("fetch walk --output=" + out + " --mirror=" + server.Url("/"));
  EXPECT_EQ(fetched.code, 4) << fetched.output;
  EXPECT_THAT(fetched.output, HasSubstr("not what is expected"));
  EXPECT_TRUE(std::filesystem::is_empty(out + "/walk"));
}

TEST_F(DataCommand, ListsTheShippedSetsAndTheFilesOfOne) {
  const CommandResult all = Alidade("data list");
  EXPECT_EQ(all.code, 0) << all.output;
  for (const char* name : {"euroc", "tumvi", "gvins", "tartanair", "CC BY-NC-SA 4.0"}) {
    EXPECT_THAT(all.output, HasSubstr(name));
  }
  const CommandResult one = Alidade("data list tumvi");
  EXPECT_THAT(one.output, HasSubstr("1707110400 bytes"));
  EXPECT_THAT(one.output, HasSubstr("checked by: size"));
  EXPECT_THAT(Alidade("data list gvins").output, HasSubstr("by hand"));
}

}  // namespace
}  // namespace alidade::test
