#pragma once

#include <optional>
#include <vector>

#include "eval/dataset/dataset.h"

namespace alidade {

/// A sample that comes later than this after one with a later stamp is dropped [ns].
inline constexpr TimeNs kMaxImuLatenessNs = 50'000'000;
/// The largest share of a table's rows that may be dropped.
inline constexpr double kMaxRejectedImuShare = 0.05;

/// Puts the samples of a table in the order of their stamps and drops those that cannot be used, as a
/// driver's log holds them: duplicates, late ones, and such without a value.
class ImuIntake {
 public:
  /// Why the sample was dropped; nothing when it was taken.
  std::optional<Status> Add(const ImuSample& sample);

  [[nodiscard]] const std::vector<ImuSample>& samples() const { return samples_; }
  /// Takes out the samples that no later one can come before.
  [[nodiscard]] std::vector<ImuSample> TakeSettled();
  [[nodiscard]] const ImuRejections& rejections() const { return rejections_; }

 private:
  std::vector<ImuSample> samples_;
  ImuRejections rejections_;
};

/// "6 dropped (3 duplicate, 1 late, 2 not finite), 4 put in order"; empty when there is none of them.
[[nodiscard]] std::string DescribeRejections(const ImuRejections& rejections);

}  // namespace alidade
