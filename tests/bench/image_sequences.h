#pragma once

#include <string>
#include <vector>

#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/render/rendered_sequence.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "tests/support/shared_data.h"

namespace alidade::test {

/// Decoded images of one camera in flight, with the rig and the IMU of their sequence.
struct ImageSequence {
  Dataset dataset;
  std::vector<TimeNs> stamps;  ///< one an image
  std::vector<GreyImage> images;
};

/// Images of a rendered sequence.
struct RenderedPart {
  std::string config;  ///< of the simulation, below configs/datasets
  std::vector<std::string> settings;
  std::size_t first = 0;  ///< image
  std::size_t images = 0;
};

inline Result<ImageSequence> Render(const RenderedPart& part, unsigned seed) {
  const Result<SimulatorConfig> config = LoadSimulatorConfig(
      std::string(ALIDADE_SOURCE_DIR) + "/configs/datasets/" + part.config, part.settings);
  ALIDADE_RETURN_IF_ERROR(config.status());
  Result<Simulation> simulation = SimulateWithMotion(*config, seed);
  ALIDADE_RETURN_IF_ERROR(simulation.status());
  const Result<RenderedSequence> rendered = RenderedSequence::Create(*config, *simulation, seed);
  ALIDADE_RETURN_IF_ERROR(rendered.status());
  if (rendered->stamps().size() < part.first + part.images) {
    return Status::Input(part.config + ": shorter than the part that is rendered");
  }
  ImageSequence sequence;
  for (std::size_t i = part.first; i < part.first + part.images; ++i) {
    sequence.stamps.push_back(rendered->stamps()[i]);
    sequence.images.push_back(rendered->Frame(i));
  }
  sequence.dataset = std::move(simulation->dataset);
  return sequence;
}

/// kInput: there is no shared data.
inline Result<std::string> SharedSequence(const std::string& name) {
  if (SharedDir().empty()) {
    return Status::Input("real data is absent: set ALIDADE_SHARED_DIR or put it at ../shared");
  }
  return SharedDir() + "/data/" + name;
}

/// The figure-8 of EuRoC's size, speed and lens, without effects: 4 s after its start from rest.
inline Result<ImageSequence> RenderedFigureEight() {
  return Render({.config = "hard_pixels/easy.yaml", .settings = {}, .first = 100, .images = 80}, 901);
}

/// Rendered along the flight of V1_02: 4 s of it.
inline Result<ImageSequence> RenderedV102() {
  const Result<std::string> path = SharedSequence("euroc/V1_02_medium");
  ALIDADE_RETURN_IF_ERROR(path.status());
  return Render({.config = "rendered.yaml",
                 .settings = {"hybrid_dataset=" + *path, "duration_s=24"},
                 .first = 380,
                 .images = 80},
                901);
}

/// The real flight: 90 images of V1_01.
inline Result<ImageSequence> RealFlight() {
  const Result<std::string> path = SharedSequence("real_images/v1_01_flight_4s");
  ALIDADE_RETURN_IF_ERROR(path.status());
  ImageSequence sequence;
  Result<Dataset> dataset = ReadDataset(*path);
  ALIDADE_RETURN_IF_ERROR(dataset.status());
  sequence.dataset = *std::move(dataset);
  for (const ImageEntry& entry : sequence.dataset.images) {
    Result<GreyImage> image = ReadGreyImage(entry.path);
    ALIDADE_RETURN_IF_ERROR(image.status());
    sequence.stamps.push_back(entry.stamp_ns);
    sequence.images.push_back(*std::move(image));
  }
  return sequence;
}

}  // namespace alidade::test
