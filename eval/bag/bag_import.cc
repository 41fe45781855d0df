#include "eval/bag/bag_import.h"

#include <filesystem>
#include <map>
#include <memory>
#include <utility>

#include "eval/bag/bag_collector.h"
#include "eval/bag/bag_parts.h"
#include "eval/rosbag/ros_sensor_messages.h"

namespace alidade {
namespace {

class Importer {
 public:
  Importer(const std::string& path, const BagImportOptions& options, const BagTopics& topics)
      : bag_{path, options, topics, BagSheets(path), BagRemarks(path), {}},
        collectors_(MakeBagCollectors()) {}

  Result<BagImport> Execute() {
    Result<RosbagReader> reader = RosbagReader::Open(bag_.path);
    ALIDADE_RETURN_IF_ERROR(reader.status());
    ALIDADE_RETURN_IF_ERROR(ListTopics(&*reader));
    ALIDADE_RETURN_IF_ERROR(bag_.topics.Resolve(bag_.path, found_));
    const Result<BagScan> scan = reader->Scan([this](const BagMessage& message) { return Take(message); });
    ALIDADE_RETURN_IF_ERROR(scan.status());
    DescribeScan(*scan);
    bag_.dataset.path = bag_.path;
    bag_.dataset.has_sheets = false;
    bag_.dataset.name = std::filesystem::path(bag_.path).stem().string();
    for (const std::unique_ptr<BagCollector>& collector : collectors_) {
      ALIDADE_RETURN_IF_ERROR(collector->Assemble(&bag_));
    }
    return BagImport{std::move(bag_.dataset), *scan, bag_.remarks.Take()};
  }

 private:
  Status ListTopics(RosbagReader* reader) {
    const Result<BagScan> scan = reader->Scan([this](const BagMessage& message) {
      found_[message.connection->topic] = message.connection->type;
      return Stopped();
    });
    ALIDADE_RETURN_IF_ERROR(scan.status());
    total_ = scan->messages;
    return scan->messages > 0 ? Status::Ok() : Status::Input(bag_.path + ": holds no complete message");
  }

  [[nodiscard]] Status Stopped() const {
    const std::atomic<bool>* stop = bag_.options.stop;
    return stop != nullptr && stop->load() ? Status::Diverged("stopped") : Status::Ok();
  }

  Status Take(const BagMessage& message) {
    ALIDADE_RETURN_IF_ERROR(Stopped());
    if (bag_.options.progress) {
      bag_.options.progress(++done_, total_);
    }
    const std::string& topic = message.connection->topic;
    if (message.connection->type == "std_msgs/String" && topic.ends_with("/sensor_yaml")) {
      if (std::optional<std::string> text = DecodeText(message.data)) {
        bag_.sheets.Take(topic, *std::move(text));
      }
      return Status::Ok();
    }
    for (const std::unique_ptr<BagCollector>& collector : collectors_) {
      const Result<bool> taken = collector->Take(message, &bag_);
      if (!taken.ok()) {
        return taken.status();
      }
      if (*taken) {
        break;
      }
    }
    return Status::Ok();
  }

  void DescribeScan(const BagScan& scan) {
    if (scan.truncated) {
      bag_.remarks.Add("ends inside a record; the complete records were read");
    } else if (!scan.indexed) {
      bag_.remarks.Add("was never closed and has no index; it was read from front to back");
    }
    if (scan.damaged > 0) {
      bag_.remarks.Add(std::to_string(scan.damaged) +
                       " damaged parts skipped, the first: " + scan.first_damage);
    }
    bag_.remarks.AddTotals();
  }

  BagContext bag_;
  std::vector<std::unique_ptr<BagCollector>> collectors_;
  std::map<std::string, std::string> found_;  ///< topic -> type
  std::int64_t done_ = 0;
  std::int64_t total_ = 0;
};

}  // namespace

Result<BagImport> ReadBag(const std::string& path, const BagImportOptions& options) {
  const Result<BagTopics> topics = MakeBagTopics(options.topics);
  ALIDADE_RETURN_IF_ERROR(topics.status());
  return Importer(path, options, *topics).Execute();
}

}  // namespace alidade
