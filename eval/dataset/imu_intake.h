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
///
/// The clock was set back when kSetBackRows late samples follow each other in order, later than the first
/// sample and the last hole: they lie where samples are already, so that they are none that were delayed.
/// They and all later ones are moved to follow the newest one. A clock that is set back by less than they
/// span and kMaxImuLatenessNs is not found.
class ImuIntake {
 public:
  static constexpr std::size_t kSetBackRows = 10;

  /// Why the sample was dropped; nothing when it was taken.
  std::optional<Status> Add(const ImuSample& as_stamped);

  [[nodiscard]] const std::vector<ImuSample>& samples() const { return samples_; }
  /// Takes out the samples that no later one can come before.
  [[nodiscard]] std::vector<ImuSample> TakeSettled();
  [[nodiscard]] const ImuRejections& rejections() const { return rejections_; }

 private:
  /// The newest sample so far comes.
  void Append(const ImuSample& sample);
  /// Remembers a late sample. True: the clock was set back, which is put right with the samples remembered.
  bool FindSetBack(const ImuSample& sample);

  std::vector<ImuSample> samples_;
  std::vector<ImuSample> late_;  ///< that follow each other, up to the last sample
  TimeNs moved_ns_ = 0;          ///< the later stamps, because the clock was set back
  TimeNs covered_ns_ = 0;        ///< stamp of the first sample, and of that after the last hole
  TimeNs last_step_ns_ = 0;
  ImuRejections rejections_;
};

/// "6 dropped (3 duplicate, 1 late, 2 not finite), 4 put in order, the clock set back by 0.200 s"; empty when
/// there is none of them.
[[nodiscard]] std::string DescribeRejections(const ImuRejections& rejections);

}  // namespace alidade
