#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/imu_sample.h"
#include "eval/run/imu_guard.h"

namespace alidade {

/// A silence of the IMU (core/imu_gap.h) between two samples.
struct ImuSilence {
  TimeNs begin_ns = 0;   ///< stamp of the sample before it
  TimeNs end_ns = 0;     ///< and after it
  TimeNs excess_ns = 0;  ///< its length less the usual step
};

/// Inertial samples in the order of their stamps, whatever the order they arrive in, with a mark up to which
/// they are delivered.
class ImuStream {
 public:
  enum class Arrival { kTaken, kTwice, kTooLate };

  /// guard: samples are mended as they are delivered (ImuGuard). The last one of a delivery is checked
  /// without its successor, whether that has arrived or not.
  /// implied: see ImuGuard; may be null.
  explicit ImuStream(bool guard, const ImpliedImu* implied = nullptr) : guarded_(guard), guard_(implied) {}

  /// Sorts the sample in. kTooLate: it is not after the last delivered one.
  Arrival Add(const ImuSample& sample);

  /// The next sample to deliver to what happens at `stamp_ns`: the samples up to and including the first one
  /// at or after it, one a call; null when they are delivered or there is none left. Valid until the next
  /// call.
  const ImuSample* Deliver(TimeNs stamp_ns);
  /// What was found at the last delivered sample, reported once; empty: nothing.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  /// Of the samples delivered so far.
  [[nodiscard]] const ImuGuard& guard() const { return guard_; }
  /// Takes out the oldest sample that is not delivered yet when it lies before `stamp_ns`; later samples not
  /// after it are too late.
  std::optional<ImuSample> PassOver(TimeNs stamp_ns);

  /// Stamp of the first sample at or after `stamp_ns`, if there is one.
  [[nodiscard]] std::optional<TimeNs> FirstAtOrAfter(TimeNs stamp_ns) const;
  /// The longest silence that FirstSilence finds.
  static constexpr double kMostSilenceS = 2;
  /// The first silence of at least four usual steps that begins before `stamp_ns`, ends after `after_ns` and
  /// with a sample that is not delivered yet. Nothing where the usual step is not known.
  [[nodiscard]] std::optional<ImuSilence> FirstSilence(TimeNs after_ns, TimeNs stamp_ns) const;
  /// The IMU's clock has jumped: the samples from `silence` on lie its excess earlier.
  void TakeBack(const ImuSilence& silence);
  /// INT64_MIN before the first sample.
  [[nodiscard]] TimeNs newest_ns() const { return newest_ns_; }
  [[nodiscard]] Eigen::Vector3d newest_gyro() const { return guard_.InRadians(newest_gyro_); }
  [[nodiscard]] TimeNs delivered_ns() const { return delivered_ns_; }
  /// The samples from the one before the last not after `stamp_ns` on (from the first there is, where there
  /// are fewer), up to the last delivered one or to the newest: what ImuBuffer needs for an interval from
  /// there.
  [[nodiscard]] std::vector<ImuSample> DeliveredSince(TimeNs stamp_ns) const;
  [[nodiscard]] std::vector<ImuSample> Since(TimeNs stamp_ns) const;

  /// Forgets delivered samples that DeliveredSince(stamp_ns) does not need.
  void DropBefore(TimeNs stamp_ns);
  [[nodiscard]] size_t size() const { return samples_.size(); }

 private:
  /// Median step of the samples before the one with this index; nothing with too few.
  [[nodiscard]] std::optional<TimeNs> UsualStep(size_t before) const;
  [[nodiscard]] std::vector<ImuSample> Range(TimeNs stamp_ns, size_t end) const;

  std::deque<ImuSample> samples_;
  bool guarded_;
  ImuGuard guard_;
  std::string fault_;
  size_t delivered_ = 0;  ///< of samples_
  TimeNs delivered_ns_ = INT64_MIN;
  TimeNs newest_ns_ = INT64_MIN;
  Eigen::Vector3d newest_gyro_ = Eigen::Vector3d::Zero();
};

}  // namespace alidade
