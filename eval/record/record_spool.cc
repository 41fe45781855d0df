#include "eval/record/record_spool.h"

#include <type_traits>
#include <utility>

#include "eval/record/satellite_rows.h"

namespace alidade {
namespace {

template <typename Derived>
void EncodeMatrix(const Eigen::PlainObjectBase<Derived>& matrix, ByteWriter* bytes) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i) {
    bytes->Write(matrix.data()[i]);
  }
}

template <typename Derived>
void DecodeMatrix(ByteReader* bytes, Eigen::PlainObjectBase<Derived>* matrix) {
  for (Eigen::Index i = 0; i < matrix->size(); ++i) {
    matrix->data()[i] = bytes->Read<double>();
  }
}

/// Visits the matrices of an estimate in the order in which they are stored.
template <typename Estimate, typename Visit>
void VisitMatrices(Estimate& estimate, const Visit& visit) {
  visit(estimate.nav.R_WB);
  visit(estimate.nav.p_WB);
  visit(estimate.nav.v_WB);
  visit(estimate.bias.gyro);
  visit(estimate.bias.accel);
  visit(estimate.covariance);
}

}  // namespace

void Encode(const RunRecord& record, ByteWriter* bytes) {
  bytes->Write(record.estimate.stamp_ns);
  VisitMatrices(record.estimate, [bytes](const auto& matrix) { EncodeMatrix(matrix, bytes); });
  static_assert(std::is_trivially_copyable_v<FrameStatistics>, "it is stored as it lies in memory");
  bytes->Raw({reinterpret_cast<const char*>(&record.statistics), sizeof record.statistics});
  bytes->Write(record.frontend_ms);
  bytes->Write(record.backend_ms);
  bytes->Block(record.status);
  bytes->Block(record.reason);
  bytes->Write(static_cast<std::uint8_t>(record.degradation));
  bytes->Write(static_cast<std::uint8_t>(record.clock.has_value()));
  if (record.clock) {
    EncodeMatrix(record.clock->mean, bytes);
    EncodeMatrix(record.clock->covariance, bytes);
  }
}

void Decode(ByteReader* bytes, RunRecord* record) {
  record->estimate.stamp_ns = bytes->Read<TimeNs>();
  VisitMatrices(record->estimate, [bytes](auto& matrix) { DecodeMatrix(bytes, &matrix); });
  const std::string_view statistics = bytes->Take(sizeof record->statistics);
  if (bytes->ok()) {
    std::memcpy(&record->statistics, statistics.data(), statistics.size());
  }
  record->frontend_ms = bytes->Read<double>();
  record->backend_ms = bytes->Read<double>();
  record->status = bytes->Block();
  record->reason = bytes->Block();
  record->degradation = static_cast<DegradationKind>(bytes->Read<std::uint8_t>());
  record->clock.reset();
  if (bytes->Read<std::uint8_t>() != 0) {
    record->clock.emplace();
    DecodeMatrix(bytes, &record->clock->mean);
    DecodeMatrix(bytes, &record->clock->covariance);
  }
}

Status RecordSpool::Add(const RunRecord& record) {
  if (record.calibration) {
    if (calibration_columns_.empty()) {
      calibration_columns_ = CalibrationColumns(*record.calibration);
    }
    ALIDADE_RETURN_IF_ERROR(calibration_rows_.Append(std::to_string(record.estimate.stamp_ns) +
                                                     CalibrationFields(*record.calibration) + "\n"));
  }
  return records_.Add(record);
}

Status RecordSpool::Add(const GnssResiduals& residuals) {
  return satellite_rows_.Append(SatelliteRows(residuals));
}

Status RecordSpool::Turn(const GnssAlignment& alignment) {
  const Table<RunRecord> before = std::exchange(records_, Table<RunRecord>::InFile(folder_));
  Table<RunRecord>::Pass pass(before);
  while (true) {
    const Result<const RunRecord*> next = pass.Next();
    ALIDADE_RETURN_IF_ERROR(next.status());
    if (*next == nullptr) {
      return Status::Ok();
    }
    RunRecord record = **next;
    record.estimate = TurnIntoEnu(alignment, record.estimate);
    record.status = "local";
    ALIDADE_RETURN_IF_ERROR(records_.Add(record));
  }
}

}  // namespace alidade
