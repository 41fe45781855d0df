#include "eval/dataset/log_tables.h"

namespace alidade {
namespace {

template <typename Row>
Status MoveToFile(const std::string& folder, std::vector<Row>* rows, Table<Row>* table) {
  *table = Table<Row>::InFile(folder);
  for (const Row& row : *rows) {
    ALIDADE_RETURN_IF_ERROR(table->Add(row));
  }
  std::vector<Row>().swap(*rows);
  return Status::Ok();
}

void Encode(const Eigen::Vector3d& vector, ByteWriter* bytes) {
  for (const double value : vector) {
    bytes->Write(value);
  }
}

Eigen::Vector3d DecodeVector(ByteReader* bytes) {
  const double x = bytes->Read<double>(), y = bytes->Read<double>(), z = bytes->Read<double>();
  return {x, y, z};
}

}  // namespace

void Encode(const ImuSample& sample, ByteWriter* bytes) {
  bytes->Write(sample.stamp_ns);
  Encode(sample.gyro, bytes);
  Encode(sample.accel, bytes);
  bytes->Write(sample.gap_s);
}

void Decode(ByteReader* bytes, ImuSample* sample) {
  sample->stamp_ns = bytes->Read<TimeNs>();
  sample->gyro = DecodeVector(bytes);
  sample->accel = DecodeVector(bytes);
  sample->gap_s = bytes->Read<double>();
}

void Encode(const TrackFrame& frame, ByteWriter* bytes) {
  bytes->Write(frame.stamp_ns);
  bytes->Write(frame.frontend_ms);
  bytes->Write(static_cast<std::uint32_t>(frame.observations.size()));
  for (const TrackObservation& observation : frame.observations) {
    bytes->Write(observation.track_id);
    bytes->Write(observation.pixel.x());
    bytes->Write(observation.pixel.y());
    bytes->Write(observation.noise_ratio);
  }
}

void Decode(ByteReader* bytes, TrackFrame* frame) {
  frame->stamp_ns = bytes->Read<TimeNs>();
  frame->frontend_ms = bytes->Read<double>();
  frame->observations.resize(bytes->Read<std::uint32_t>());
  for (TrackObservation& observation : frame->observations) {
    observation.track_id = bytes->Read<std::int64_t>();
    observation.pixel.x() = bytes->Read<double>();
    observation.pixel.y() = bytes->Read<double>();
    observation.noise_ratio = bytes->Read<double>();
  }
}

LogTables TablesOf(const Dataset& dataset) {
  if (dataset.tables != nullptr) {
    return *dataset.tables;
  }
  LogTables tables{Table<ImuSample>(dataset.imu), Table<TrackFrame>(dataset.frames), {}};
  for (const ExtraCamera& extra : dataset.extra_cameras) {
    tables.extra_frames.emplace_back(extra.frames);
  }
  return tables;
}

LogTables TablesOf(const MeasurementLog& log) {
  LogTables tables{Table<ImuSample>(log.imu), Table<TrackFrame>(log.frames), {}};
  for (const ExtraCamera& extra : log.extra_cameras) {
    tables.extra_frames.emplace_back(extra.frames);
  }
  return tables;
}

Status MoveTablesToFiles(const std::string& folder, Dataset* dataset) {
  if (dataset->tables != nullptr) {
    return Status::Ok();
  }
  auto tables = std::make_shared<LogTables>();
  ALIDADE_RETURN_IF_ERROR(MoveToFile(folder, &dataset->imu, &tables->imu));
  ALIDADE_RETURN_IF_ERROR(MoveToFile(folder, &dataset->frames, &tables->frames));
  for (ExtraCamera& extra : dataset->extra_cameras) {
    ALIDADE_RETURN_IF_ERROR(MoveToFile(folder, &extra.frames, &tables->extra_frames.emplace_back()));
  }
  dataset->tables = std::move(tables);
  return Status::Ok();
}

}  // namespace alidade
