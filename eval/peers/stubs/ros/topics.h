// In place of ROS: messages between the nodes of one program, one by one in the order in which they
// are published. Topics are known by the last part of their names.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace ros {

class Topics {
 public:
  using Callback = std::function<void(const std::shared_ptr<const void>&)>;

  static Topics& Instance() {
    static Topics topics;
    return topics;
  }
  void Subscribe(const std::string& topic, Callback callback) {
    callbacks_[Last(topic)] = std::move(callback);
  }
  void Publish(const std::string& topic, std::shared_ptr<const void> message) {
    if (callbacks_.count(Last(topic)) != 0) {
      waiting_.emplace_back(Last(topic), std::move(message));
    }
  }
  /// Calls back for the oldest message; false: there is none.
  bool DeliverOne() {
    if (waiting_.empty()) {
      return false;
    }
    const auto [topic, message] = waiting_.front();
    waiting_.pop_front();
    callbacks_.at(topic)(message);
    return true;
  }

 private:
  static std::string Last(const std::string& topic) { return topic.substr(topic.rfind('/') + 1); }

  std::map<std::string, Callback> callbacks_;
  std::deque<std::pair<std::string, std::shared_ptr<const void>>> waiting_;
};

/// Texts that nodes are started with.
inline std::map<std::string, std::string>& Parameters() {
  static std::map<std::string, std::string> parameters;
  return parameters;
}

struct Subscriber {};

class Publisher {
 public:
  Publisher() = default;
  explicit Publisher(std::string topic) : topic_(std::move(topic)) {}
  template <typename Message>
  void publish(const std::shared_ptr<Message>& message) const {
    Topics::Instance().Publish(topic_, message);
  }
  template <typename Message>
  void publish(const Message&) const {}  // of what is drawn

 private:
  std::string topic_;
};

struct NodeHandle {
  template <typename Value>
  bool getParam(const std::string&, Value&) {
    return false;
  }
  bool getParam(const std::string& name, std::string& value) {
    const auto found = Parameters().find(name);
    value = found == Parameters().end() ? std::string() : found->second;
    return found != Parameters().end();
  }
  template <typename Message, typename Node>
  Subscriber subscribe(const std::string& topic, int,
                       void (Node::*callback)(const std::shared_ptr<const Message>&), Node* node) {
    Topics::Instance().Subscribe(topic, [node, callback](const std::shared_ptr<const void>& message) {
      (node->*callback)(std::static_pointer_cast<const Message>(message));
    });
    return {};
  }
  template <typename Message, typename Node>
  Subscriber subscribe(const std::string& topic, int, void (Node::*callback)(std::shared_ptr<const Message>),
                       Node* node) {
    Topics::Instance().Subscribe(topic, [node, callback](const std::shared_ptr<const void>& message) {
      (node->*callback)(std::static_pointer_cast<const Message>(message));
    });
    return {};
  }
  template <typename Message>
  Publisher advertise(const std::string& topic, int) {
    return Publisher(topic);
  }
  void shutdown() {}
};

}  // namespace ros
