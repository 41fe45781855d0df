#include "eval/download/download.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "eval/files/hash.h"
#include "tests/eval/download/fault_server.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::FaultServer;
using test::HttpRequest;
using testing::HasSubstr;

/// 300 kB that no shift leaves the same.
std::string Content() {
  std::string content;
  for (unsigned i = 0; content.size() < 300'000; ++i) {
    content += std::to_string(i * 2654435761U) + "\n";
  }
  return content;
}

std::string Whole(const std::string& body) {
  return "HTTP/1.1 200 OK\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

std::string Part(const std::string& body, size_t first) {
  return "HTTP/1.1 206 Partial Content\r\nContent-Length: " + std::to_string(body.size() - first) +
         "\r\nContent-Range: bytes " + std::to_string(first) + "-" + std::to_string(body.size() - 1) + "/" +
         std::to_string(body.size()) + "\r\n\r\n" + body.substr(first);
}

/// As a faultless server answers.
std::string Honest(const std::string& body, const HttpRequest& request) {
  return request.range_first < 0 ? Whole(body) : Part(body, static_cast<size_t>(request.range_first));
}

class DownloadTest : public testing::Test {
 protected:
  void SetUp() override { setenv("no_proxy", "*", 1); }

  [[nodiscard]] DownloadRequest Request(const FaultServer& server) const {
    DownloadRequest request;
    request.url = server.Url("/data/file.bin");
    request.path = path_;
    request.expected = {.bytes = content_.size(), .sha256 = Sha256Hex(content_), .md5 = ""};
    request.attempts = 3;
    request.pause_s = 0;
    return request;
  }

  void ExpectWhole() const {
    EXPECT_TRUE(test::ReadFile(path_) == content_) << "the file differs";
    EXPECT_FALSE(std::filesystem::exists(path_ + ".part"));
  }
  void ExpectNone() const { EXPECT_FALSE(std::filesystem::exists(path_)); }
  [[nodiscard]] size_t PartSize() const { return test::ReadFile(path_ + ".part").size(); }

  const std::string content_ = Content();
  test::TemporaryFolder folder_;
  const std::string path_ = folder_.File("below/file.bin");
};

TEST_F(DownloadTest, GivenAFaultlessServerThenTheFileIsWholeAndNotFetchedTwice) {
  const FaultServer server([&](int, const HttpRequest& request) { return Honest(content_, request); });
  std::uint64_t done = 0, total = 0;
  const Status status = Download(Request(server), [&](std::uint64_t d, std::uint64_t t) {
    done = d;
    total = t;
  });
  ASSERT_TRUE(status.ok()) << status.message();
  ExpectWhole();
  EXPECT_EQ(total, content_.size());
  EXPECT_GT(done, 0U);
  EXPECT_TRUE(Download(Request(server)).ok());
  EXPECT_EQ(server.Requests().size(), 1U);
}

TEST_F(DownloadTest, GivenAConnectionThatDropsInTheMiddleThenItIsContinued) {
  const FaultServer server([&](int number, const HttpRequest& request) {
    const std::string answer = Honest(content_, request);
    return number < 2 ? answer.substr(0, 100'000) : answer;
  });
  const Status status = Download(Request(server));
  ASSERT_TRUE(status.ok()) << status.message();
  ExpectWhole();
  ASSERT_EQ(server.Requests().size(), 3U);
  EXPECT_EQ(server.Requests()[0].range_first, -1);
  EXPECT_GT(server.Requests()[1].range_first, 90'000);
  EXPECT_GT(server.Requests()[2].range_first, server.Requests()[1].range_first);
}

TEST_F(DownloadTest, GivenAServerThatDiesThenThePartStaysAndALaterCallContinuesIt) {
  const FaultServer dying([&](int number, const HttpRequest& request) {
    return number == 0 ? Honest(content_, request).substr(0, 100'000) : std::string();
  });
  const Status status = Download(Request(dying));
  EXPECT_EQ(status.code(), StatusCode::kInput);
  EXPECT_THAT(status.message(), HasSubstr("the same command continues"));
  EXPECT_EQ(dying.Requests().size(), 4U) << "three without a byte after the one with some";
  ExpectNone();
  const size_t kept = PartSize();
  EXPECT_GT(kept, 90'000U);
  EXPECT_TRUE(test::ReadFile(path_ + ".part") == content_.substr(0, kept));

  const FaultServer honest([&](int, const HttpRequest& request) { return Honest(content_, request); });
  ASSERT_TRUE(Download(Request(honest)).ok());
  ExpectWhole();
  EXPECT_EQ(honest.Requests()[0].range_first, static_cast<long>(kept));
}

TEST_F(DownloadTest, GivenAServerWithoutRangesThenTheWholeFileReplacesThePart) {
  folder_.Write("below/file.bin.part", content_.substr(0, 1000));
  const FaultServer server([&](int, const HttpRequest&) { return Whole(content_); });
  const Status status = Download(Request(server));
  ASSERT_TRUE(status.ok()) << status.message();
  ExpectWhole();
  EXPECT_EQ(server.Requests()[0].range_first, 1000);
}

TEST_F(DownloadTest, GivenAServerWithoutRangesThatAlwaysDropsThenItIsGivenUp) {
  const FaultServer server([&](int, const HttpRequest&) { return Whole(content_).substr(0, 100'000); });
  const Status status = Download(Request(server));
  EXPECT_FALSE(status.ok());
  EXPECT_LE(server.Requests().size(), 4U);
  ExpectNone();
}

TEST_F(DownloadTest, GivenAnotherRangeThanRequestedThenItIsReadFromTheBeginning) {
  folder_.Write("below/file.bin.part", content_.substr(0, 1000));
  const FaultServer server([&](int, const HttpRequest& request) {
    return request.range_first < 0 ? Whole(content_) : Part(content_, 500);
  });
  const Status status = Download(Request(server));
  ASSERT_TRUE(status.ok()) << status.message();
  ExpectWhole();
}

TEST_F(DownloadTest, GivenAnotherLengthThanExpectedThenItIsRefusedBeforeAByteIsWritten) {
  const FaultServer server([&](int, const HttpRequest&) { return Whole(content_ + "more"); });
  const Status status = Download(Request(server));
  EXPECT_EQ(status.code(), StatusCode::kInput);
  EXPECT_THAT(status.message(), HasSubstr("size: the server offers " + std::to_string(content_.size() + 4)));
  EXPECT_EQ(server.Requests().size(), 1U);
  ExpectNone();
  EXPECT_FALSE(std::filesystem::exists(path_ + ".part"));
}

TEST_F(DownloadTest, GivenABodyShorterThanItsLengthThenItIsNotTakenForWhole) {
  DownloadRequest request;
  const FaultServer server([&](int, const HttpRequest& asked) {
    return asked.range_first < 0 ? Whole(content_).substr(0, 100'000) : std::string();
  });
  request = Request(server);
  request.expected = {};  // only the server gives its length
  const Status status = Download(request);
  EXPECT_FALSE(status.ok());
  ExpectNone();
}

TEST_F(DownloadTest, GivenABodyWithoutLengthThatEndsEarlyThenTheExpectedSizeRevealsIt) {
  const FaultServer server([&](int, const HttpRequest& asked) {
    return asked.range_first < 0 ? "HTTP/1.0 200 OK\r\n\r\n" + content_.substr(0, 50'000)
                                 : Honest(content_, asked);
  });
  const Status status = Download(Request(server));
  ASSERT_TRUE(status.ok()) << status.message();
  ExpectWhole();
  EXPECT_EQ(server.Requests()[1].range_first, 50'000);
}

TEST_F(DownloadTest, GivenAMissingFileThenItIsSaidOnceAndThePageOfTheErrorIsNotWritten) {
  const FaultServer server([&](int, const HttpRequest&) {
    return std::string("HTTP/1.1 404 Not Found\r\nContent-Length: 9\r\n\r\nnot here\n");
  });
  const Status status = Download(Request(server));
  EXPECT_EQ(status.code(), StatusCode::kInput);
  EXPECT_THAT(status.message(), HasSubstr("the server answers 404"));
  EXPECT_THAT(status.message(), HasSubstr("/data/file.bin"));
  EXPECT_EQ(server.Requests().size(), 1U);
  ExpectNone();
  EXPECT_FALSE(std::filesystem::exists(path_ + ".part"));
}

TEST_F(DownloadTest, GivenAServerThatIsBusyThenItIsAskedAgain) {
  const FaultServer server([&](int number, const HttpRequest& request) {
    return number == 0 ? std::string("HTTP/1.1 503 Service Unavailable\r\nContent-Length: 0\r\n\r\n")
                       : Honest(content_, request);
  });
  ASSERT_TRUE(Download(Request(server)).ok());
  ExpectWhole();
}

TEST_F(DownloadTest, GivenAWrongChecksumThenNothingIsLeft) {
  std::string forged = content_;
  forged[1234] ^= 1;
  const FaultServer server([&](int, const HttpRequest& request) { return Honest(forged, request); });
  const Status status = Download(Request(server));
  EXPECT_EQ(status.code(), StatusCode::kInput);
  EXPECT_THAT(status.message(), HasSubstr("SHA-256: found " + Sha256Hex(forged)));
  ExpectNone();
  EXPECT_FALSE(std::filesystem::exists(path_ + ".part"));
}

TEST_F(DownloadTest, GivenAPartOfAnotherFileThenTheChecksumFindsItAndTheNextCallBeginsAnew) {
  folder_.Write("below/file.bin.part", std::string(1000, 'x'));
  const FaultServer server([&](int, const HttpRequest& request) { return Honest(content_, request); });
  EXPECT_FALSE(Download(Request(server)).ok());
  ExpectNone();
  const Status again = Download(Request(server));
  ASSERT_TRUE(again.ok()) << again.message();
  ExpectWhole();
}

TEST_F(DownloadTest, GivenACompletePartThenItIsCheckedAndNamed) {
  folder_.Write("below/file.bin.part", content_);
  const FaultServer server([&](int, const HttpRequest&) {
    return "HTTP/1.1 416 Range Not Satisfiable\r\nContent-Length: 0\r\nContent-Range: bytes */" +
           std::to_string(content_.size()) + "\r\n\r\n";
  });
  DownloadRequest request = Request(server);
  request.expected.bytes.reset();  // the server must be asked
  const Status status = Download(request);
  ASSERT_TRUE(status.ok()) << status.message();
  ExpectWhole();
  EXPECT_EQ(server.Requests().size(), 1U);
}

TEST_F(DownloadTest, GivenAFileThatIsNotAsExpectedThenItIsLeftAlone) {
  folder_.Write("below/file.bin", "mine");
  const FaultServer server([&](int, const HttpRequest& request) { return Honest(content_, request); });
  const Status status = Download(Request(server));
  EXPECT_THAT(status.message(), HasSubstr("remove it to fetch it again"));
  EXPECT_EQ(test::ReadFile(path_), "mine");
  EXPECT_TRUE(server.Requests().empty());
}

TEST_F(DownloadTest, GivenARedirectionThenItIsFollowed) {
  const FaultServer server([&](int, const HttpRequest& request) {
    return request.path == "/elsewhere"
               ? Honest(content_, request)
               : std::string("HTTP/1.1 302 Found\r\nLocation: /elsewhere\r\nContent-Length: 0\r\n\r\n");
  });
  ASSERT_TRUE(Download(Request(server)).ok());
  ExpectWhole();
}

TEST_F(DownloadTest, GivenAStopThenThePartStays) {
  std::atomic<bool> stop = true;
  const FaultServer server([&](int, const HttpRequest& request) { return Honest(content_, request); });
  EXPECT_FALSE(Download(Request(server), nullptr, &stop).ok());
  ExpectNone();
}

TEST_F(DownloadTest, GivenNoServerOrNoUrlThenTheReasonIsNamed) {
  DownloadRequest request;
  {
    const FaultServer gone([&](int, const HttpRequest&) { return std::string(); });
    request = Request(gone);
  }
  EXPECT_THAT(Download(request).message(), HasSubstr(request.url));
  request.url = "file:///etc/passwd";
  EXPECT_EQ(Download(request).code(), StatusCode::kUsage);
}

TEST_F(DownloadTest, GivenAFolderThatCannotBeMadeThenItIsAnOutputError) {
  folder_.Write("blocked", "a file");
  const FaultServer server([&](int, const HttpRequest& request) { return Honest(content_, request); });
  DownloadRequest request = Request(server);
  request.path = folder_.File("blocked/file.bin");
  EXPECT_EQ(Download(request).code(), StatusCode::kOutput);
}

}  // namespace
}  // namespace alidade
