#include "eval/peers/vins/tracker.h"

#include <camodocal/camera_models/EquidistantCamera.h>
#include <feature_tracker.h>

namespace alidade::vins {
namespace {

camodocal::CameraPtr MakeCamera(const CameraModel& camera) {
  const Eigen::Vector4d& f = camera.intrinsics();
  const LensCoefficients& k = camera.coefficients();
  const int width = camera.width_px(), height = camera.height_px();
  switch (camera.model()) {
    case DistortionModel::kNone:
    case DistortionModel::kRadialTangential:
      return camodocal::CameraPtr(new camodocal::PinholeCamera("camera", width, height, k[0], k[1], k[2],
                                                               k[3], f[0], f[1], f[2], f[3]));
    case DistortionModel::kEquidistant:
      return camodocal::CameraPtr(new camodocal::EquidistantCamera("camera", width, height, k[0], k[1], k[2],
                                                                   k[3], f[0], f[1], f[2], f[3]));
    case DistortionModel::kMei:
      return camodocal::CameraPtr(new camodocal::CataCamera("camera", width, height, k[0], k[1], k[2], k[3],
                                                            k[4], f[0], f[1], f[2], f[3]));
    case DistortionModel::kFov:
    case DistortionModel::kDoubleSphere:
    case DistortionModel::kEucm:
      break;
  }
  return {};
}

Eigen::Vector2d VectorOf(const cv::Point2f& point) {
  return {point.x, point.y};
}

class OwnTracker : public Tracker {
 public:
  explicit OwnTracker(camodocal::CameraPtr camera) { tracker_.m_camera = std::move(camera); }

  std::vector<VinsFeature> Track(const GreyImage& image, double time_s, bool hand_over) override {
    PUB_THIS_FRAME = hand_over;
    // It keeps references to images.
    const cv::Mat pixels(image.height_px, image.width_px, CV_8UC1,
                         const_cast<unsigned char*>(image.pixels.data()));
    tracker_.readImage(pixels.clone(), time_s);
    for (unsigned int i = 0; tracker_.updateID(i); ++i) {
    }
    std::vector<VinsFeature> features;
    for (size_t i = 0; hand_over && i < tracker_.ids.size(); ++i) {
      if (tracker_.track_cnt[i] > 1) {
        features.push_back({tracker_.ids[i], VectorOf(tracker_.cur_un_pts[i]), VectorOf(tracker_.cur_pts[i]),
                            VectorOf(tracker_.pts_velocity[i])});
      }
    }
    return features;
  }

  [[nodiscard]] Eigen::Vector3d Ray(const Eigen::Vector2d& pixel) const override {
    Eigen::Vector3d ray;
    tracker_.m_camera->liftProjective(pixel, ray);
    return ray;
  }

 private:
  FeatureTracker tracker_;
};

}  // namespace

Result<std::unique_ptr<Tracker>> Tracker::Create(const CameraModel& camera, const TrackerSettings& settings) {
  camodocal::CameraPtr made = MakeCamera(camera);
  if (!made) {
    return Status::Input("the tracker of VINS-Mono and GVINS has no lens model fov");
  }
  cv::setNumThreads(1);
  MAX_CNT = settings.max_features;
  MIN_DIST = settings.min_distance_px;
  F_THRESHOLD = settings.ransac_px;
  EQUALIZE = settings.equalize ? 1 : 0;
  FISHEYE = 0;
  ROW = camera.height_px();
  COL = camera.width_px();
  FOCAL_LENGTH = 460;
  return std::unique_ptr<Tracker>(new OwnTracker(std::move(made)));
}

}  // namespace alidade::vins
