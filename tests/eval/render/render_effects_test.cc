#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/files/hash.h"
#include "eval/render/drawn_truth.h"
#include "eval/render/hall_file.h"
#include "eval/render/rendered_sequence.h"
#include "eval/simulation/simulator.h"
#include "eval/trajectory/trajectory_reader.h"
#include "tests/eval/render/rendered_scene.h"
#include "tests/support/steps.h"
#include "tests/support/temporary_folder.h"

// What makes real images hard, one effect at a time (docs/renderer.md).

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::ExcessVariance;
using test::FrameWith;
using test::MeanGrey;
using test::RenderedConfig;
using test::Scene;
using test::Sharpness;
using test::SmallConfig;

/// All effects of docs/renderer.md at once.
SimulatorConfig HardConfig() {
  SimulatorConfig config = SmallConfig();
  RenderConfig& render = config.render;
  render.brightness = 0.4;
  render.auto_exposure = true;
  render.light_contrast = 3;
  render.light_step = 0.4;
  render.light_step_period_s = 0.4;
  render.vignetting = 0.5;
  render.aperture_m = 0.002;
  render.focus_distance_m = 0.6;
  render.line_delay_s = 1e-4;
  render.repetitive_share = 0.2;
  render.bare_share = 0.3;
  render.moving_density_per_m2 = 0.3;
  render.floor_gloss = 0.2;
  render.lamp_spacing_m = 2;
  return config;
}

TEST(RenderEffects, WithAllEffectsThreadsChangeNoByteAndTheFolderReadsBack) {
  const Scene scene = Scene::Make(HardConfig());
  ASSERT_GT(scene.sequence.hall().moving.size(), 2U);
  ASSERT_EQ(scene.sequence.exposures().size(), 21U);
  const test::TemporaryFolder one, three;
  for (const auto& [folder, jobs] : {std::pair(&one, 1), std::pair(&three, 3)}) {
    ASSERT_TRUE(WriteDataset(scene.dataset(), folder->path()).ok());
    ASSERT_TRUE(WriteRenderedImages(scene.sequence, folder->path(), {.jobs = jobs}).ok());
  }
  EXPECT_EQ(DigestOfFolder(one.path()).value(), DigestOfFolder(three.path()).value());
  EXPECT_EQ(ReadDataset(one.path())->rig.line_delay_s, 1e-4);
  EXPECT_EQ(ReadTrajectory(CameraPosesPath(one.path()))->points.size(), 21U * 9);
  const Hall read = ReadHall(HallPath(one.path())).value();
  EXPECT_EQ(read.epoch_ns, scene.sequence.hall().epoch_ns);
  for (const double time_s : {0.1, 0.8}) {
    const Vector3d p_W = scene.simulation.motion->At(time_s).nav.p_WB;
    for (int i = 0; i < 100; ++i) {
      const Vector3d direction(std::cos(0.063 * i), std::sin(0.063 * i), -0.1);
      EXPECT_EQ(read.Distance(p_W, direction.normalized(), time_s),
                scene.sequence.hall().Distance(p_W, direction.normalized(), time_s));
    }
  }
}

TEST(RenderEffects, ARowOfARollingShutterIsThatOfAnImageTakenAtItsTime) {
  // Global shutters at the time of the row: the time offset moves the exposure alone.
  SimulatorConfig config = SmallConfig();
  config.render.moving_density_per_m2 = 0.3;
  config.render.line_delay_s = 2e-4;
  const GreyImage rolling = Scene::Make(config).sequence.Frame(10);
  const double offset_s = config.camera_time_offset_s;
  config.render.line_delay_s = 0;
  const GreyImage global = Scene::Make(config).sequence.Frame(10);
  for (const int row : {3, 60, 110}) {
    config.camera_time_offset_s = offset_s + 2e-4 * (row - 60);
    const GreyImage at_its_time = Scene::Make(config).sequence.Frame(10);
    int off = 0, off_global = 0;
    for (int x = 0; x < config.width_px; ++x) {
      const auto pixel = static_cast<std::size_t>(row * config.width_px + x);
      off += std::abs(rolling.pixels[pixel] - at_its_time.pixels[pixel]) > 1 ? 1 : 0;
      off_global += std::abs(rolling.pixels[pixel] - global.pixels[pixel]) > 1 ? 1 : 0;
    }
    EXPECT_LE(off, 3) << "row " << row << ": rays that graze an edge may differ";
    if (row != 60) {
      EXPECT_GT(off_global, 20) << "row " << row;
    }
  }
}

TEST(RenderEffects, TracksOfARollingShutterFitTheRowsTimes) {
  SimulatorConfig config = RenderedConfig();
  config.duration_s = 1;
  config.path_m = 1.3;
  config.render.line_delay_s = 4e-5;
  const Scene scene = Scene::Make(config);
  const test::TemporaryFolder folder;
  ASSERT_TRUE(WriteDataset(scene.dataset(), folder.path()).ok());
  ASSERT_TRUE(WriteRenderedImages(scene.sequence, folder.path(), {.jobs = 2}).ok());
  Dataset read = ReadDataset(folder.path()).value();
  const std::vector<TrackFrame> frames = TrackImages(read, FrontendConfig(), {}).value();
  const auto median_px = [&] {
    return ScoreTracks(frames, read.rig.camera, TruthOfTracks(read, frames).value(), {}).corner.median_px;
  };
  EXPECT_LT(median_px(), 0.15);
  const double by_row_px = median_px();
  read.rig.line_delay_s = 0;
  EXPECT_GT(median_px(), 2 * by_row_px) << "as if all rows were exposed at once";
}

TEST(RenderEffects, MovingBoxesKeepAwayFromTheBody) {
  SimulatorConfig config = SmallConfig();
  config.duration_s = 10;
  config.path_m = 13;
  config.render.moving_density_per_m2 = 0.3;
  const Scene scene = Scene::Make(config);
  const Hall& hall = scene.sequence.hall();
  ASSERT_GT(hall.moving.size(), 2U);
  for (const double time_s : test::Steps(0, config.duration_s, 0.05)) {
    const Vector3d p = scene.simulation.motion->At(time_s).nav.p_WB - hall.origin_W;
    for (const MovingBox& moving : hall.moving) {
      const Vector3d seen = p - moving.Shift(time_s);
      const Vector3d low = moving.box.low.cast<double>(), high = moving.box.high.cast<double>();
      EXPECT_GT((seen - seen.cwiseMax(low).cwiseMin(high)).norm(), config.landmark_min_distance_m - 0.1);
    }
  }
}

TEST(RenderEffects, WhatIsOutOfFocusIsBlurredAndNotShifted) {
  const auto with_lens = [](double focus_m) {
    return FrameWith([&](RenderConfig* render) {
      render->exposure_s = 0;
      render->samples = 16;
      render->aperture_m = 0.02;
      render->focus_distance_m = focus_m;
    });
  };
  const GreyImage pinhole = FrameWith([](RenderConfig* render) {
    render->exposure_s = 0;
    render->samples = 16;
  });
  const GreyImage near = with_lens(0.5), in_focus = with_lens(3);
  EXPECT_LT(Sharpness(near), 0.6 * Sharpness(in_focus));
  EXPECT_GT(Sharpness(in_focus), 0.7 * Sharpness(pinhole));
  EXPECT_NEAR(MeanGrey(near), MeanGrey(pinhole), 3);
}

TEST(RenderEffects, GainKeepsThePictureAndRaisesTheNoise) {
  const auto exposed = [](double gain, double noise) {
    return FrameWith([&](RenderConfig* render) {
      render->brightness = 0.8 / gain;
      render->gain = gain;
      render->read_noise_grey = noise;
      render->shot_noise_grey = 0.1 * noise;
    });
  };
  const GreyImage clean = exposed(4, 0), noisy = exposed(4, 1);
  EXPECT_NEAR(MeanGrey(clean), MeanGrey(exposed(1, 0)), 0.5);
  EXPECT_NEAR(ExcessVariance(clean, noisy, 16, 0.4), 1.0 / 6, 2);
}

TEST(RenderEffects, VignettingDarkensTheCornersByItsShare) {
  const GreyImage plain = FrameWith([](RenderConfig*) {});
  const GreyImage dark = FrameWith([](RenderConfig* render) { render->vignetting = 0.6; });
  const auto ratio_at = [&](int x, int y) {
    const auto pixel = static_cast<std::size_t>(y * plain.width_px + x);
    return dark.pixels[pixel] / static_cast<double>(plain.pixels[pixel]);
  };
  EXPECT_NEAR(ratio_at(94, 60), 1, 0.02);
  EXPECT_NEAR(ratio_at(0, 0), 0.4, 0.03);
}

TEST(RenderEffects, TheLightStepsAndExposureControlBringsTheImageBack) {
  SimulatorConfig config = SmallConfig();
  config.duration_s = 2;
  config.path_m = 0.2;
  config.render.light_step = 0.5;
  config.render.light_step_period_s = 1;
  const Scene fixed = Scene::Make(config);
  EXPECT_NEAR(MeanGrey(fixed.sequence.Frame(21)), 0.5 * MeanGrey(fixed.sequence.Frame(18)), 2);
  config.render.auto_exposure = true;
  config.render.exposure_target_grey = 90;
  const Scene controlled = Scene::Make(config);
  EXPECT_NEAR(MeanGrey(controlled.sequence.Frame(18)), 90, 9);
  EXPECT_LT(MeanGrey(controlled.sequence.Frame(21)), 60) << "the control is late";
  EXPECT_NEAR(MeanGrey(controlled.sequence.Frame(38)), 90, 9);
}

TEST(RenderEffects, TheFloorMirrorsWhatStandsOnIt) {
  // The view from below the floor against the plain intersection of the mirrored ray.
  const Scene scene = Scene::Make(SmallConfig());
  const Hall& hall = scene.sequence.hall();
  const CameraModel& camera = scene.dataset().rig.camera;
  const Pose T_WC = scene.CameraAt(scene.sequence.stamps().front());
  std::vector<Eigen::Vector3f> rays;
  for (int y = 0; y < camera.height_px(); y += 3) {
    for (int x = 0; x < camera.width_px(); x += 3) {
      Vector2d place = Vector2d::Zero();
      camera.Unproject(Vector2d(x, y), &place);
      rays.push_back(place.homogeneous().normalized().cast<float>());
    }
  }
  const ViewTile field = ViewTile::Around(rays);
  const HallView mirrored = HallView::InFloor(hall, T_WC, field, 0);
  std::vector<HallView::Candidate> candidates;
  mirrored.ListCandidates(field, &candidates);
  int off = 0, met = 0;
  for (const Eigen::Vector3f& ray : rays) {
    Vector3d direction = T_WC.rotation * ray.cast<double>();
    const double first = hall.Distance(T_WC.translation, direction);
    Vector3d place = T_WC.translation + first * direction;
    if (std::abs(place.z() - hall.origin_W.z() - static_cast<double>(hall.room.low.z())) > 1e-6) {
      continue;
    }
    direction.z() = -direction.z();
    place.z() += 1e-5;
    const double expected = first + hall.Distance(place, direction);
    const double found = static_cast<double>(mirrored.Cast(ray, candidates).distance);
    off += std::abs(found - expected) > 1e-3 ? 1 : 0;
    ++met;
  }
  EXPECT_GT(met, 60);
  EXPECT_LT(off, met / 100 + 1);
}

TEST(RenderEffects, SharesOfFacesAreBareOrRepeatTheirMotif) {
  SimulatorConfig config = SmallConfig();
  config.render.bare_share = 0.5;
  config.render.repetitive_share = 1;
  const Scene scene = Scene::Make(config);
  int bare = 0, repeated = 0, all = 0;
  for (const HallBox& box : scene.sequence.hall().boxes) {
    for (const Surface& face : box.faces) {
      bare += face.texture == static_cast<int>(TextureKind::kPaint) ? 1 : 0;
      repeated += face.texture == static_cast<int>(TextureKind::kMotif) ? 1 : 0;
      ++all;
    }
  }
  EXPECT_EQ(bare + repeated, all);
  EXPECT_NEAR(bare, 0.5 * all, 0.15 * all);
  const Texture motif = MakeTexture(TextureKind::kMotif, 8, 3);
  for (int i = 0; i < 50; ++i) {
    const float x = 1.7F * static_cast<float>(i), y = 2.3F * static_cast<float>(i);
    EXPECT_NEAR(motif.At(x, y, 0), motif.At(x + 32, y + 96, 0), 0.1);
  }
}

TEST(RenderEffects, ExposureControlThatCannotWorkIsRefused) {
  SimulatorConfig config = SmallConfig();
  config.render.auto_exposure = true;
  config.render.exposure_max_s = 0.001;
  EXPECT_EQ(config.Validate().code(), StatusCode::kConfig);
  config.render.exposure_s = 0;
  EXPECT_NE(config.Validate().message().find("render.exposure_s"), std::string::npos);
}

}  // namespace
}  // namespace alidade
