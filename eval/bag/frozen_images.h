#pragma once

#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_findings.h"

namespace alidade {

/// Decodes a sample of the images, spread evenly over the sequence, and compares them: a fault where all are
/// equal to the pixel. A camera has noise even at rest; one that is frozen or covered from the start has not.
/// An error, or a warning where an estimator may do without the camera (ReportUseless), or where the IMU is
/// at rest between the first and the last of the sample in all but a tenth of its seconds (QuietSeconds):
/// equal images are then what a render without noise has, or a video whose encoder removes it. Nothing where
/// tracks are given, since the images are not used, nor from fewer than three images that can be read.
void CheckFrozenImages(const Dataset& dataset, Findings* findings);

}  // namespace alidade
