#pragma once

#include <string>

#include "core/rig_calibration.h"
#include "core/status.h"
#include "eval/peers/open_vins/vio_names.h"
#include "eval/peers/peer_flags.h"

namespace alidade::open_vins {

/// The system's settings: its own file `config/<--config>/estimator_config.yaml` of the checkout, with one
/// camera and the calibration of `rig` in place of that file's, without threads, and without limits of time
/// in its initialisation, so that equal inputs give equal results. Flags that are not "own" replace more of
/// it. kUsage: an invalid flag; kInput: no such file, or a lens model that the system has not.
Result<vio::VioManagerOptions> MakeSettings(const PeerFlags& flags, const RigCalibration& rig);

}  // namespace alidade::open_vins
