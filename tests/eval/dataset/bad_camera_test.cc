#include "tests/eval/dataset/bad_sequence_fixture.h"
#include "tests/support/good_sequence.h"

// Ways in which the files of a camera can be wrong.

namespace alidade {
namespace {

using test::BadSequence;
using test::CameraYaml;
using test::FileCase;
using test::kIdentity;
using test::kNoLens;
using test::kTracksHeader;

std::string Tracks(const std::string& rows) {
  return kTracksHeader + rows;
}

const FileCase kCameraCases[] = {
    {"missing camera sheet", "cam0/sensor.yaml", "", {"cam0/sensor.yaml", "No such file"}},
    {"not YAML",
     "cam0/sensor.yaml",
     "sensor_type: camera\nT_BS: [1, 2\n",
     {"sensor.yaml:", "not valid YAML"}},
    {"scaled rotation",
     "cam0/sensor.yaml",
     CameraYaml("[2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]", kNoLens),
     {"sensor.yaml:4:3", "T_BS", "rigid", "determinant of its rotation is 8", "orthogonality error 3"}},
    {"mirrored rotation",
     "cam0/sensor.yaml",
     CameraYaml("[-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]", kNoLens),
     {"T_BS", "determinant of its rotation is -1"}},
    {"column-major transform",
     "cam0/sensor.yaml",
     CameraYaml("[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.1, 0.2, 0.3, 1]", kNoLens),
     {"T_BS", "last row 0 0 0 1"}},
    {"fifteen numbers",
     "cam0/sensor.yaml",
     CameraYaml("[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0]", kNoLens),
     {"T_BS", "16 numbers, not 15"}},
    {"NaN in the transform",
     "cam0/sensor.yaml",
     CameraYaml("[1, 0, 0, .nan, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]", kNoLens),
     {"T_BS", "entry 4", "finite"}},
    {"Kalibr's name of the lens",
     "cam0/sensor.yaml",
     CameraYaml(kIdentity, "distortion_model: radtan\n"),
     {"sensor.yaml:9:19", "'radtan'", "radial-tangential, equidistant, fov, mei, double-sphere, eucm, none"}},
    {"too few coefficients",
     "cam0/sensor.yaml",
     CameraYaml(kIdentity, "distortion_model: equidistant\ndistortion_coefficients: [0.1, 0.2]\n"),
     {"sensor.yaml", "equidistant takes 4, found 2"}},
    {"a sphere too far away",
     "cam0/sensor.yaml",
     CameraYaml(kIdentity, "distortion_model: double-sphere\ndistortion_coefficients: [1.5, 0.5]\n"),
     {"sensor.yaml", "distortion_coefficients", "xi must lie in (-1, 1], found 1.5"}},
    {"alpha above one",
     "cam0/sensor.yaml",
     CameraYaml(kIdentity, "distortion_model: eucm\ndistortion_coefficients: [1.5, 1]\n"),
     {"sensor.yaml", "distortion_coefficients", "alpha must lie in [0, 1], found 1.5"}},
    {"lens key twice",
     "cam0/sensor.yaml",
     CameraYaml(kIdentity, kNoLens + kNoLens),
     {"sensor.yaml:10:1", "duplicate"}},
    {"line delay in microseconds",
     "cam0/sensor.yaml",
     CameraYaml(kIdentity, kNoLens + "line_delay_s: 29.7\n"),
     {"sensor.yaml:10:15", "line_delay_s", "'29.7'", "rows within 0.2 s"}},
    {"line delay that is no number",
     "cam0/sensor.yaml",
     CameraYaml(kIdentity, kNoLens + "line_delay_s: .nan\n"),
     {"sensor.yaml:10:15", "line_delay_s", "'.nan'", "a finite number"}},
    {"line delay without bounds",
     "cam0/sensor.yaml",
     CameraYaml(kIdentity, kNoLens + "line_delay_s: -1e300\n"),
     {"sensor.yaml:10:15", "line_delay_s", "'-1e300'", "at least -0.2"}},
    {"two extrinsics",
     "cam0/sensor.yaml",
     CameraYaml(kIdentity, kNoLens + "T_cam_imu: " + kIdentity + "\n"),
     {"sensor.yaml:10:", "T_cam_imu", "no second transform beside T_BS"}},
    {"half a pixel of width",
     "cam0/sensor.yaml",
     "T_BS: " + std::string(kIdentity) +
         "\nresolution: [640.5, 480]\nintrinsics: [1, 1, 0, 0]\ndistortion_model: none\n",
     {"sensor.yaml:2:13", "resolution"}},
    {"octal-looking focal length",
     "cam0/sensor.yaml",
     "T_BS: " + std::string(kIdentity) +
         "\nresolution: [640, 480]\nintrinsics: [0400, 1, 0, 0]\ndistortion_model: none\n",
     {"sensor.yaml:3:13", "intrinsics", "'0400'", "octal"}},
    {"no tracks, images or stamps",
     "cam0/tracks.csv",
     "",
     {"cam0", "expected tracks.csv, data.csv with images, or timestamps.csv"}},
    {"track twice in a frame",
     "cam0/tracks.csv",
     Tracks("1000,7,1,2\n1000,8,1,2\n1000,7,3,4\n"),
     {"tracks.csv:2", "track_id 7", "twice"}},
    {"track frames go back",
     "cam0/tracks.csv",
     Tracks("2000,1,1,2\n1000,1,1,2\n"),
     {"tracks.csv:3", "'1000'", "later than 2000"}},
    {"negative track id", "cam0/tracks.csv", Tracks("2000,-1,1,2\n"), {"tracks.csv:2", "track_id", "'-1'"}},
    {"track id is no integer",
     "cam0/tracks.csv",
     Tracks("2000,1.0,1,2\n"),
     {"tracks.csv:2", "column 2 (track_id)", "'1.0'"}},
    {"tracks on the normalised plane",
     "cam0/tracks.csv",
     "#timestamp [ns],track_id,u [-],v [-]\n",
     {"tracks.csv:1", "u [px]"}},
    {"stamps without the tracks' frames",
     "cam0/timestamps.csv",
     "#timestamp [ns]\n1000\n3000\n",
     {"tracks.csv", "stamp 2000"}},
    {"image missing",
     "cam0/data.csv",
     "#timestamp [ns],filename\n1000,1000.png\n",
     {"data.csv:2", "1000.png", "No such file"}},
    {"image above the folder",
     "cam0/data.csv",
     "#timestamp [ns],filename\n1000,../../../../../../etc/passwd\n",
     {"data.csv:2", "column 2 (filename)", "'../../../../../../etc/passwd'", "in the folder data"}},
    {"image elsewhere",
     "cam0/data.csv",
     "#timestamp [ns],filename\n1000,/etc/passwd\n",
     {"data.csv:2", "'/etc/passwd'", "in the folder data"}},
};
INSTANTIATE_TEST_SUITE_P(Camera, BadSequence, testing::ValuesIn(kCameraCases));

}  // namespace
}  // namespace alidade
