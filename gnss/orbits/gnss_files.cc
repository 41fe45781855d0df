#include "gnss/orbits/gnss_files.h"

#include "gnss/formats/rinex_navigation.h"

namespace alidade {

Result<std::shared_ptr<const SatelliteCatalog>> LoadSatelliteCatalog(const GnssFiles& files,
                                                                     ReaderWarnings* warnings) {
  if (files.navigation.empty()) {
    return Status::Input("no navigation file is given, expected at least one");
  }
  NavigationData navigation;
  for (const std::string& path : files.navigation) {
    Result<NavigationData> data = ReadRinexNavigation(path);
    if (!data.ok()) {
      return data.status();
    }
    navigation.Merge(*std::move(data));
  }
  PreciseProducts products;
  const auto add = [&products](Result<PreciseProducts>&& more) {
    if (!more.ok()) {
      return more.status();
    }
    products.Merge(*std::move(more));
    return Status::Ok();
  };
  for (const std::string& path : files.orbits) {
    ALIDADE_RETURN_IF_ERROR(add(ReadSp3(path)));
  }
  for (const std::string& path : files.clocks) {
    ALIDADE_RETURN_IF_ERROR(add(ReadRinexClock(path)));
  }
  warnings->Merge(std::move(navigation.warnings));
  warnings->Merge(std::move(products.warnings));
  return std::shared_ptr<const SatelliteCatalog>(
      std::make_shared<SatelliteCatalog>(std::move(navigation), std::move(products)));
}

}  // namespace alidade
