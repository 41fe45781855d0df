#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/status.h"
#include "eval/dataset/dataset.h"

namespace alidade {

/// Where a sequence comes from: a folder in the extended ASL layout, or a ROS bag with the calibration that
/// the bag lacks.
struct DatasetSource {
  std::string path;
  std::string topics;                    ///< of a bag, as MakeBagTopics takes them
  std::vector<std::string> calibration;  ///< files of other programs, before the sheets in a bag
  std::string camera = "cam0";           ///< camera to use in those files
  bool follow_links = false;             ///< of a folder, DatasetStorage::follow_links
};

/// A format of sequences: its reader, and its properties that other code depends on.
struct DatasetFormat {
  std::string_view name;       ///< in messages, with its article
  std::string_view extension;  ///< of its one file, with the dot; empty: a sequence is a folder
  bool is_asl;        ///< the extended ASL layout, with a sheet for each sensor; follow_links applies
  bool takes_topics;  ///< topics, calibration and camera apply
  Result<Dataset> (*read)(const DatasetSource& source, const DatasetStorage& storage);

  [[nodiscard]] bool is_file() const { return !extension.empty(); }
};

/// The format that the path names: by the extension of a file, which may be missing; a folder of any name is
/// in the ASL layout.
[[nodiscard]] const DatasetFormat& FormatOf(const std::string& path);
/// Whether the path exists, as a file or a folder after its format.
[[nodiscard]] bool IsDataset(const std::string& path);
/// The names of the formats with this trait, joined by "or".
[[nodiscard]] std::string FormatsWith(bool DatasetFormat::*trait);

/// Reads a sequence in its format. kUsage: invalid topics, or what does not apply to the format (topics or
/// calibration, follow_links); kInput: as the reader and ImportCalibration. A bag is read whole before it
/// goes into files.
Result<Dataset> ReadDataset(const DatasetSource& source, const DatasetStorage& storage = {});

/// SHA-256 (hex) over everything that the sequence is read from.
Result<std::string> DigestOf(const DatasetSource& source);

}  // namespace alidade
