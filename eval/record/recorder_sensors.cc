#include "eval/record/recorder_sensors.h"

#include <cstdint>
#include <utility>

#include "eval/files/output_file.h"

namespace alidade {
namespace {

const char* NisColumnOf(Sensor sensor) {
  const char* name = "";
  ForEachSensorEntry([&](auto entry, Sensor of) { name = of == sensor ? entry.kColumns[2] : name; });
  return name;
}

}  // namespace

std::string SensorColumns(const EstimatorConfig& config) {
  std::string names;
  ForEachSensorEntry([&](auto entry, Sensor) {
    static_assert(decltype(entry)::kColumns.size() == kColumnsPerSensor);
    for (const char* name : entry.kColumns) {
      names += entry.Config(config).enabled ? std::string(",") + name : "";
    }
  });
  return names;
}

std::string SensorFields(const EstimatorConfig& config, const FrameStatistics& statistics) {
  std::string fields;
  ForEachSensorEntry([&](auto entry, Sensor sensor) {
    const SensorStatistics& counts = statistics.sensors[sensor];
    if (entry.Config(config).enabled) {
      fields += "," + std::to_string(counts.used) + "," + std::to_string(counts.gated) + "," +
                ShortestDouble(counts.nis) + "," + std::to_string(counts.nis_dof);
    }
  });
  return fields;
}

Status ReadSensorFields(const CsvReader& row, std::size_t first, const std::vector<Sensor>& sensors,
                        FrameStatistics* statistics) {
  for (const Sensor sensor : sensors) {
    SensorStatistics& counts = statistics->sensors[sensor];
    const std::pair<std::size_t, int*> columns[] = {
        {first, &counts.used}, {first + 1, &counts.gated}, {first + 3, &counts.nis_dof}};
    for (const auto& [column, count] : columns) {
      std::int64_t value = 0;
      ALIDADE_RETURN_IF_ERROR(row.ReadInt64(column, "count", &value));
      *count = static_cast<int>(value);
    }
    ALIDADE_RETURN_IF_ERROR(row.ReadReal(first + 2, NisColumnOf(sensor), &counts.nis));
    first += kColumnsPerSensor;
  }
  return Status::Ok();
}

}  // namespace alidade
