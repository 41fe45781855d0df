#include "eval/cli/score.h"

#include <cstdio>

#include "eval/cli/flags.h"
#include "eval/files/output_file.h"
#include "eval/frontend_run/track_score.h"
#include "eval/render/drawn_truth.h"

namespace alidade::cli {

Status ReportTrackScore(const Dataset& dataset, const std::vector<TrackFrame>& tracks,
                        const std::vector<double>& cpu_ms) {
  const Result<TrackTruth> truth = TruthOfTracks(dataset, tracks);
  ALIDADE_RETURN_IF_ERROR(truth.status());
  const TrackScore score = ScoreTracks(tracks, dataset.rig.camera, *truth, cpu_ms);
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(FLAGS_output + "/score.json", ScoreJson(score)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(FLAGS_output + "/score.csv", ScoreCsv(score)));
  std::printf("%s", DescribeScore(score).c_str());
  return Status::Ok();
}

}  // namespace alidade::cli
