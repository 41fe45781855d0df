#pragma once

#include <string>

#include "core/status.h"
#include "eval/files/strict_yaml.h"

namespace alidade {

/// Files of VINS-Mono and VINS-Fusion as parts of sensor.yaml, whose reader holds the values against what
/// they may be. `root` is the map of one file, `camera` chooses among its cameras: cam0, cam1.

/// The key by which a configuration names the file with the camera's lens: cam0_calib.
[[nodiscard]] std::string VinsLensKey(const std::string& camera);

/// Whether this configuration names the file of any camera.
[[nodiscard]] bool NamesVinsLens(const YAML::Node& root);

/// gyr_n, gyr_w, acc_n, acc_w: deviations of single samples, not densities.
[[nodiscard]] std::string TranslateVinsImu(const YAML::Node& root);

/// A lens, without extrinsics.
///
///   model_type PINHOLE, MEI, KANNALA_BRANDT as radial-tangential, mei, equidistant; image_width,
///   image_height; projection_parameters, distortion_parameters, mirror_parameters
///
/// Errors (kInput): another model_type, a key that is missing.
Result<std::string> TranslateVinsCamera(const std::string& path, const YAML::Node& root);

struct VinsExtrinsics {
  std::string extrinsics;  ///< empty: the file has none
  std::string offset;      ///< likewise
};

/// body_T_cam0, or extrinsicRotation and extrinsicTranslation; td. VINS keeps them apart from the camera's
/// own file.
[[nodiscard]] VinsExtrinsics TranslateVinsExtrinsics(const YAML::Node& root, const std::string& camera);

}  // namespace alidade
