#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/probe/probe.h"

namespace alidade::test {

/// Numbers of nested arrays, in their order.
inline std::vector<double> Flatten(const nlohmann::json& value) {
  if (value.is_number()) {
    return {value.get<double>()};
  }
  std::vector<double> numbers;
  for (const nlohmann::json& entry : value) {
    const std::vector<double> inner = Flatten(entry);
    numbers.insert(numbers.end(), inner.begin(), inner.end());
  }
  return numbers;
}

/// Answers to the cases of a model.
inline nlohmann::json Ask(const std::string& model, const nlohmann::json& cases,
                          ErrorConvention convention = ErrorConvention::kRightInvariant) {
  const Result<std::string> answer = Probe(model, nlohmann::json{{"cases", cases}}.dump(), convention);
  EXPECT_TRUE(answer.ok()) << answer.message();
  return answer.ok() ? nlohmann::json::parse(*answer)["cases"] : nlohmann::json::array();
}

}  // namespace alidade::test
