#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace alidade::test {

/// What a request asked for.
struct HttpRequest {
  std::string path;
  long range_first = -1;  ///< of "Range: bytes=N-"; -1: none
};

/// An HTTP server on a port of this machine that answers each request as prescribed, byte for byte, and
/// closes the connection.
class FaultServer {
 public:
  /// `answer`: the whole response, head and body, to request number 0, 1, ...
  explicit FaultServer(std::function<std::string(int, const HttpRequest&)> answer)
      : answer_(std::move(answer)), socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    const bool up = bind(socket_, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                    listen(socket_, 16) == 0 &&
                    getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) == 0;
    port_ = up ? ntohs(address.sin_port) : 0;
    thread_ = std::thread([this] { Serve(); });
  }
  ~FaultServer() {
    shutdown(socket_, SHUT_RDWR);
    thread_.join();
    close(socket_);
  }
  FaultServer(const FaultServer&) = delete;
  FaultServer& operator=(const FaultServer&) = delete;

  [[nodiscard]] std::string Url(const std::string& path) const {
    return "http://127.0.0.1:" + std::to_string(port_) + path;
  }
  [[nodiscard]] std::vector<HttpRequest> Requests() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return requests_;
  }

 private:
  void Serve() {
    for (;;) {
      const int connection = accept(socket_, nullptr, nullptr);
      if (connection < 0) {
        return;
      }
      std::string head;
      char piece[4096];
      while (head.find("\r\n\r\n") == std::string::npos) {
        const ssize_t got = recv(connection, piece, sizeof piece, 0);
        if (got <= 0) {
          break;
        }
        head.append(piece, static_cast<size_t>(got));
      }
      const int number = Note(head);
      const std::string response = answer_(number, Requests().back());
      for (size_t sent = 0; sent < response.size();) {
        const ssize_t now = send(connection, response.data() + sent, response.size() - sent, MSG_NOSIGNAL);
        if (now <= 0) {
          break;
        }
        sent += static_cast<size_t>(now);
      }
      shutdown(connection, SHUT_WR);
      while (recv(connection, piece, sizeof piece, 0) > 0) {  // until the client has read all
      }
      close(connection);
    }
  }

  /// Number of the request.
  int Note(const std::string& head) {
    HttpRequest request;
    const size_t begin = head.find(' ') + 1;
    request.path = head.substr(begin, head.find(' ', begin) - begin);
    const size_t range = head.find("Range: bytes=");
    if (range != std::string::npos) {
      request.range_first = std::stol(head.substr(range + 13));
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    requests_.push_back(request);
    return static_cast<int>(requests_.size()) - 1;
  }

  std::function<std::string(int, const HttpRequest&)> answer_;
  int socket_;
  int port_ = 0;
  mutable std::mutex mutex_;
  std::vector<HttpRequest> requests_;
  std::thread thread_;
};

}  // namespace alidade::test
