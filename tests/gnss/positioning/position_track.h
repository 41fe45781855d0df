#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "gnss/base/geodesy.h"
#include "gnss/base/text_file.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {

/// Positions in ECEF by GPST stamp.
using PositionTrack = std::map<TimeNs, Eigen::Vector3d>;

/// RTKLIB's .pos text with calendar times, latitude, longitude and height.
inline PositionTrack ParsePositionFile(const std::string& text) {
  PositionTrack track;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::string words = line;
    for (char& c : words) {
      c = c == '/' || c == ':' ? ' ' : c;
    }
    std::string_view rest = words;
    const Result<CalendarTime> label =
        line.starts_with('%') ? Result<CalendarTime>(Status::Input("")) : ParseCalendar(rest);
    if (!label.ok()) {
      continue;
    }
    for (int i = 0; i < 6; ++i) {
      (void)NextWord(&rest);
    }
    double values[3] = {};
    for (double& value : values) {
      value = ParseReal(NextWord(&rest)).value_or(std::nan(""));
    }
    track[*GpsTimeFromCalendar(TimeScale::kGps, *label)] =
        ToEcef({values[0] * M_PI / 180, values[1] * M_PI / 180, values[2]});
  }
  return track;
}

/// RTKLIB's own solution (Debian package rtklib); empty where it is not installed. `systems` is RTKLIB's sum:
/// 1 GPS, 4 GLONASS, 8 Galileo, 16 QZSS, 32 BeiDou.
inline PositionTrack RtklibSinglePoint(int systems, int elevation_mask_deg, const std::string& files) {
  const TemporaryFolder folder;
  const std::string config = folder.Write(
      "rtk.conf",
      "pos1-posmode=single\npos1-frequency=l1\npos1-ionoopt=brdc\npos1-tropopt=saas\npos1-navsys=" +
          std::to_string(systems) + "\npos1-elmask=" + std::to_string(elevation_mask_deg) +
          "\nout-timesys=gpst\nout-timeform=hms\nout-timendec=3\nout-solformat=llh\n");
  const std::string command =
      "rnx2rtkp -k " + config + " -o " + folder.File("out.pos") + " " + files + " >/dev/null 2>&1";
  // It exits with 0 whatever happens: what counts is what it wrote.
  return std::system(command.c_str()) == 0 ? ParsePositionFile(ReadFile(folder.File("out.pos")))
                                           : PositionTrack();
}

/// Mean and root mean square of positions against a reference, in its ENU axes.
struct TrackStatistics {
  int count = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d rms = Eigen::Vector3d::Zero();
  [[nodiscard]] double rms_3d() const { return rms.norm(); }
};

inline TrackStatistics Compare(const PositionTrack& track, const Eigen::Vector3d& reference_E) {
  const EnuFrame frame = EnuFrame::At(reference_E);
  TrackStatistics s;
  for (const auto& [stamp, position] : track) {
    const Eigen::Vector3d error = frame.FromEcef(position);
    s.mean += error;
    s.rms += error.cwiseAbs2();
    ++s.count;
  }
  s.mean /= std::max(s.count, 1);
  s.rms = (s.rms / std::max(s.count, 1)).cwiseSqrt();
  return s;
}

}  // namespace alidade::test
