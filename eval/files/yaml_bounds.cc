#include "eval/files/yaml_bounds.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <vector>

namespace alidade {
namespace {

constexpr size_t kMaxYamlNodes = 30'000;
constexpr size_t kMaxYamlDepth = 100;

struct YamlRefusal {
  YAML::Mark mark;
  std::string reason;
};

/// Counts the nodes of a document as a walk over them meets them: an alias is all that it stands for.
class YamlNodeCounter final : public YAML::EventHandler {
 public:
  explicit YamlNodeCounter(const std::string& text) : text_(text) {}

  void OnDocumentStart(const YAML::Mark&) override { ++documents_; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { Leaf(mark, anchor); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                const std::string&) override {
    Leaf(mark, anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchored_.find(anchor);
    if (found == anchored_.end()) {
      throw YamlRefusal{mark, "found an alias inside the node that it refers to, expected no cycle"};
    }
    Count(mark, found->second);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Open(mark, anchor);
  }
  void OnSequenceEnd() override { Close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Open(mark, anchor);
  }
  void OnMapEnd() override { Close(); }

 private:
  struct Extent {
    size_t nodes = 0;
    size_t depth = 0;
  };
  struct OpenNode {
    YAML::anchor_t anchor;
    size_t nodes_before;
    size_t deepest;  ///< level of its deepest descendant
  };

  void Leaf(const YAML::Mark& mark, YAML::anchor_t anchor) {
    const Extent leaf{1, 0};
    Count(mark, leaf);
    anchored_[anchor] = leaf;
  }

  void Open(const YAML::Mark& mark, YAML::anchor_t anchor) {
    Count(mark, {1, 0});
    open_.push_back({anchor, nodes_ - 1, open_.size()});
  }

  void Close() {
    const OpenNode closed = open_.back();
    open_.pop_back();
    anchored_[closed.anchor] = {nodes_ - closed.nodes_before, closed.deepest - open_.size()};
    if (!open_.empty()) {
      open_.back().deepest = std::max(open_.back().deepest, closed.deepest);
    }
  }

  void Count(const YAML::Mark& mark, const Extent& extent) {
    if (documents_ > 1) {
      const auto position = static_cast<size_t>(mark.pos);
      const bool comma = position < text_.size() && text_[position] == ',';
      throw YamlRefusal{mark, comma ? "found ',' outside brackets, expected keys and values"
                                    : "found a second document, expected one"};
    }
    nodes_ += extent.nodes;
    if (nodes_ > kMaxYamlNodes) {
      throw YamlRefusal{mark, "found more than " + std::to_string(kMaxYamlNodes) +
                                  " nodes, aliases expanded, expected at most as many"};
    }
    const size_t level = open_.size() + extent.depth;
    if (level > kMaxYamlDepth) {
      throw YamlRefusal{mark, "found more than " + std::to_string(kMaxYamlDepth) +
                                  " nested groups and lists, expected at most as many"};
    }
    if (!open_.empty()) {
      open_.back().deepest = std::max(open_.back().deepest, level);
    }
  }

  const std::string& text_;
  int documents_ = 0;
  size_t nodes_ = 0;
  std::vector<OpenNode> open_;
  std::map<YAML::anchor_t, Extent> anchored_;  ///< closed nodes; the entry of 0 is of those without an anchor
};

std::string PlaceOf(const std::string& where, const YAML::Mark& mark) {
  return mark.is_null() ? where
                        : where + ":" + std::to_string(mark.line + 1) + ":" + std::to_string(mark.column + 1);
}

}  // namespace

Status CheckYamlBounds(const std::string& text, const std::string& where, StatusCode code) {
  if (text.size() > kMaxYamlBytes) {
    return Status(code, where + ": holds " + std::to_string(text.size()) +
                            " bytes, expected YAML of at most " + std::to_string(kMaxYamlBytes));
  }
  std::istringstream stream(text);
  YamlNodeCounter counter(text);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(counter)) {
    }
  } catch (const YamlRefusal& refusal) {
    return Status(code, PlaceOf(where, refusal.mark) + ": " + refusal.reason);
  } catch (const YAML::Exception& error) {
    return Status(code, PlaceOf(where, error.mark) + ": is not valid YAML: " + error.msg);
  }
  return Status::Ok();
}

}  // namespace alidade
