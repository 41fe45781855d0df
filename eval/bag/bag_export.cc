#include "eval/bag/bag_export.h"

#include <vector>

#include "eval/bag/bag_parts.h"
#include "eval/rosbag/rosbag_writer.h"

namespace alidade {

Status WriteBag(const Dataset& dataset, const BagExportOptions& options, const std::string& path) {
  const Result<BagTopics> topics = MakeBagTopics(options.topics);
  ALIDADE_RETURN_IF_ERROR(topics.status());
  Result<RosbagWriter> bag = RosbagWriter::Create(path, options.compression);
  ALIDADE_RETURN_IF_ERROR(bag.status());
  BagSchedule schedule(&*bag);
  ScheduleDataset(dataset, *topics, &schedule);
  const std::vector<BagSchedule::Message> messages = schedule.Take();
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (options.stop != nullptr && options.stop->load()) {
      return Status::Diverged("stopped");
    }
    const Result<std::string> message = messages[i].encode();
    ALIDADE_RETURN_IF_ERROR(message.status());
    ALIDADE_RETURN_IF_ERROR(bag->Write(messages[i].topic, messages[i].stamp_ns, *message));
    if (options.progress) {
      options.progress(i + 1, messages.size());
    }
  }
  return bag->Close();
}

}  // namespace alidade
