#pragma once

#include <string>

#include "eval/record/run_result.h"
#include "eval/run/session_event.h"

namespace alidade {

/// Makes a RunResult of what a session reports: a record a frame or, without a camera, an epoch.
class RunBuilder {
 public:
  /// spool_folder: see RunOptions.
  RunBuilder(bool camera, const std::string& spool_folder);

  void Take(const SessionEvent& event);

  /// Lost, and no new start found since.
  [[nodiscard]] bool lost() const { return lost_; }
  /// Why the run ends lost.
  [[nodiscard]] std::string LostMessage() const;
  [[nodiscard]] RunResult& result() { return result_; }

 private:
  void On(const StartedEvent& event);
  void On(const StateEvent& event);
  void On(const SuspectEvent& event);
  void On(const DegradedEvent& event);
  void On(const LostEvent& event);
  void On(const RestartedEvent& event);
  void On(const AlignedEvent& event);
  void On(const SatellitesEvent& event);
  void On(const WaitingEvent& event);
  void On(const TooLateEvent& event);
  void On(const SkippedEvent& event);
  void On(const FailedEvent& event);
  /// Moves all records but the newest out of memory, when there are many.
  void Spool();
  /// The run ends when its records cannot be kept.
  void Keep(Status status);
  /// Of the newest record, unless stated otherwise.
  void Mark(const char* status, const std::string& reason);

  bool camera_;
  RunResult result_;
  FrameStatistics epochs_;  ///< of the messages between frames since the last record
  bool lost_ = false;
  bool restarted_ = false;  ///< the next record is the first of a new start
  std::string refusal_;     ///< of the last attempt to start again
};

}  // namespace alidade
