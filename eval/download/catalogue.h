#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "eval/download/expected_file.h"

namespace alidade {

/// A file of a published data set.
struct CatalogueFile {
  std::string name;  ///< by which it is asked for: "room1"
  std::string file;  ///< its name on disk
  std::string path;  ///< appended to the base of its data set
  ExpectedFile expected;
  std::string size;      ///< as stated by the publisher where that is not exact: "20.5 GB"
  std::string contents;  ///< empty: clear from the name
};

/// A published data set.
struct CatalogueDataset {
  std::string name;  ///< of a folder: "tumvi"
  std::string title;
  std::string page;     ///< where it is described
  std::string licence;  ///< empty: not known
  std::string size;     ///< of all of it, as stated; empty: not known
  std::string convert;  ///< how it is read or converted
  std::string base;     ///< first part of every URL; empty: nothing can be fetched directly
  std::vector<CatalogueFile> files;
};

/// Reads a catalogue (configs/data/catalogue.yaml describes the keys). Errors (kConfig): file:line:column
/// and what was expected: an unknown, missing or ill-typed key, a name used twice or with characters that are
/// none of a folder's, a digest of a wrong length, a base that is neither http nor https.
Result<std::vector<CatalogueDataset>> ReadCatalogue(const std::string& path);

/// A data set, and which of its files are meant.
struct CatalogueChoice {
  const CatalogueDataset* dataset = nullptr;
  std::vector<const CatalogueFile*> files;
};
/// "tumvi": all files, "tumvi/room1": that one. Error (kUsage): an unknown name, with a suggestion.
Result<CatalogueChoice> ChooseFiles(const std::vector<CatalogueDataset>& catalogue, const std::string& name);

}  // namespace alidade
