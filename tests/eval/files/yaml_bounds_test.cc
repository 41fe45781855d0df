// Text that makes yaml-cpp, or a walk over its nodes, take memory without bound is refused at once, with its
// place.

#include "eval/files/yaml_bounds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <ostream>

#include "eval/files/strict_yaml.h"

namespace alidade {
namespace {

using testing::HasSubstr;

std::string Repeated(const std::string& text, size_t times) {
  std::string result;
  for (size_t i = 0; i < times; ++i) {
    result += text;
  }
  return result;
}

/// Ten lists, each of ten aliases of the one before: ten to the power of ten nodes.
std::string Laughs() {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 10; ++i) {
    const std::string alias = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + alias;
    text += Repeated(", " + alias, 9) + "]\n";
  }
  return text;
}

/// Few nodes, but each alias nests what it stands for once more.
std::string NestedByAliases() {
  std::string text = "a0: &a0 x\n";
  for (int i = 1; i < 200; ++i) {
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [*a" + std::to_string(i - 1) + "]\n";
  }
  return text;
}

struct BombCase {
  const char* story;
  std::string yaml;
  std::vector<std::string> said;
};

std::ostream& operator<<(std::ostream& stream, const BombCase& c) {
  return stream << c.story;
}

class YamlBomb : public testing::TestWithParam<BombCase> {};

TEST_P(YamlBomb, IsRefusedWithinASecondAndNamesThePlace) {
  const auto start = std::chrono::steady_clock::now();
  const Result<YAML::Node> node = ParseYaml(GetParam().yaml, "f.yaml", StatusCode::kConfig);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
  ASSERT_FALSE(node.ok());
  EXPECT_EQ(node.code(), StatusCode::kConfig);
  for (const std::string& said : GetParam().said) {
    EXPECT_THAT(node.message(), HasSubstr(said));
  }
}

const BombCase kBombs[] = {
    {"a comma", ",", {"f.yaml:1:1:", "','"}},
    {"a comma and a word", ", a", {"f.yaml:1:1:", "','"}},
    {"a comma after a list", "[1,2],3", {"f.yaml:1:6:", "','"}},
    {"a comma after a group", "{a: 1},", {"f.yaml:1:7:", "','"}},
    {"many documents", Repeated("---\na: 1\n", 10'000), {"f.yaml:4:1:", "second document"}},
    {"deep lists", "a: " + Repeated("[", 100'000), {"f.yaml:1:", "nested"}},
    {"deep groups", "a: " + Repeated("{b: ", 30'000), {"f.yaml:1:", "nested"}},
    {"deep dashes", Repeated("- ", 50'000), {"f.yaml:1:", "nested"}},
    {"aliases that expand to too much", Laughs(), {"f.yaml:5:", "more than 30000 nodes"}},
    {"a list in itself", "a: &a [1, *a]", {"f.yaml:1:11:", "cycle"}},
    {"aliases that nest", NestedByAliases(), {"f.yaml:101:", "nested"}},
    {"many nodes", "a: [" + Repeated("1,", 40'000) + "1]", {"f.yaml:1:", "nodes"}},
    {"much text", "a: " + Repeated("x", kMaxYamlBytes), {"f.yaml:", "131075 bytes", "131072"}},
};
INSTANTIATE_TEST_SUITE_P(Yaml, YamlBomb, testing::ValuesIn(kBombs));

TEST(YamlBounds, GivenAnAliasOfAnotherNodeThenItIsRead) {
  const Result<YAML::Node> node = ParseYaml("a: &x [1, 2]\nb: *x\n", "f.yaml", StatusCode::kConfig);
  ASSERT_TRUE(node.ok()) << node.message();
  EXPECT_EQ((*node)["b"][1].Scalar(), "2");
}

TEST(YamlBounds, GivenTheDeepestNestingThatIsAllowedThenItIsRead) {
  const std::string yaml = "a: " + Repeated("[", 99) + Repeated("]", 99);
  const Result<YAML::Node> node = ParseYaml(yaml, "f.yaml", StatusCode::kConfig);
  EXPECT_TRUE(node.ok()) << node.message();
}

}  // namespace
}  // namespace alidade
