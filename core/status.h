#pragma once

#include <optional>
#include <string>
#include <utility>

namespace alidade {

/// What kind of failure a Status carries. Each maps to one exit code of the command line (see eval/cli).
enum class StatusCode {
  kOk,
  kUsage,     ///< the caller asked for something that does not exist
  kConfig,    ///< a configuration key is missing, unknown, ill-typed or out of range
  kInput,     ///< a file or a measurement is missing, torn, unordered, not finite or degenerate
  kDiverged,  ///< an estimator lost its state or never found it
  kOutput,    ///< a result could not be written
};

/// An error as a value: a code and a message that names file, line or key, the value found and what was
/// expected. Programmer mistakes are CHECKs instead; bad input is always a Status.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(StatusCode code, std::string message) : code_(code), message_(std::move(message)) {}

  static Status Ok() { return {}; }
  static Status Usage(std::string message) { return {StatusCode::kUsage, std::move(message)}; }
  static Status Config(std::string message) { return {StatusCode::kConfig, std::move(message)}; }
  static Status Input(std::string message) { return {StatusCode::kInput, std::move(message)}; }
  static Status Diverged(std::string message) { return {StatusCode::kDiverged, std::move(message)}; }
  static Status Output(std::string message) { return {StatusCode::kOutput, std::move(message)}; }

  [[nodiscard]] bool ok() const { return code_ == StatusCode::kOk; }
  [[nodiscard]] StatusCode code() const { return code_; }
  [[nodiscard]] const std::string& message() const { return message_; }

 private:
  StatusCode code_ = StatusCode::kOk;
  std::string message_;
};

/// A value of type T, or the Status with the reason why there is none.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}          // NOLINT(google-explicit-constructor)
  Result(Status status) : status_(std::move(status)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return value_.has_value(); }
  [[nodiscard]] const Status& status() const { return status_; }
  [[nodiscard]] StatusCode code() const { return status_.code(); }
  [[nodiscard]] const std::string& message() const { return status_.message(); }

  [[nodiscard]] const T& value() const& { return *value_; }
  [[nodiscard]] T& value() & { return *value_; }
  [[nodiscard]] T&& value() && { return *std::move(value_); }
  const T& operator*() const& { return *value_; }
  T& operator*() & { return *value_; }
  const T* operator->() const { return &*value_; }
  T* operator->() { return &*value_; }

 private:
  std::optional<T> value_;
  Status status_;
};

}  // namespace alidade

/// Returns from the enclosing function when `expression` yields a Status that is not ok.
#define ALIDADE_RETURN_IF_ERROR(expression)                        \
  do {                                                             \
    if (::alidade::Status status_ = (expression); !status_.ok()) { \
      return status_;                                              \
    }                                                              \
  } while (false)
