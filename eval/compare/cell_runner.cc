#include "eval/compare/cell_runner.h"

#include "eval/compare/compare_status.h"

namespace alidade {

Status ReportFault(const CompareCell& cell, const std::string& fault) {
  const RunningMark its_own(cell.report_file);  // takes the one that was left, and removes it
  CellReport report;
  report.result = cell.result;
  report.digest = cell.digest;
  report.result.status = "failed";
  report.result.message = fault;
  return WriteCellFile(report, cell.report_file);
}

CellRunner::CellRunner(const Plan& plan, const CompareOptions& options, CellList* cells)
    : plan_(plan), options_(options), cells_(cells) {
  pipeline_.stop = options.stop;
  pipeline_.jobs = options.jobs;
}

CellRunner::~CellRunner() {
  Hold(nullptr);
}

void CellRunner::Hold(CompareInput* input) {
  if (input == held_) {
    return;
  }
  if (held_ != nullptr) {
    held_->Release();
  }
  held_ = input;
}

Status CellRunner::Run(size_t index) {
  CompareCell cell = cells_->at(index);
  const RunningMark mark(cell.report_file);
  Hold(cell.input);
  CellReport report;
  const auto note = [&report](const CompareInput::Data& data) {
    report.frontend = data.frontend;
    report.remarks = data.remarks;
  };
  report.reused = RunCompareCell(plan_, options_, pipeline_, note, &cell);
  if (options_.Stopped()) {
    return Status::Ok();
  }
  if (report.frontend) {
    report.frontend->sequence = cell.sequence->name;
    report.frontend->seed = cell.seed;
  }
  report.result = std::move(cell.result);
  report.digest = cell.digest;
  return WriteCellFile(report, cell.report_file);
}

Status CellRunner::Prepare(size_t index) {
  Hold(cells_->at(index).input);
  return held_->Acquire(pipeline_).status();
}

}  // namespace alidade
