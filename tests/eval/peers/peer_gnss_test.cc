#include "eval/peers/peer_gnss.h"

#include <gtest/gtest.h>

#include "eval/bag/bag_export.h"
#include "eval/bag/dataset_source.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/simulation/simulator.h"
#include "gnss/model/gnss_epoch.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

Dataset Simulated() {
  SimulatorConfig config;
  config.start_time_s = 1'700'000'000;
  config.duration_s = 4;
  config.path_m = 8;
  config.landmark_count = 10;
  config.gnss.rate_hz = 2;
  config.gnss.time_offset_s = 0.25;
  return Simulate(config, 1).value();
}

Result<Dataset> Read(const std::string& path) {
  DatasetSource source;
  source.path = path;
  return ReadDataset(source);
}

/// Everything that the systems weigh by, in order.
std::vector<double> Numbers(const PeerGnss& gnss) {
  std::vector<double> numbers;
  for (const auto& message : gnss.ephemerides) {
    numbers.insert(numbers.end(), {static_cast<double>(message->sat), message->toe.tow, message->ura,
                                   message->A, message->n_dot});
  }
  for (const auto& message : gnss.glonass) {
    numbers.insert(numbers.end(),
                   {static_cast<double>(message->sat), message->toe.tow, message->ura, message->delta_tau_n});
  }
  for (const auto& message : gnss.ionosphere) {
    numbers.insert(numbers.end(), message->data.begin(), message->data.end());
  }
  for (const PeerGnss::Epoch& epoch : gnss.epochs) {
    numbers.push_back(static_cast<double>(epoch.stamp_ns));
    for (const gnss_comm::GnssObsMsg& m : epoch.message->meas) {
      numbers.insert(numbers.end(), {static_cast<double>(m.sat), m.psr.at(0), m.psr_std.at(0), m.dopp.at(0),
                                     m.dopp_std.at(0)});
    }
  }
  return numbers;
}

// A driver gives the same on a bag as on the folder that it was made from.
TEST(ReadPeerGnss, AFolderAndItsBagGiveTheSameMessages) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(WriteDataset(Simulated(), folder.File("sequence")).ok());
  const Result<Dataset> from_folder = Read(folder.File("sequence"));
  ASSERT_TRUE(from_folder.ok()) << from_folder.message();
  ASSERT_TRUE(WriteBag(*from_folder, {}, folder.File("sequence.bag")).ok());
  const Result<Dataset> from_bag = Read(folder.File("sequence.bag"));
  ASSERT_TRUE(from_bag.ok()) << from_bag.message();
  const Result<PeerGnss> of_folder = ReadPeerGnss(*from_folder), of_bag = ReadPeerGnss(*from_bag);
  ASSERT_TRUE(of_folder.ok()) << of_folder.message();
  ASSERT_TRUE(of_bag.ok()) << of_bag.message();
  EXPECT_EQ(Numbers(*of_folder), Numbers(*of_bag));
  EXPECT_GE(of_folder->epochs.size(), 5u);
  EXPECT_GE(of_folder->ephemerides.size(), 72u);
  EXPECT_GE(of_folder->glonass.size(), 24u);
  EXPECT_EQ(of_folder->ionosphere.size(), 1u);
  EXPECT_EQ(of_folder->unweighable, 0) << "what the simulator and convert write suits them";
  const PeerGnss::Epoch& epoch = of_folder->epochs.front();
  EXPECT_EQ(epoch.stamp_ns - epoch.tag_ns, kSecondNs / 4);
  EXPECT_EQ(epoch.tag_ns, from_folder->gnss->epochs.front().stamp_ns);
}

TEST(ReadPeerGnss, LeavesOutWhatCannotBeWeighed) {
  Dataset dataset = Simulated();
  GnssLog log = *dataset.gnss;
  NavigationData navigation = log.catalog->navigation();
  const auto satellite = [&](GnssSystem system) {
    return std::find_if(navigation.kepler.begin(), navigation.kepler.end(),
                        [&](const auto& entry) { return entry.first.system == system; });
  };
  satellite(GnssSystem::kGalileo)->second.front().accuracy_m = 2;
  satellite(GnssSystem::kGps)->second.front().accuracy_m = 1;
  satellite(GnssSystem::kBeidou)->second.front().accuracy_m = 1.5;
  log.catalog = std::make_shared<const SatelliteCatalog>(navigation);
  log.epochs.front().satellites.front().signals.front().doppler_hz.reset();
  dataset.gnss = std::make_shared<const GnssLog>(log);
  const Result<PeerGnss> whole = ReadPeerGnss(Simulated()), gnss = ReadPeerGnss(dataset);
  ASSERT_TRUE(gnss.ok()) << gnss.message();
  EXPECT_EQ(gnss->unweighable, 3) << "Galileo's, GPS's, and a satellite without Doppler";
  EXPECT_EQ(gnss->ephemerides.size() + 2, whole->ephemerides.size());
  EXPECT_EQ(gnss->epochs.front().message->meas.size() + 1, whole->epochs.front().message->meas.size());
}

TEST(ReadPeerGnss, WithoutGnssThereIsNothing) {
  Dataset dataset = Simulated();
  dataset.gnss = nullptr;
  const Result<PeerGnss> gnss = ReadPeerGnss(dataset);
  ASSERT_TRUE(gnss.ok()) << gnss.message();
  EXPECT_TRUE(gnss->epochs.empty() && gnss->ephemerides.empty());
}

}  // namespace
}  // namespace alidade
