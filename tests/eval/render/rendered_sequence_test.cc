#include "eval/render/rendered_sequence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <utility>
#include <vector>

#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/dataset/digest.h"
#include "eval/files/hash.h"
#include "eval/render/drawn_truth.h"
#include "eval/render/hall_file.h"
#include "eval/simulation/simulator.h"
#include "eval/trajectory/trajectory_reader.h"
#include "tests/eval/render/rendered_scene.h"
#include "tests/support/steps.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::ExcessVariance;
using test::FrameWith;
using test::MeanGrey;
using test::Quantile;
using test::RenderedConfig;
using test::ReprojectionErrors;
using test::Scene;
using test::Sharpness;
using test::SmallConfig;

TEST(RenderedSequence, TrackedCornersFitTheTruthWithinATenthOfAPixel) {
  const Scene scene = Scene::Make(RenderedConfig());
  const Result<std::vector<TrackFrame>> frames =
      TrackRenderedImages(scene.sequence, scene.dataset(), FrontendConfig(), {.jobs = 2});
  ASSERT_TRUE(frames.ok()) << frames.message();
  const std::vector<double> errors = ReprojectionErrors(scene, *frames);
  ASSERT_GT(errors.size(), 100 * (frames->size() - 1)) << "of 150 tracks most live on";
  std::cout << errors.size() << " observations; reprojection error median " << Quantile(errors, 0.5)
            << " px, 90 % " << Quantile(errors, 0.9) << " px, 99 % " << Quantile(errors, 0.99) << " px\n";
  EXPECT_LT(Quantile(errors, 0.5), 0.1);
  // Corners between a near and a far surface.
  EXPECT_LT(Quantile(errors, 0.9), 1.0);
}

TEST(RenderedSequence, RaysMeetTheSurfacesOfTheHall) {
  // The renderer's short cuts (single precision, cones, sorted boxes) against the plain intersection.
  const Scene scene = Scene::Make(SmallConfig());
  const Hall& hall = scene.sequence.hall();
  ASSERT_GT(hall.boxes.size(), 20U);
  ASSERT_GE(hall.columns.size(), 1U);
  const CameraModel& camera = scene.dataset().rig.camera;
  const Pose T_WC = scene.CameraAt(scene.sequence.stamps().front());
  std::vector<Eigen::Vector3f> rays;
  for (int y = 0; y < camera.height_px(); ++y) {
    for (int x = 0; x < camera.width_px(); ++x) {
      Vector2d place = Vector2d::Zero();
      camera.Unproject(Vector2d(x, y), &place);
      rays.push_back(place.homogeneous().normalized().cast<float>());
    }
  }
  const ViewTile field = ViewTile::Around(rays);
  const HallView view(hall, T_WC, field, 0);
  std::vector<HallView::Candidate> candidates;
  view.ListCandidates(field, &candidates);
  std::size_t off = 0, on_room = 0;
  for (const Eigen::Vector3f& ray : rays) {
    const HallHit hit = view.Cast(ray, candidates);
    const double distance = hall.Distance(T_WC.translation, T_WC.rotation * ray.cast<double>());
    off += std::abs(static_cast<double>(hit.distance) - distance) > 1e-4 * distance ? 1 : 0;
    on_room += hit.surface >= hall.room.faces.data() && hit.surface < hall.room.faces.data() + 6 ? 1 : 0;
  }
  EXPECT_LT(off, 5U) << "rays that graze an edge may differ";
  EXPECT_GT(on_room, rays.size() / 10);
  EXPECT_LT(on_room, rays.size() * 9 / 10) << "boxes and columns cover some of the walls";
}

TEST(RenderedSequence, NothingStandsInThePath) {
  SimulatorConfig config = SmallConfig();
  config.duration_s = 20;
  config.path_m = 26;
  const Scene scene = Scene::Make(config);
  for (const double time_s : test::Steps(0, config.duration_s, 0.1)) {
    const Vector3d p_WB = scene.simulation.motion->At(time_s).nav.p_WB;
    for (int i = 0; i < 200; ++i) {
      // Evenly over the sphere (Fibonacci).
      const double z = 1 - (2 * i + 1) / 200.0;
      const double azimuth = 2.399963229728653 * i;
      const double flat = std::sqrt(1 - z * z);
      const Vector3d direction(flat * std::cos(azimuth), flat * std::sin(azimuth), z);
      ASSERT_GT(scene.sequence.hall().Distance(p_WB, direction), config.landmark_min_distance_m - 0.01);
    }
  }
}

TEST(RenderedSequence, ALongExposureBlursAFastTurn) {
  const GreyImage sharp = FrameWith([](RenderConfig* render) { render->exposure_s = 0; });
  const GreyImage blurred = FrameWith([](RenderConfig* render) { render->exposure_s = 0.2; });
  EXPECT_LT(Sharpness(blurred), 0.6 * Sharpness(sharp));
  EXPECT_NEAR(MeanGrey(blurred), MeanGrey(sharp), 3);
}

TEST(RenderedSequence, BrightnessAndNoiseAreThoseOfTheirKeys) {
  const GreyImage plain = FrameWith([](RenderConfig*) {});
  const GreyImage dark = FrameWith([](RenderConfig* render) { render->brightness = 0.5; });
  EXPECT_NEAR(MeanGrey(dark), 0.5 * MeanGrey(plain), 1);
  const GreyImage noisy = FrameWith([](RenderConfig* render) {
    render->read_noise_grey = 3;
    render->shot_noise_grey = 0.1;
  });
  EXPECT_NEAR(ExcessVariance(plain, noisy, 9, 0.1), 1.0 / 6, 0.5);
}

TEST(RenderedSequence, ThreadsChangeNoByteAndTheFolderReadsBack) {
  const Scene scene = Scene::Make(SmallConfig());
  const test::TemporaryFolder one, three;
  for (const auto& [folder, jobs] : {std::pair(&one, 1), std::pair(&three, 3)}) {
    ASSERT_TRUE(WriteDataset(scene.dataset(), folder->path()).ok());
    ASSERT_TRUE(WriteRenderedImages(scene.sequence, folder->path(), {.jobs = jobs}).ok());
  }
  EXPECT_EQ(DigestOfFolder(one.path()).value(), DigestOfFolder(three.path()).value());

  const Dataset read = ReadDataset(one.path()).value();
  ASSERT_EQ(read.images.size(), 21U);
  EXPECT_TRUE(read.frames.empty()) << "the front end makes them";
  const GreyImage image = ReadGreyImage(read.images[7].path).value();
  EXPECT_EQ(image.pixels, scene.sequence.Frame(7).pixels);

  const Vector3d p_W = scene.CameraAt(scene.sequence.stamps()[5]).translation;
  EXPECT_EQ(ReadHall(HallPath(one.path()))->Distance(p_W, Vector3d::UnitX()),
            scene.sequence.hall().Distance(p_W, Vector3d::UnitX()));
  const Trajectory poses = ReadTrajectory(CameraPosesPath(one.path())).value();
  ASSERT_EQ(poses.points.size(), 21U);
  EXPECT_EQ(poses.points[5].stamp_ns, scene.sequence.stamps()[5]);
  EXPECT_LT((poses.points[5].nav.p_WB - p_W).norm(), 1e-12);

  // Tracks from files and from memory are the same measurement log.
  const std::vector<TrackFrame> from_files = TrackImages(read, FrontendConfig(), {}).value();
  const std::vector<TrackFrame> from_memory =
      TrackRenderedImages(scene.sequence, scene.dataset(), FrontendConfig(), {.jobs = 2}).value();
  EXPECT_EQ(DigestOf({read.rig, read.imu, from_files}), DigestOf({read.rig, read.imu, from_memory}));
}

TEST(RenderedSequence, SeedsDrawOtherHallsAndNoise) {
  const std::vector<unsigned char> first = Scene::Make(SmallConfig(), 3).sequence.Frame(0).pixels;
  EXPECT_EQ(first, Scene::Make(SmallConfig(), 3).sequence.Frame(0).pixels);
  EXPECT_NE(first, Scene::Make(SmallConfig(), 4).sequence.Frame(0).pixels);
}

TEST(RenderedSequence, WallsNearerThanTheClearanceAreRefused) {
  SimulatorConfig config = SmallConfig();
  config.room_margin_m.z() = 0.7;
  const Simulation simulation = SimulateWithMotion(config, 1).value();
  const Result<RenderedSequence> sequence = RenderedSequence::Create(config, simulation, 1);
  ASSERT_FALSE(sequence.ok());
  EXPECT_EQ(sequence.code(), StatusCode::kConfig);
  EXPECT_NE(sequence.message().find("room_margin_m"), std::string::npos) << sequence.message();
}

TEST(RenderedSequence, MoreThanOneCameraIsRefused) {
  SimulatorConfig config = SmallConfig();
  config.camera_count = 2;
  EXPECT_EQ(config.Validate().code(), StatusCode::kConfig);
}

}  // namespace
}  // namespace alidade
