#include "eval/bag/bag_topics.h"

#include <algorithm>
#include <sstream>

#include "core/check.h"
#include "eval/files/suggest.h"

namespace alidade {
namespace {

using Found = std::map<std::string, std::string>;

std::string Inventory(const Found& found) {
  std::string text;
  for (const auto& [topic, type] : found) {
    text += (text.empty() ? "" : ", ") + topic + " (" + type + ")";
  }
  return text;
}

/// "a, b or c" of the types that a topic may hold.
std::string TypesOf(const BagTopic& topic) {
  std::string text;
  for (std::size_t i = 0; i < topic.types.size(); ++i) {
    text += (i == 0 ? "" : i + 1 < topic.types.size() ? ", " : " or ") + topic.types[i];
  }
  return text;
}

/// One topic's part of BagTopics::Resolve.
Status ResolveOne(const std::string& path, const Found& found, const BagTopic& topic, std::string* name) {
  const auto fits = [&](const std::string& type) {
    return std::find(topic.types.begin(), topic.types.end(), type) != topic.types.end();
  };
  const auto named = found.find(*name);
  if (named != found.end() && fits(named->second)) {
    return Status::Ok();
  }
  if (*name != topic.usual_name) {
    return Status::Input(path + ": no topic " + *name + " of type " + TypesOf(topic) + "; found " +
                         Inventory(found));
  }
  std::vector<std::string> candidates;
  for (const auto& [candidate, type] : found) {
    if (fits(type)) {
      candidates.push_back(candidate);
    }
  }
  if (candidates.size() > 1) {
    return Status::Input(path + ": " + std::to_string(candidates.size()) + " topics of type " +
                         TypesOf(topic) + ", expected --topics=" + topic.word + "=TOPIC to name one; found " +
                         Inventory(found));
  }
  *name = candidates.empty() ? std::string() : candidates.front();
  return Status::Ok();
}

}  // namespace

BagTopics::BagTopics(const std::vector<BagTopic>& topics) {
  for (const BagTopic& topic : topics) {
    topics_.push_back({topic, topic.usual_name, false});
  }
}

Status BagTopics::Set(const std::string& list) {
  std::vector<std::string> words;
  for (const Named& topic : topics_) {
    words.push_back(topic.word);
  }
  std::istringstream entries(list);
  for (std::string entry; std::getline(entries, entry, ',');) {
    const std::size_t equals = entry.find('=');
    const std::string word = entry.substr(0, equals);
    if (equals == std::string::npos || equals + 1 == entry.size()) {
      return Status::Usage("--topics: found '" + entry + "', expected sensor=/topic");
    }
    const auto named = std::find(words.begin(), words.end(), word);
    if (named == words.end()) {
      return Status::Usage("--topics: unknown sensor '" + word + "'" + Suggestion(word, words));
    }
    Named& topic = topics_[static_cast<std::size_t>(named - words.begin())];
    topic.name = entry.substr(equals + 1);
    topic.is_named = true;
  }
  return Status::Ok();
}

Status BagTopics::Resolve(const std::string& path, const std::map<std::string, std::string>& found) {
  for (Named& topic : topics_) {
    const bool left_alone = topic.search == BagTopic::Search::kNone ||
                            (topic.search == BagTopic::Search::kWhenNamed && topic.name == topic.usual_name);
    if (!left_alone) {
      ALIDADE_RETURN_IF_ERROR(ResolveOne(path, found, topic, &topic.name));
    }
  }
  for (const Named& topic : topics_) {
    if (topic.search == BagTopic::Search::kRequired && topic.name.empty()) {
      return Status::Input(path + ": no topic of type " + TypesOf(topic) + "; found " + Inventory(found));
    }
  }
  return Status::Ok();
}

const BagTopics::Named& BagTopics::Find(std::string_view word) const {
  const auto topic =
      std::find_if(topics_.begin(), topics_.end(), [&](const Named& named) { return named.word == word; });
  CHECK(topic != topics_.end()) << "topic '" << word << "' is in no list";
  return *topic;
}

}  // namespace alidade
