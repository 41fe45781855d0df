#include "eval/peers/peer_run.h"

#include <cstdio>

#include "eval/dataset/dataset_truth.h"
#include "eval/files/csv_text.h"
#include "eval/files/output_file.h"
#include "eval/trajectory/truth_covariance.h"

namespace alidade {

Status WritePeerRun(const PeerRun& run, const std::string& folder) {
  if (run.trajectory.points.empty()) {
    return Status::Diverged("never initialised: no frame has a state");
  }
  const std::string path = folder + "/trajectory.csv";
  if (run.trajectory.has_covariance) {
    ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(CovariancePath(path), CovarianceCsv(run.trajectory)));
  }
  std::string timing = "timestamp_ns,frontend_ms,backend_ms\n";
  for (size_t i = 0; i < run.times.size(); ++i) {
    timing += JoinCsv({std::to_string(run.trajectory.points[i].stamp_ns), CsvNumber(run.times[i].frontend_ms),
                       CsvNumber(run.times[i].backend_ms)});
  }
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/timing.csv", timing));
  return WriteFileAtomically(path, TruthCsv(run.trajectory));
}

int RunDriver(const char* name, int argc, char** argv,
              Status (*execute)(const std::vector<std::string>& arguments)) {
  const Status status = execute({argv + 1, argv + argc});
  if (!status.ok()) {
    std::fprintf(stderr, "%s: %s\n", name, status.message().c_str());
  }
  return status.ok() ? 0 : 1;
}

}  // namespace alidade
