#include "eval/frontend_run/frontend_summary.h"

#include <algorithm>
#include <limits>
#include <map>

#include "eval/files/csv_text.h"

namespace alidade {
namespace {

/// Value below which the share of the numbers lies; NaN of none.
double Quantile(std::vector<double> values, double share) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<size_t>(at)];
}

double Mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) {
    sum += value;
  }
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(values.size());
}

}  // namespace

FrontendSummary SummarizeFrontend(const std::vector<TrackFrame>& frames,
                                  const std::vector<TrackerStatistics>& statistics) {
  FrontendSummary summary;
  std::map<std::int64_t, double> lengths;
  std::vector<double> features, times_ms;
  for (const TrackFrame& frame : frames) {
    features.push_back(static_cast<double>(frame.observations.size()));
    times_ms.push_back(frame.frontend_ms);
    for (const TrackObservation& observation : frame.observations) {
      ++lengths[observation.track_id];
    }
  }
  std::vector<double> frames_lived;
  frames_lived.reserve(lengths.size());
  for (const auto& [id, length] : lengths) {
    frames_lived.push_back(length);
  }
  std::vector<double> lost, rejected, thinned;
  for (const TrackerStatistics& image : statistics) {
    const double before = image.tracked + image.lost + image.rejected + image.thinned;
    if (before > 0) {
      lost.push_back(image.lost / before);
      rejected.push_back(image.rejected / before);
      thinned.push_back(image.thinned / before);
    }
  }
  summary.images = static_cast<int>(frames.size());
  summary.tracks = static_cast<int>(lengths.size());
  summary.features_per_frame = Mean(features);
  summary.median_length = Quantile(frames_lived, 0.5);
  summary.mean_length = Mean(frames_lived);
  summary.lost_share = Mean(lost);
  summary.rejected_share = Mean(rejected);
  summary.thinned_share = Mean(thinned);
  summary.mean_ms = Mean(times_ms);
  summary.p95_ms = Quantile(times_ms, 0.95);
  return summary;
}

std::string FrontendCsv(const std::vector<TrackFrame>& frames,
                        const std::vector<TrackerStatistics>& statistics) {
  std::string text = "timestamp_ns,features,tracked,lost,rejected,thinned,detected,mean_track_length\n";
  for (size_t i = 0; i < frames.size() && i < statistics.size(); ++i) {
    const TrackerStatistics& image = statistics[i];
    std::vector<std::string> fields = {std::to_string(frames[i].stamp_ns)};
    for (const int count : {static_cast<int>(frames[i].observations.size()), image.tracked, image.lost,
                            image.rejected, image.thinned, image.detected}) {
      fields.push_back(std::to_string(count));
    }
    fields.push_back(CsvNumber(image.mean_track_length));
    text += JoinCsv(fields);
  }
  return text;
}

}  // namespace alidade
