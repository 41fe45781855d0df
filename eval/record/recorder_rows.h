#pragma once

#include <string>

#include "core/estimator_config.h"
#include "eval/record/run_record.h"

namespace alidade {

// Rows of the tables of a run (docs/formats.md), a record each, and their headers, with the ends of their
// lines.

[[nodiscard]] std::string StatesHeader();
/// with_clock: with the clock terms behind the other columns, as in a header with ClockColumns.
void AppendState(const RunRecord& record, bool with_clock, std::string* text);

/// Of bound.csv. Precondition: the record has a filtering covariance.
[[nodiscard]] std::string BoundHeader();
void AppendBound(const RunRecord& record, std::string* text);

[[nodiscard]] std::string TimingHeader();
void AppendTiming(const RunRecord& record, std::string* text);

[[nodiscard]] std::string StatusHeader(const EstimatorConfig& config);
void AppendStatus(const RunRecord& record, const EstimatorConfig& config, std::string* text);

/// Nothing of a record without a calibration; likewise without observability.
void AppendCalibration(const RunRecord& record, std::string* text);
[[nodiscard]] std::string ObservabilityHeader();
void AppendObservability(const RunRecord& record, std::string* text);

}  // namespace alidade
